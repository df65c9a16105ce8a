#include "retalho/render/relief.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr int kBand = 32;         // pixel rows that are sampled together: bounds the memory
constexpr double kAmbient = 0.2;  // light from everywhere
constexpr double kFlat = 0.8;     // brightness of flat ground

Vec3 light_direction(const ReliefOptions& o) {
  const double azimuth = o.azimuth * std::numbers::pi / 180, altitude = o.altitude * std::numbers::pi / 180;
  return {std::sin(azimuth) * std::cos(altitude), std::cos(azimuth) * std::cos(altitude), std::sin(altitude)};
}

double shade_with(Vec2 gradient, Vec3 light, double exaggeration) {
  const Vec3 normal{-exaggeration * gradient.x, -exaggeration * gradient.y, 1};
  const double cosine = std::max(0.0, dot(normal, light) / norm(normal));
  return std::min(1.0, kAmbient + (kFlat - kAmbient) * cosine / light.z);
}

Window band_of(const Window& window, int first, int rows) {
  Window band = window;
  band.origin = window.at(0, first);
  band.rows = rows;
  return band;
}

}  // namespace

double shade(Vec2 gradient, const ReliefOptions& options) {
  return shade_with(gradient, light_direction(options), options.exaggeration);
}

Image shade_relief(const FieldSource& surface, const Window& window, const ReliefOptions& options,
                   const FieldSource& color, const Context& context) {
  Image image(window.columns, window.rows);
  const Vec3 light = light_direction(options);
  const int n = options.samples;
  const double scale = options.high > options.low ? 1 / (options.high - options.low) : 0;
  for (int first = 0; first < window.rows; first += kBand) {
    context.check();
    context.report("shading", static_cast<double>(first) / window.rows);
    const int rows = std::min(kBand, window.rows - first);
    const Window fine = refined(band_of(window, first, rows), n);
    const HeightField field = surface(fine, context);
    const HeightField other = color ? color(fine, context) : HeightField{};
    const std::vector<double>& values = color ? other.heights : field.heights;
    parallel_chunks(static_cast<std::size_t>(rows), 4, context, [&](std::size_t begin, std::size_t end) {
      for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
        for (int column = 0; column < window.columns; ++column) {
          Color sum;
          for (int k = 0; k < n * n; ++k) {
            const std::size_t i = static_cast<std::size_t>(row * n + k / n) * static_cast<std::size_t>(fine.columns) +
                                  static_cast<std::size_t>(column * n + k % n);
            const bool data = !std::isnan(field.heights[i]) && !std::isnan(values[i]);
            sum = sum + (data ? shade_with(field.gradients[i], light, options.exaggeration) *
                                    ramp_color(options.ramp, (values[i] - options.low) * scale)
                              : Color{1, 1, 1});
          }
          image.at(column, first + row) = to_rgb(1.0 / (n * n) * sum);
        }
    });
  }
  context.report("shading", 1);
  return image;
}

double good_exaggeration(const FieldSource& surface, const Window& window, const Context& context) {
  const HeightField field = surface(window, context);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < field.heights.size(); ++i) {
    if (std::isnan(field.heights[i])) continue;
    sum += norm2(field.gradients[i]);
    ++count;
  }
  if (count == 0 || !(sum > 0)) return 1;
  const double wanted = 0.5 / std::sqrt(sum / static_cast<double>(count));
  const double unit = std::pow(10.0, std::floor(std::log10(wanted)) - 1);
  return std::round(wanted / unit) * unit;
}

Range height_range(const FieldSource& surface, const Window& window, const Context& context) {
  const HeightField field = surface(window, context);
  Range range{0, 1};
  bool any = false;
  for (const double height : field.heights) {
    if (std::isnan(height)) continue;
    range = any ? Range{std::min(range.low, height), std::max(range.high, height)} : Range{height, height};
    any = true;
  }
  return range;
}

}  // namespace retalho
