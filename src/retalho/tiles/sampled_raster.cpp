#include "retalho/tiles/sampled_raster.h"

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "retalho/terrain/quantities.h"

namespace retalho {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Needs second derivatives, and so a question a cell.
void curvatures(TileReader& reader, const SampledRows& rows, std::span<double> out, const Context& context) {
  std::size_t k = 0;
  for (int row = rows.first; row < rows.first + rows.rows; ++row) {
    context.check();
    for (int column = 0; column < rows.columns; ++column, ++k)
      if (const auto jet = reader.jet({rows.origin.x + column * rows.step.x, rows.origin.y - row * rows.step.y}))
        out[k] = mean_curvature(*jet);
  }
}

}  // namespace

std::size_t write_sampled(TileReader& reader, const SampledRaster& raster, SampledQuantity what,
                          const std::string& path, const WriteOptions& options, const Context& context) {
  std::size_t valid = 0;
  std::vector<double> values;
  std::vector<Vec2> gradients;
  const auto some_rows = [&](int first, int count, std::span<float> out) {
    const SampledRows rows{raster.origin, raster.step, raster.place.columns, first, count};
    values.assign(out.size(), kNan);
    if (what == SampledQuantity::curvature) {
      curvatures(reader, rows, values, context);
    } else {
      const bool sloped = what != SampledQuantity::height;
      gradients.assign(sloped ? out.size() : 0, {});
      sample_rows(reader, rows, values, gradients, context);
      for (std::size_t k = 0; sloped && k < values.size(); ++k)
        if (!std::isnan(values[k]))
          values[k] = what == SampledQuantity::slope ? slope_degrees(gradients[k]) : aspect_degrees(gradients[k]);
    }
    for (std::size_t k = 0; k < out.size(); ++k) {
      out[k] = static_cast<float>(values[k]);
      valid += std::isnan(values[k]) ? 0 : 1;
    }
  };
  write_rows(raster.place, path, options, some_rows, context);
  return valid;
}

}  // namespace retalho
