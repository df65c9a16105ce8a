// What people ask of a height surface besides its height, from its derivatives. Pure functions; a NaN in gives NaN.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "retalho/bernstein/triangle.h"
#include "retalho/core/vec.h"

namespace retalho {

/// Angle between the surface and the horizon, degrees in [0, 90).
inline double slope_degrees(Vec2 gradient) {
  return std::atan(norm(gradient)) * 180 / std::numbers::pi;
}

/// Where the surface looks downhill: degrees clockwise from north in [0, 360). NaN where it is flat.
inline double aspect_degrees(Vec2 gradient) {
  if (gradient.x == 0 && gradient.y == 0) return std::numeric_limits<double>::quiet_NaN();
  const double degrees = std::atan2(-gradient.x, -gradient.y) * 180 / std::numbers::pi;
  return degrees < 0 ? degrees + 360 : degrees;
}

/// Upward unit normal.
inline Vec3 unit_normal(Vec2 gradient) {
  return normalized(Vec3{-gradient.x, -gradient.y, 1});
}

/// Mean curvature, 1 / local unit: the mean of the two principal curvatures, positive in hollows (a bowl of radius R
/// has 1 / R at its bottom), negative on domes.
inline double mean_curvature(const Jet& jet) {
  const double p = jet.gradient.x, q = jet.gradient.y, w = 1 + p * p + q * q;
  return ((1 + q * q) * jet.xx - 2 * p * q * jet.xy + (1 + p * p) * jet.yy) / (2 * w * std::sqrt(w));
}

}  // namespace retalho
