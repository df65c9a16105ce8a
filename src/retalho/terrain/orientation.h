// On which side of a directed line a point lies, decided exactly for any doubles.
//
// A floating-point filter answers nearly always; where it cannot, the determinant is summed as an exact expansion
// (Shewchuk 1997, section 2). Holds where no product of two coordinates overflows or falls below 1e-290.
#pragma once

#include <cmath>

#include "retalho/core/vec.h"

namespace retalho {

/// Rounding of a two-by-two determinant of differences, relative to the sum of its products' sizes: (3 + 16 eps) eps,
/// eps = 2^-53.
inline constexpr double kOrientationBound = 3.3306690738754716e-16;

/// The slow path of `orientation`: always exact.
int exact_orientation(Vec2 a, Vec2 b, Vec2 c);

/// 1: `c` lies to the left of a -> b (the triangle is counter-clockwise); -1: to the right; 0: on the line.
inline int orientation(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  const double bound = kOrientationBound * (std::abs(left) + std::abs(right));
  if (det > bound) return 1;
  if (-det > bound) return -1;
  return exact_orientation(a, b, c);
}

}  // namespace retalho
