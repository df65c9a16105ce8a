// How smoothly the segments of a curve meet: C0, C1, C2 (the parameter's), G0, G1, G2 (the shape's), with the numbers
// behind the verdict, and what happens where the speed is zero (docs/curves.md, "Joins").
//
//   C_k   all derivatives by the curve's parameter up to k agree.
//   G1    the point agrees, both speeds are not zero and the unit tangents agree.
//   G2    G1 and the curvature vectors agree; the same as Q'+ = b1 Q'-, Q''+ = b1^2 Q''- + b2 Q'- with b1 > 0, any b2.
//
// The slides ask for Q''- - Q''+ = k Q', k > 0: too narrow, it leaves out every C2 join and unequal speeds.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "retalho/curve/curve.h"

namespace retalho {

/// regular: both speeds are not zero. Otherwise the tangents come from the first derivative that is not zero:
/// stop: the curve goes on (at the angle given); cusp: it turns back by 180 degrees; point: a segment is a single
/// point.
enum class JoinKind { regular, stop, cusp, point };
const char* join_kind_name(JoinKind kind);

struct ContinuityOptions {
  double position = 1e-9;    ///< G0: gap / size of the control polygon
  double derivative = 1e-9;  ///< C1, C2 and zero speed: relative to the largest control difference
  double angle = 1e-7;       ///< G1: radians
  double curvature = 1e-6;   ///< G2: |k- - k+| size / max(1, |k-| size)
};

struct Join {
  std::size_t left = 0, right = 0;  ///< segments; equal for a singular point inside of a segment
  double at = 0;                    ///< the curve's parameter
  Vec3 point;                       ///< the left limit
  int c = -1, g = -1;               ///< highest continuity of each sort up to 2; -1: a gap
  JoinKind kind = JoinKind::regular;
  double gap = 0;                                  ///< distance of the limits
  double angle = 0;                                ///< turning angle, radians in [0, pi]
  double curvature_left = 0, curvature_right = 0;  ///< signed in the plane; 0 where the speed is zero
  double curvature_gap = 0;                        ///< length of the difference of the curvature vectors
  double speed_ratio = 1;                          ///< |Q'+| / |Q'-|; 0 or 1 where a speed is zero
};

/// The verdict on the end of one segment and the start of another. `at` and the indices are left to the caller.
Join analyse_join(const CurveSegment& left, const CurveSegment& right, int dimension,
                  const ContinuityOptions& options = {});

/// The verdict on a point inside of a segment, local parameter t in (0, 1): everything is smooth there by the
/// parameter; the shape need not be (slide 6).
Join analyse_inside(const CurveSegment& segment, double t, int dimension, const ContinuityOptions& options = {});

/// All joins in order of the parameter, the closing one last (at curve.end()), and the points of zero speed inside of
/// segments. Cost: linear, and roots of a polynomial of degree 4 n - 5 a segment.
std::vector<Join> analyse_joins(const Curve& curve, const ContinuityOptions& options = {});

}  // namespace retalho
