// Measures of a curve: length and its inverse, bounds, curvature and its extrema, inflections, area, nearest points
// (docs/curves.md, "Measuring"). Everything that is a root of a polynomial is found as all roots of that polynomial.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "retalho/curve/curve.h"

namespace retalho {

/// Length between parameters u0 <= u1: 8-point Gauss-Legendre on panels that are halved until two levels agree to
/// `relative`. Panels end at all extrema of the speed, so a cusp costs no digits.
double arc_length(const Curve& curve, double relative = 1e-12);
double arc_length(const Curve& curve, double u0, double u1, double relative = 1e-12);

/// Parameter <-> length from the start, for many questions. Both ways to about 1e-12 of the length.
class ArcLength {
 public:
  explicit ArcLength(const Curve& curve, double relative = 1e-12);
  double total() const { return lengths_.back(); }
  double length_at(double u) const;
  /// The parameter at which the length `s` (clamped to [0, total]) is reached; the first one where the curve stands
  /// still.
  double parameter_at(double s) const;
  /// n points (at least 2) at equal distances along the curve, as parameters.
  std::vector<double> equal_parts(std::size_t n) const;

 private:
  Curve curve_;
  double relative_;
  std::vector<double> parameters_, lengths_;
};

struct Bounds3 {
  Vec3 low, high;
};
/// The exact box (to rounding): ends and all roots of each coordinate's derivative.
Bounds3 exact_bounds(const Curve& curve);

/// Curvature at u: signed in the plane (positive to the left), >= 0 in space; 0 where the speed is zero.
double curvature(const Curve& curve, double u, Side side = Side::right);

struct CurvePoint {
  double at = 0;  ///< the curve's parameter
  Vec3 point;
  double value = 0;  ///< what was asked for: a curvature, a distance
};

/// Where the plane curvature changes sign, inside of segments. Space curves: throws UsageError.
std::vector<CurvePoint> inflections(const Curve& curve);
/// Local extrema of the curvature (of its absolute value in space) inside of segments, with the curvature there.
std::vector<CurvePoint> curvature_extrema(const Curve& curve);

/// Signed area to the left of a closed plane curve, 1/2 of the integral of x dy - y dx; an open curve is closed by its
/// chord. Exact for polynomial segments.
double signed_area(const Curve& curve);

/// All local minima of the distance from p, ascending by distance; the first is the nearest point. Roots of
/// (Q - p) . Q' in Bernstein form, segment by segment, and ends of segments. Never empty for a curve that is not empty.
std::vector<CurvePoint> closest_points(const Curve& curve, Vec3 p);
/// The nearest point alone: segments whose control hull is farther than the best so far are skipped.
CurvePoint closest_point(const Curve& curve, Vec3 p);

}  // namespace retalho
