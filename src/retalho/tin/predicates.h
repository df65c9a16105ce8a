// The two questions that decide a triangulation, answered exactly: on which side of a line, inside which circle.
//
// Doubles are tried first with the error bounds of Shewchuk (Adaptive precision floating-point arithmetic and fast
// robust geometric predicates, 1997, bounds A); what they leave open goes to the exact predicates of CGAL's filtered
// kernel. An absolute term makes the bounds hold under underflow too; overflow fails the comparison and is left open.
// Any finite coordinates will do. Cost: a few ns; about a microsecond where the answer is 0 or nearly so.
#pragma once

#include <cmath>

#include "retalho/core/vec.h"

namespace retalho {

/// The same by CGAL's filtered kernel alone.
int orientation_exact(Vec2 a, Vec2 b, Vec2 c);
int in_circle_exact(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

/// +1: a, b, c turn to the left (counter-clockwise), -1: to the right, 0: on one line.
inline int orientation(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  constexpr double kUlp = 0x1p-53, kBound = (3 + 16 * kUlp) * kUlp;
  if (std::abs(det) > kBound * (std::abs(left) + std::abs(right)) + 1e-290) return det > 0 ? 1 : -1;
  return orientation_exact(a, b, c);
}

/// +1: d lies inside the circle through a, b, c (counter-clockwise), -1: outside, 0: on it.
inline int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const double adx = a.x - d.x, ady = a.y - d.y, bdx = b.x - d.x, bdy = b.y - d.y, cdx = c.x - d.x, cdy = c.y - d.y;
  const double bc = bdx * cdy, cb = cdx * bdy, ca = cdx * ady, ac = adx * cdy, ab = adx * bdy, ba = bdx * ady;
  const double a2 = adx * adx + ady * ady, b2 = bdx * bdx + bdy * bdy, c2 = cdx * cdx + cdy * cdy;
  const double det = a2 * (bc - cb) + b2 * (ca - ac) + c2 * (ab - ba);
  const double permanent =
      (std::abs(bc) + std::abs(cb)) * a2 + (std::abs(ca) + std::abs(ac)) * b2 + (std::abs(ab) + std::abs(ba)) * c2;
  constexpr double kUlp = 0x1p-53, kBound = (10 + 96 * kUlp) * kUlp;
  if (std::abs(det) > kBound * permanent + 1e-300 * (a2 + b2 + c2 + 1)) return det > 0 ? 1 : -1;
  return in_circle_exact(a, b, c, d);
}

}  // namespace retalho
