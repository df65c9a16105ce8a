// On which side of a directed line a point lies, decided exactly: tin/predicates.h's orientation with a slow path of
// its own. On rasters whose cells are the TIN's vertices the answer 0 is the rule, and there the exact predicate behind
// that header takes a microsecond; an expansion of six products (Shewchuk 1997, section 2) takes some ten nanoseconds.
//
// Holds where no product of two coordinates overflows or, other than 0, falls below 1e-290.
#pragma once

#include <cmath>

#include "retalho/core/vec.h"

namespace retalho {

/// Rounding of a two-by-two determinant of differences, relative to the sum of its products' sizes: (3 + 16 eps) eps,
/// eps = 2^-53.
inline constexpr double kSideBound = 3.3306690738754716e-16;

/// The slow path of `side_of`: always exact.
int exact_side_of(Vec2 a, Vec2 b, Vec2 c);

/// 1: `c` lies to the left of a -> b (the triangle is counter-clockwise); -1: to the right; 0: on the line.
inline int side_of(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  const double bound = kSideBound * (std::abs(left) + std::abs(right));
  if (det > bound) return 1;
  if (-det > bound) return -1;
  return exact_side_of(a, b, c);
}

}  // namespace retalho
