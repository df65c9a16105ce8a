// A curve as a polyline that is nowhere farther from it than a tolerance: proved by the convex hull of the control
// points, not sampled (docs/curves.md, "Drawing").
//
// Promise: every point of a piece lies within `tolerance` of that piece's chord (the segment, not the line), so the
// whole curve lies within `tolerance` of the polyline. Joins and points of zero speed are always vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/curve/curve.h"

namespace retalho {

struct FlatCurve {
  std::vector<Vec3> points;
  std::vector<double> parameters;     ///< the curve's parameter at each point
  std::vector<std::uint32_t> starts;  ///< where a new line begins (after a gap): indices of points; first is 0
  bool closed = false;                ///< closed curve without a gap: the last point equals the first
  double bound = 0;                   ///< the proved distance, <= tolerance
};

/// Throws UsageError unless tolerance > 0. Cost: about one subdivision a vertex.
FlatCurve flatten(const Curve& curve, double tolerance, const Context& context = {});

/// How many uniform steps keep a polynomial segment within `tolerance` of its chords (Wang's bound):
/// ceil(sqrt(n (n - 1) max |second difference| / (8 tolerance))), at least 1.
std::size_t wang_steps(const CurveSegment& segment, double tolerance);

}  // namespace retalho
