#include "retalho/visibility/line_of_sight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "retalho/visibility/field_of_view.h"

namespace retalho {
namespace {

constexpr double kTieSlope = 1e-10;  // as in horizon.h

/// Terrain over the observer's cell, lowered by curvature.
struct Ground {
  const CellHeights& cells;
  const Observer& observer;
  double drop;

  double at(int column, int row) const {
    const double x = (column - observer.column) * cells.cell_width, y = (row - observer.row) * cells.cell_height;
    return cells.at(column, row) - drop * (x * x + y * y);
  }
};

}  // namespace

SightLine line_of_sight(const CellHeights& cells, const Observer& observer, int target_column, int target_row,
                        const SightOptions& options) {
  const auto check = [&](int column, int row, const char* what) {
    if (!cells.holds(column, row))
      throw BadInput(fmt::format("the {}'s cell ({}, {}) is outside of the grid of {} x {} cells", what, column, row,
                                 cells.columns, cells.rows));
    if (std::isnan(cells.at(column, row)))
      throw BadInput(fmt::format("the {}'s cell ({}, {}) holds no data", what, column, row));
  };
  check(observer.column, observer.row, "observer");
  check(target_column, target_row, "target");

  const Ground ground{cells, observer, visibility_detail::curvature_drop(options.earth_curvature, options.refraction)};
  const double eye = cells.at(observer.column, observer.row) + observer.height;
  const double aim = ground.at(target_column, target_row) + options.target_height;
  const int dc = target_column - observer.column, dr = target_row - observer.row;
  const int nc = std::abs(dc), nr = std::abs(dr), sc = dc < 0 ? -1 : 1, sr = dr < 0 ? -1 : 1;
  const double length = std::hypot(dc * cells.cell_width, dr * cells.cell_height);
  const int major = std::max(nc, nr);

  SightLine line;
  line.clearance = std::numeric_limits<double>::infinity();
  line.fresnel_clear =
      options.frequency > 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  line.blocked_at = std::numeric_limits<double>::quiet_NaN();
  line.visible = true;

  // A crossing at the fraction num / den of the way; `height` is the terrain there (NaN: nothing, or a blocking void).
  const auto add = [&](double t, double height, bool inner) {
    ProfilePoint p;
    p.distance = t * length;
    p.at = cells.centre(observer.column + t * dc, observer.row + t * dr);
    p.ground = height;
    p.sight = eye + t * (aim - eye);
    p.fresnel = visibility_detail::fresnel_radius(options.frequency, p.distance, length);
    if (inner) {
      const bool nothing = std::isnan(height);
      // Slopes are compared, as the viewshed does: ground and sight line at the same place seen from the eye.
      const bool blocks = nothing ? options.voids == VoidRule::blocks : (height - p.sight) / (t * major) > kTieSlope;
      if (blocks && line.visible) {
        line.visible = false;
        line.blocked_at = p.distance;
      }
      if (!nothing) {
        line.clearance = std::min(line.clearance, p.sight - height);
        if (options.frequency > 0 && p.fresnel > 0)
          line.fresnel_clear = std::min(line.fresnel_clear, (p.sight - height) / p.fresnel);
      }
    }
    line.profile.push_back(p);
  };

  add(0, cells.at(observer.column, observer.row), false);
  // Crossings with column lines at i / nc, with row lines at j / nr, merged in order; equal ones are grid points.
  int i = 1, j = 1;
  while (i < nc || j < nr) {
    const std::int64_t left = i < nc ? std::int64_t{i} * std::max(nr, 1) : std::numeric_limits<std::int64_t>::max();
    const std::int64_t right = j < nr ? std::int64_t{j} * std::max(nc, 1) : std::numeric_limits<std::int64_t>::max();
    if (left <= right) {
      // column line i: the row is i * nr / nc
      const int whole = static_cast<int>(std::int64_t{i} * nr / nc), rest = static_cast<int>(std::int64_t{i} * nr % nc);
      const int column = observer.column + sc * i, row = observer.row + sr * whole;
      const double f = static_cast<double>(rest) / nc;
      const double height = rest == 0
                                ? ground.at(column, row)
                                : ground.at(column, row) + f * (ground.at(column, row + sr) - ground.at(column, row));
      add(static_cast<double>(i) / nc, height, true);
      if (left == right) ++j;
      ++i;
    } else {
      const int whole = static_cast<int>(std::int64_t{j} * nc / nr), rest = static_cast<int>(std::int64_t{j} * nc % nr);
      const int column = observer.column + sc * whole, row = observer.row + sr * j;
      const double f = static_cast<double>(rest) / nr;
      const double height = rest == 0
                                ? ground.at(column, row)
                                : ground.at(column, row) + f * (ground.at(column + sc, row) - ground.at(column, row));
      add(static_cast<double>(j) / nr, height, true);
      ++j;
    }
  }
  if (major > 0) add(1, ground.at(target_column, target_row), false);
  return line;
}

SightLine line_of_sight(const Raster& raster, const Observer& observer, int target_column, int target_row,
                        const SightOptions& options) {
  return line_of_sight(cells_of(raster), observer, target_column, target_row, options);
}

}  // namespace retalho
