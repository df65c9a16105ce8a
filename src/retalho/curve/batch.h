// Many points of one curve at once: the fast way for drawing and fitting. Coordinates go to arrays of their own, which
// is what lets the processor work on several points at a time (docs/curves.md, "Speed").
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "retalho/curve/bspline.h"
#include "retalho/curve/curve.h"

namespace retalho {

/// Points of a polynomial cubic segment at local parameters t, in Bernstein-Horner form. All spans have the same size.
/// Any t, in any order. Same results as evaluate() to rounding; no allocation.
void evaluate_cubic(const std::array<Vec3, 4>& points, std::span<const double> t, std::span<double> x,
                    std::span<double> y, std::span<double> z);

/// A polynomial cubic spline (B-spline or any chain of cubics) made ready for many evaluations.
class CubicEvaluator {
 public:
  /// Throws UsageError for a rational curve or one of degree over 3.
  explicit CubicEvaluator(const Curve& curve);
  /// Points at the curve's parameters u (outside: clamped), in any order. No allocation.
  void operator()(std::span<const double> u, std::span<double> x, std::span<double> y, std::span<double> z) const;

 private:
  struct Span {  // power basis about the span's start: 12 coefficients, start, and the start of the next
    std::array<double, 12> c;
    double from, to;
  };
  std::vector<Span> spans_;
  std::vector<std::uint32_t> bucket_;  // first span of each of many equal parts of the interval
  double begin_, end_, scale_;
};

}  // namespace retalho
