// Bernstein polynomials of any degree on the segment [0, 1], and everything that is decided from their coefficients:
// values, derivatives, halves, products, bounds and all real roots (docs/curves.md, "The Bernstein form").
//
// A polynomial of degree n is its n + 1 coefficients b[0..n]: p(t) = sum b[i] C(n, i) t^i (1 - t)^(n - i). Its range on
// [0, 1] lies between the smallest and the largest coefficient; b[0] and b[n] are its end values.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace retalho {

/// Coefficients b[0..n] of a Bernstein polynomial of degree n on [0, 1].
using Bernstein = std::vector<double>;

/// Binomial coefficient as a double; exact up to n = 57.
double binomial(int n, int k);

/// Value at t by de Casteljau's algorithm. No allocation up to degree 63. Cost: n^2 / 2 blends.
double evaluate(std::span<const double> b, double t);

/// The two halves at t (de Casteljau's first and last columns). `left` and `right` have b's size and may not overlap b.
void subdivide(std::span<const double> b, double t, std::span<double> left, std::span<double> right);

/// The derivative, degree n - 1 (degree 0 for a constant).
Bernstein derivative(std::span<const double> b);

/// The same polynomial, written with one degree more.
Bernstein elevate(std::span<const double> b);
/// The same polynomial, written in degree `degree` (>= its own).
Bernstein elevate_to(std::span<const double> b, int degree);

/// a * b, degree m + n: c[i+j] += C(m,i) C(n,j) / C(m+n,i+j) a[i] b[j].
Bernstein product(std::span<const double> a, std::span<const double> b);
/// a + s * b; the degrees may differ.
Bernstein sum(std::span<const double> a, std::span<const double> b, double s = 1);

/// Integral over [0, 1]: the mean of the coefficients.
double integral(std::span<const double> b);

/// Between the power basis on [0, 1] (a[0] + a[1] t + ...) and the Bernstein basis. Exact in exact arithmetic; above
/// degree 15 or so the conversion loses digits: stay in one basis.
Bernstein power_to_bernstein(std::span<const double> a);
std::vector<double> bernstein_to_power(std::span<const double> b);

/// Smallest and largest coefficient: they enclose the range on [0, 1].
std::pair<double, double> bounds(std::span<const double> b);

struct RootOptions {
  /// A coefficient of this size or less counts as zero. Negative: rounding's share, 4 (n + 1) 2^-53 max |b|.
  double zero = -1;
  double width = 1e-14;  ///< an interval that cannot be decided is not divided below this width
};

/// A root, or a stretch that rounding cannot tell from one.
struct BernsteinRoot {
  double t = 0;         ///< where, in [0, 1]
  double radius = 0;    ///< half the width of the stretch; about 0 for a simple root
  bool simple = false;  ///< proved: exactly one root there, with a change of sign
};

/// All roots in [0, 1], ascending, by subdivision and Descartes' rule of signs. Promise: wherever no root is reported,
/// the polynomial is proved not to be zero (up to `zero`): double roots and touching ends are reported as well.
/// The zero polynomial gives one root, t = 0.5, radius 0.5.
std::vector<BernsteinRoot> roots(std::span<const double> b, const RootOptions& options = {});

}  // namespace retalho
