#include "retalho/terrain/fit_grid.h"

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

Vec2 cell_coordinates(Vec2 local, const Raster& raster) {
  const auto snapped = [](double at) {
    const double whole = std::nearbyint(at);
    return std::abs(at - whole) < 1e-9 * std::max(1.0, std::abs(at)) ? whole : at;
  };
  return {snapped(local.x / raster.cell_width), snapped(local.y / raster.cell_height)};
}

}  // namespace retalho
