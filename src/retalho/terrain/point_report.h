// How good a model of scattered points is: its error at the points that it stands for.
#pragma once

#include <span>

#include "retalho/core/vec.h"
#include "retalho/terrain/report.h"

namespace retalho {

/// `points` in the model's local coordinates. Points at the same (x, y) count once, with their mean height, as
/// triangulate_points makes one vertex of them: `cells` counts the different places, `valid_cells` too. `slope_rmse`
/// stays 0. `max_error_at` is the first, by x then y, with the largest error. `tolerance` <= 0: no violations are
/// counted. Throws BadInput when no point is covered.
ErrorReport assess_points(const Terrain& terrain, std::span<const Vec3> points, double tolerance = 0,
                          const Context& context = {});

}  // namespace retalho
