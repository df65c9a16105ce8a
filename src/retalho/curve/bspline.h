// B-splines and NURBS: evaluation, knot insertion and removal, and the exact ways to and from the hub.
#pragma once

#include <vector>

#include "retalho/curve/curve.h"

namespace retalho {

struct BSpline {
  int degree = 3;
  int dimension = 2;
  std::vector<double> knots;    ///< ascending, points + degree + 1 of them; the curve runs over [knots[p], knots[n]]
  std::vector<Vec3> points;     ///< n control points
  std::vector<double> weights;  ///< empty, or n positive weights (NURBS)

  double begin() const { return knots[static_cast<std::size_t>(degree)]; }
  double end() const { return knots[points.size()]; }
};

/// Throws BadInput, naming what is wrong: degree, counts, order or multiplicity of knots, weights.
void validate(const BSpline& spline);

/// Point at u in [begin, end] by de Boor's algorithm; at end the limit from the left.
Vec3 evaluate(const BSpline& spline, double u);

/// The same curve with one more knot at u (Boehm). Throws UsageError: u outside, or multiplicity over the degree.
BSpline insert_knot(const BSpline& spline, double u);

struct KnotRemoval {
  BSpline spline;
  bool removed = false;
  double error = 0;  ///< how far the best removal moves a control point (homogeneous), whether or not it was done
};
/// Takes one knot at u away when that moves no control point by more than `tolerance` (Tiller's test, computed by
/// solving the insertion equations from both sides). Throws UsageError when u is not an inner knot.
KnotRemoval remove_knot(const BSpline& spline, double u, double tolerance);

/// Exact: inner knots raised to multiplicity p are the Bézier points of the spans. A knot of multiplicity p + 1 makes a
/// gap.
Curve to_curve(const BSpline& spline);

/// The chain as one B-spline of its largest degree: knots of multiplicity p (p + 1 at gaps), then knots removed while
/// the error stays below `tolerance` times the curve's size. tolerance 0 removes nothing: exact.
BSpline to_bspline(const Curve& curve, double tolerance = 1e-10);

/// Clamped uniform knots 0 0 0 0 1 2 ... for n points of a degree.
std::vector<double> clamped_knots(std::size_t points, int degree);
/// Knots and repeated points of a closed uniform B-spline.
BSpline closed_bspline(const std::vector<Vec3>& points, int degree, int dimension);

}  // namespace retalho
