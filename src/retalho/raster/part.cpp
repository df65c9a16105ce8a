#include "retalho/raster/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {

Raster part_of(const Raster& whole, const CellWindow& window) {
  Raster part;
  part.columns = window.columns;
  part.rows = window.rows;
  part.cell_width = whole.cell_width;
  part.cell_height = whole.cell_height;
  part.height_unit = whole.height_unit;
  part.georef = whole.georef;
  const Vec2 corner = whole.georef.to_crs(whole.centre(window.column, window.row));
  part.georef.origin_x = corner.x;
  part.georef.origin_y = corner.y;
  std::visit(
      [&](const auto& from) {
        std::remove_cvref_t<decltype(from)> heights;
        heights.reserve(part.cells());
        for (int r = 0; r < window.rows; ++r) {
          const auto begin = from.begin() + static_cast<std::ptrdiff_t>(whole.index(window.column, window.row + r));
          heights.insert(heights.end(), begin, begin + window.columns);
        }
        part.heights = std::move(heights);
      },
      whole.heights);
  return part;
}

void check_stride(const Raster& whole, int stride) {
  if (stride < 1) throw UsageError(fmt::format("a stride of {} cells: give 1 or more", stride), {}, "stride");
  if (stride > std::min(whole.columns, whole.rows))
    throw UsageError(fmt::format("a stride of {} cells: the grid has {} x {} cells", stride, whole.columns, whole.rows),
                     {}, "stride");
}

Raster thinned(const Raster& whole, int stride) {
  check_stride(whole, stride);
  const int first = stride / 2;
  const auto count = [&](int side) { return (side - first + stride - 1) / stride; };
  Raster thin;
  thin.columns = count(whole.columns);
  thin.rows = count(whole.rows);
  thin.cell_width = whole.cell_width * stride;
  thin.cell_height = whole.cell_height * stride;
  thin.height_unit = whole.height_unit;
  thin.georef = whole.georef;
  const Vec2 corner = whole.georef.to_crs(whole.centre(first, first));
  thin.georef.origin_x = corner.x;
  thin.georef.origin_y = corner.y;
  std::visit(
      [&](const auto& from) {
        std::remove_cvref_t<decltype(from)> heights;
        heights.reserve(thin.cells());
        for (int row = first; row < whole.rows; row += stride)
          for (int column = first; column < whole.columns; column += stride)
            heights.push_back(from[whole.index(column, row)]);
        thin.heights = std::move(heights);
      },
      whole.heights);
  return thin;
}

}  // namespace retalho
