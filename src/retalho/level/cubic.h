// Cubic Bézier pieces of contour lines: fitting one to a stretch of a polyline, and proving that two
// do not meet.
#pragma once

#include <array>
#include <span>

#include "retalho/core/vec.h"

namespace retalho {

using Cubic = std::array<Vec2, 4>;

/// A straight piece as a cubic.
Cubic straight_cubic(Vec2 from, Vec2 to);

/// What a fitted piece must keep.
struct CubicFit {
  double tolerance = 0;  ///< > 0: curve and polyline are within this of each other, both ways
  double per_unit = 0;   ///< control points are whole multiples of 1 / per_unit; 0: as they come
};

/// The cubic from the first to the last of `points` (at least 2) that leaves along `start` and arrives along `end`
/// (unit vectors) and lies nearest to them; false when it does not keep the tolerance, or may not advance all along its
/// chord. The tolerance is proved: the curve is cut at a point for each vertex, no farther from it than the tolerance,
/// and the control points of each part are within the tolerance of their side of the polyline. Least squares with
/// reparametrization as in P. J. Schneider, "An Algorithm for Automatically Fitting Digitized Curves" (Graphics Gems,
/// 1990).
bool fit_cubic(std::span<const Vec2> points, Vec2 start, Vec2 end, const CubicFit& options, Cubic& out);

/// Is it proved that two pieces share no point, but the joints: `ab`: b starts where a ends; `ba`: a starts where b
/// ends? By hulls that a line separates, halving where none does; near a joint by a direction in which both advance.
/// Decided with a margin above rounding, so a yes is certain; a no may be a near miss of 1e-7 of their size.
bool apart(const Cubic& a, const Cubic& b, bool ab, bool ba);

}  // namespace retalho
