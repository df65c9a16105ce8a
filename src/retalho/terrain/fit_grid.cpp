#include "retalho/terrain/fit_grid.h"

#include <algorithm>
#include <cmath>

#include "retalho/core/parallel.h"

namespace retalho {

FitGrid::FitGrid(const Raster& raster, const Context& context)
    : columns(raster.columns), rows(raster.rows), unit(std::sqrt(raster.cell_width * raster.cell_height)) {
  step = {raster.cell_width / unit, raster.cell_height / unit};
  const RasterSummary summary = summarize(raster);
  valid = summary.valid;
  reference = valid > 0 ? summary.mean : 0;
  range = valid > 0 ? summary.maximum - summary.minimum : 0;
  z.resize(raster.cells());
  std::visit(
      [&](const auto& heights) {
        parallel_chunks(z.size(), std::size_t{1} << 20, context, [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) z[k] = static_cast<double>(heights[k]) - reference;
        });
      },
      raster.heights);
}

void FitGrid::tear(Vec2 a, Vec2 b) {
  if (torn.empty()) torn.assign(z.size(), 0);
  // Along every row (column) that the crease meets, the cells within one of it.
  const auto lines = [](double from, double to, double other_from, double other_to, int count, const auto& mark) {
    if (from == to) return;
    const double low = std::min(from, to), high = std::max(from, to);
    const int last = static_cast<int>(std::min(std::floor(high), count - 1.0));
    for (int k = static_cast<int>(std::max(std::ceil(low), 0.0)); k <= last; ++k)
      mark(k, other_from + (k - from) / (to - from) * (other_to - other_from));
  };
  const auto near = [](double at, int count, const auto& mark) {
    const int last = static_cast<int>(std::min(std::floor(at + 1), count - 1.0));
    for (int k = static_cast<int>(std::max(std::ceil(at - 1), 0.0)); k <= last; ++k) mark(k);
  };
  lines(-a.y, -b.y, a.x, b.x, rows,
        [&](int row, double x) { near(x, columns, [&](int column) { torn[cell(column, row)] = 1; }); });
  lines(a.x, b.x, -a.y, -b.y, columns,
        [&](int column, double y) { near(y, rows, [&](int row) { torn[cell(column, row)] = 1; }); });
}

Vec2 cell_coordinates(Vec2 local, const Raster& raster) {
  const auto snapped = [](double at) {
    const double whole = std::nearbyint(at);
    return std::abs(at - whole) < 1e-9 * std::max(1.0, std::abs(at)) ? whole : at;
  };
  return {snapped(local.x / raster.cell_width), snapped(local.y / raster.cell_height)};
}

}  // namespace retalho
