#include "retalho/tin/refine.h"

#include <fmt/format.h>

#include "retalho/core/error.h"
#include "retalho/tin/greedy_heap.h"
#include "retalho/tin/greedy_mesh.h"
#include "retalho/tin/greedy_tiles.h"

namespace retalho {

GridTin refine_grid(const Raster& raster, const RefineOptions& options, const Context& context) {
  if (!(options.max_error >= 0))
    throw UsageError(fmt::format("the largest error must be 0 or more, not {}", options.max_error), {}, "max_error");
  try {
    return refine_grid_in_tiles(raster, options, context);
  } catch (
      const greedy::TooManyCells&) {  // not where memory is short: the same input gives the same bytes, or an error
    return refine_grid_by_heap(raster, options, context);
  }
}

Tin to_tin(const GridTin& grid_tin, const Raster& raster) {
  Tin tin;
  tin.points.reserve(grid_tin.cells.size());
  tin.heights.reserve(grid_tin.cells.size());
  for (const std::uint32_t cell : grid_tin.cells) {
    const int column = static_cast<int>(cell & 0xffffU), row = static_cast<int>(cell >> 16);
    tin.points.push_back(raster.centre(column, row));
    tin.heights.push_back(raster.at(column, row));
  }
  tin.triangles = grid_tin.triangles;
  tin.neighbors = grid_tin.neighbors;
  return tin;
}

Tin refine_tin(const Raster& raster, const RefineOptions& options, const Context& context) {
  return to_tin(refine_grid(raster, options, context), raster);
}

}  // namespace retalho
