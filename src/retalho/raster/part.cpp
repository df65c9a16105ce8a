#include "retalho/raster/part.h"

#include <type_traits>
#include <utility>

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

}  // namespace retalho
