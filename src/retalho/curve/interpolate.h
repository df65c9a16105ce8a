// Curves through given points: Lagrange's polynomial in barycentric form, and cubic splines (docs/curves.md,
// "Interpolation"; slide 4).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "retalho/curve/curve.h"

namespace retalho {

/// The polynomial of degree n - 1 through n values. Barycentric weights are scaled by the interval's capacity, so that
/// they neither overflow nor vanish; for Chebyshev nodes use chebyshev_nodes, for which the form is stable at any n.
class Lagrange {
 public:
  /// Throws BadInput: fewer than one node, unequal counts, a node twice.
  Lagrange(std::vector<double> nodes, std::vector<double> values);
  double operator()(double t) const;  ///< Cost: one pass over the nodes.
  const std::vector<double>& weights() const { return weights_; }
  /// The polynomial on [from, to] in Bernstein form, from its values at Chebyshev points of that interval.
  std::vector<double> bernstein(double from, double to) const;

 private:
  std::vector<double> nodes_, values_, weights_;
};

/// n equally spaced nodes on [a, b], and n Chebyshev points of the second kind, cos(pi j / (n - 1)) mapped, ascending.
std::vector<double> uniform_nodes(std::size_t n, double a, double b);
std::vector<double> chebyshev_nodes(std::size_t n, double a, double b);

enum class SplineEnds { not_a_knot, natural, clamped, periodic };
const char* spline_ends_name(SplineEnds ends);

struct SplineOptions {
  SplineEnds ends = SplineEnds::not_a_knot;
  double first_slope = 0, last_slope = 0;  ///< for clamped
};

/// Slopes m_i at the nodes of the C2 cubic spline. 2 nodes with not-a-knot or natural: a line; 3 with not-a-knot: the
/// parabola. Periodic asks for y.front() == y.back(). Throws BadInput: counts, nodes that do not ascend, values that do
/// not close. Cost: one tridiagonal elimination, linear.
std::vector<double> spline_slopes(std::span<const double> x, std::span<const double> y,
                                  const SplineOptions& options = {});

/// y = s(x) as a plane curve, x the parameter.
Curve spline_graph(std::span<const double> x, std::span<const double> y, const SplineOptions& options = {});

/// How the parameters of points are chosen: |P_i+1 - P_i| to the power 0, 1/2 or 1, or the points' own x (a graph
/// y(x)).
enum class Parameters { uniform, centripetal, chord, x };
const char* parameters_name(Parameters parameters);
/// Starts at 0 (at the first x for Parameters::x). Throws BadInput naming the first point that repeats the one before
/// (not for uniform), or whose x does not ascend.
std::vector<double> point_parameters(std::span<const Vec3> points, Parameters kind);

struct PointSplineOptions {
  SplineEnds ends = SplineEnds::not_a_knot;
  Parameters parameters = Parameters::centripetal;
  bool closed = false;                         ///< periodic through the first point again; the list need not repeat it
  Vec3 first_tangent = {}, last_tangent = {};  ///< dQ/du for clamped
};
/// The cubic spline curve through points, C2 everywhere.
Curve interpolate_points(std::span<const Vec3> points, int dimension, const PointSplineOptions& options = {});

/// The polynomial curve through all points, one segment of degree n - 1. For few points: it oscillates (Runge).
Curve lagrange_curve(std::span<const Vec3> points, int dimension, Parameters parameters = Parameters::uniform);

}  // namespace retalho
