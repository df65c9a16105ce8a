#include "retalho/render/field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::size_t size_of(const Window& w) {
  return static_cast<std::size_t>(w.columns) * static_cast<std::size_t>(w.rows);
}

/// `window` in the local coordinates of `to`.
Window moved_window(const Window& window, const Georef& to) {
  Window result = window;
  result.georef = to;
  result.origin = to.to_local(window.georef.to_crs(window.origin));
  result.step = {window.step.x * to.scale_x / window.georef.scale_x,
                 window.step.y * to.scale_y / window.georef.scale_y};
  return result;
}

/// A cell's gradient: central differences, one-sided beside voids and borders.
Vec2 cell_gradient(const Raster& raster, int column, int row) {
  const auto height = [&](int c, int r) {
    return c < 0 || r < 0 || c >= raster.columns || r >= raster.rows ? kNan : raster.at(c, r);
  };
  const double here = raster.at(column, row);
  const auto slope = [here](double before, double after, double step) {
    const bool left = !std::isnan(before), right = !std::isnan(after);
    if (left && right) return (after - before) / (2 * step);
    if (right) return (after - here) / step;
    return left ? (here - before) / step : 0.0;
  };
  return {slope(height(column - 1, row), height(column + 1, row), raster.cell_width),
          slope(height(column, row + 1), height(column, row - 1), raster.cell_height)};
}

/// Bilinear among the valid ones of the four cells around (column, row).
void sample_raster(const Raster& raster, double column, double row, double& height, Vec2& gradient) {
  height = kNan;
  const double nearest_column = std::round(column), nearest_row = std::round(row);
  if (!(nearest_column >= 0 && nearest_row >= 0 && nearest_column < raster.columns && nearest_row < raster.rows))
    return;
  if (!raster.valid(static_cast<int>(nearest_column), static_cast<int>(nearest_row))) return;
  const int c0 = static_cast<int>(std::floor(column)), r0 = static_cast<int>(std::floor(row));
  double sum = 0, weights = 0;
  Vec2 slopes;
  for (int dr = 0; dr < 2; ++dr)
    for (int dc = 0; dc < 2; ++dc) {
      const int c = c0 + dc, r = r0 + dr;
      if (c < 0 || r < 0 || c >= raster.columns || r >= raster.rows || !raster.valid(c, r)) continue;
      const double weight = (1 - std::abs(column - c)) * (1 - std::abs(row - r));
      if (!(weight > 0)) continue;
      sum += weight * raster.at(c, r);
      slopes = slopes + weight * cell_gradient(raster, c, r);
      weights += weight;
    }
  height = sum / weights;
  gradient = slopes / weights;
}

}  // namespace

FieldSource field_of(const TerrainEvaluator& evaluator) {
  return [&evaluator](const Window& window, const Context& context) {
    const Window own = moved_window(window, evaluator.terrain().georef);
    HeightField field;
    field.heights.resize(size_of(window));
    field.gradients.resize(size_of(window));
    evaluator.grid_values(own.origin, own.step, own.columns, own.rows, field.heights, field.gradients, context);
    return field;
  };
}

FieldSource field_of(TileReader& reader) {
  return [&reader](const Window& window, const Context& context) {
    const Window own = moved_window(window, reader.index().georef);
    HeightField field;
    field.heights.resize(size_of(window));
    field.gradients.resize(size_of(window));
    sample_rows(reader, {own.origin, own.step, own.columns, 0, own.rows}, field.heights, field.gradients, context);
    return field;
  };
}

FieldSource field_of(const Raster& raster) {
  return [&raster](const Window& window, const Context& context) {
    const Window own = moved_window(window, raster.georef);
    HeightField field;
    field.heights.resize(size_of(window));
    field.gradients.resize(size_of(window));
    parallel_chunks(static_cast<std::size_t>(own.rows), 8, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        for (int column = 0; column < own.columns; ++column) {
          const Vec2 p = own.at(column, static_cast<double>(row));
          const std::size_t i = row * static_cast<std::size_t>(own.columns) + static_cast<std::size_t>(column);
          sample_raster(raster, p.x / raster.cell_width, -p.y / raster.cell_height, field.heights[i],
                        field.gradients[i]);
        }
    });
    return field;
  };
}

FieldSource difference_of(FieldSource first, FieldSource second) {
  return [first = std::move(first), second = std::move(second)](const Window& window, const Context& context) {
    HeightField field = first(window, context);
    const HeightField other = second(window, context);
    for (std::size_t i = 0; i < field.heights.size(); ++i) field.heights[i] -= other.heights[i];
    return field;
  };
}

Extent extent_of(const Raster& raster) {
  const Vec2 a = raster.centre(0, raster.rows - 1), b = raster.centre(raster.columns - 1, 0);
  return {a, b};
}

Extent extent_of(const Terrain& terrain) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extent e{{kInfinity, kInfinity}, {-kInfinity, -kInfinity}};
  for (const Vec2 p : terrain.tin.points) {
    e.low = {std::min(e.low.x, p.x), std::min(e.low.y, p.y)};
    e.high = {std::max(e.high.x, p.x), std::max(e.high.y, p.y)};
  }
  return e;
}

Extent extent_of(const BicubicGrid& grid) {
  return {{0, -(grid.rows - 1) * grid.cell_height}, {(grid.columns - 1) * grid.cell_width, 0}};
}

Extent moved(const Extent& extent, const Georef& from, const Georef& to) {
  return {to.to_local(from.to_crs(extent.low)), to.to_local(from.to_crs(extent.high))};
}

Window fit_window(const Georef& georef, const Extent& extent, int columns, int rows) {
  double pixel = std::max(extent.width() / columns, extent.height() / rows);
  if (!(pixel > 0)) pixel = 1;
  const Vec2 centre = 0.5 * (extent.low + extent.high);
  return {
      georef, {centre.x - pixel * (columns - 1) / 2, centre.y + pixel * (rows - 1) / 2}, {pixel, pixel}, columns, rows};
}

Window refined(const Window& window, int factor) {
  const Vec2 step = window.step / factor;
  const Vec2 corner{window.origin.x - window.step.x / 2, window.origin.y + window.step.y / 2};
  return {window.georef,
          {corner.x + step.x / 2, corner.y - step.y / 2},
          step,
          window.columns * factor,
          window.rows * factor};
}

}  // namespace retalho
