#include "retalho/curve/interpolate.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "retalho/bernstein/segment.h"
#include "retalho/core/error.h"
#include "retalho/curve/convert.h"

namespace retalho {

namespace {

/// Tridiagonal systems by elimination without pivoting; the rows of splines are diagonally dominant but for
/// not-a-knot's ends, which stay regular (all pivots positive). Several right sides at once.
class Tridiagonal {
 public:
  Tridiagonal(std::vector<double> below, std::vector<double> diagonal, std::vector<double> above)
      : below_(std::move(below)), diagonal_(std::move(diagonal)), above_(std::move(above)) {
    for (std::size_t i = 1; i < diagonal_.size(); ++i) {
      below_[i] /= diagonal_[i - 1];
      diagonal_[i] -= below_[i] * above_[i - 1];
    }
  }
  std::vector<double> solve(std::vector<double> r) const {
    const std::size_t n = diagonal_.size();
    for (std::size_t i = 1; i < n; ++i) r[i] -= below_[i] * r[i - 1];
    r[n - 1] /= diagonal_[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) r[i] = (r[i] - above_[i] * r[i + 1]) / diagonal_[i];
    return r;
  }

 private:
  std::vector<double> below_, diagonal_, above_;
};

std::vector<double> periodic_slopes(std::span<const double> h, std::span<const double> s) {
  const std::size_t n = h.size();  // unknowns m_0 .. m_{n-1}, m_n = m_0
  if (n == 1) return {0, 0};
  if (n == 2) {  // both rows couple m_0 and m_1 only
    const double a = 2 * (h[0] + h[1]), b = h[0] + h[1], r0 = 3 * (h[0] * s[1] + h[1] * s[0]);
    const double m = r0 / (a + b);
    return {m, m, m};
  }
  std::vector<double> below(n), diagonal(n), above(n), right(n), corner(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double before = h[(i + n - 1) % n], after = h[i];
    below[i] = after;
    diagonal[i] = 2 * (before + after);
    above[i] = before;
    right[i] = 3 * (after * s[(i + n - 1) % n] + before * s[i]);
  }
  // Sherman-Morrison: the two corners below[0] (column n - 1) and above[n - 1] (column 0) as one rank-one term.
  const double gamma = -diagonal[0];
  const double bottom = above[n - 1], top = below[0];
  diagonal[0] -= gamma;
  diagonal[n - 1] -= bottom * top / gamma;
  corner[0] = gamma;
  corner[n - 1] = bottom;
  const Tridiagonal system(below, diagonal, above);
  const std::vector<double> y = system.solve(right), z = system.solve(corner);
  const double factor = (y[0] + top / gamma * y[n - 1]) / (1 + z[0] + top / gamma * z[n - 1]);
  std::vector<double> m(n + 1);
  for (std::size_t i = 0; i < n; ++i) m[i] = y[i] - factor * z[i];
  m[n] = m[0];
  return m;
}

}  // namespace

Lagrange::Lagrange(std::vector<double> nodes, std::vector<double> values)
    : nodes_(std::move(nodes)), values_(std::move(values)) {
  if (nodes_.empty() || nodes_.size() != values_.size())
    throw BadInput(fmt::format("{} values for {} nodes: one a node is needed", values_.size(), nodes_.size()));
  const auto [low, high] = std::minmax_element(nodes_.begin(), nodes_.end());
  const double capacity = nodes_.size() > 1 ? (*high - *low) / 4 : 1;
  // Products of many factors leave the range of doubles: mantissas and exponents apart, scaled to the largest.
  std::vector<int> exponents(nodes_.size(), 0);
  weights_.assign(nodes_.size(), 1.0);
  for (std::size_t j = 0; j < nodes_.size(); ++j) {
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      if (k == j) continue;
      const double d = nodes_[j] - nodes_[k];
      if (d == 0)
        throw BadInput(fmt::format("node {} is given twice", nodes_[j]), {}, fmt::format("nodes[{}]", std::max(j, k)));
      int e = 0;
      weights_[j] = std::frexp(weights_[j] / (d / capacity), &e);
      exponents[j] += e;
    }
  }
  const int most = *std::max_element(exponents.begin(), exponents.end());
  for (std::size_t j = 0; j < nodes_.size(); ++j) weights_[j] = std::ldexp(weights_[j], exponents[j] - most);
}

double Lagrange::operator()(double t) const {
  double above = 0, below = 0;
  for (std::size_t j = 0; j < nodes_.size(); ++j) {
    const double d = t - nodes_[j];
    if (d == 0) return values_[j];
    const double q = weights_[j] / d;
    above += q * values_[j];
    below += q;
  }
  return above / below;
}

std::vector<double> Lagrange::bernstein(double from, double to) const {
  const auto n = static_cast<Eigen::Index>(nodes_.size());
  if (n == 1) return {values_[0]};
  // Collocation at Chebyshev points: the matrix of Bernstein values there is the best conditioned of the easy ones.
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd r(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) / static_cast<double>(n - 1));
    r(i) = (*this)(from + t * (to - from));
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) = binomial(static_cast<int>(n) - 1, static_cast<int>(j)) * std::pow(t, static_cast<double>(j)) *
                std::pow(1 - t, static_cast<double>(n - 1 - j));
  }
  const Eigen::VectorXd b = a.partialPivLu().solve(r);
  return {b.data(), b.data() + n};
}

std::vector<double> uniform_nodes(std::size_t n, double a, double b) {
  std::vector<double> x(n, a);
  for (std::size_t i = 1; i < n; ++i)
    x[i] = i + 1 == n ? b : a + (b - a) * static_cast<double>(i) / static_cast<double>(n - 1);
  return x;
}

std::vector<double> chebyshev_nodes(std::size_t n, double a, double b) {
  std::vector<double> x(n, 0.5 * (a + b));
  if (n < 2) return x;
  for (std::size_t i = 0; i < n; ++i) {
    // sin instead of cos: symmetric to the last bit.
    const double k = static_cast<double>(n - 1);
    const double s = std::sin(std::numbers::pi * (2 * static_cast<double>(i) - k) / (2 * k));
    x[i] = i == 0 ? a : i + 1 == n ? b : 0.5 * (a + b) + 0.5 * (b - a) * s;
  }
  return x;
}

const char* spline_ends_name(SplineEnds ends) {
  switch (ends) {
    case SplineEnds::not_a_knot:
      return "not-a-knot";
    case SplineEnds::natural:
      return "natural";
    case SplineEnds::clamped:
      return "clamped";
    case SplineEnds::periodic:
      return "periodic";
  }
  return "";
}

const char* parameters_name(Parameters parameters) {
  switch (parameters) {
    case Parameters::uniform:
      return "uniform";
    case Parameters::centripetal:
      return "centripetal";
    case Parameters::chord:
      return "chord";
    case Parameters::x:
      return "x";
  }
  return "";
}

std::vector<double> spline_slopes(std::span<const double> x, std::span<const double> y, const SplineOptions& options) {
  const std::size_t n = x.size();
  if (n < 2 || n != y.size())
    throw BadInput(fmt::format("{} nodes and {} values: the same number, 2 or more, is needed", n, y.size()));
  std::vector<double> h(n - 1), s(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x[i + 1] - x[i];
    if (!(h[i] > 0))
      throw BadInput(fmt::format("{} after {}: nodes must ascend", x[i + 1], x[i]), {},
                     fmt::format("nodes[{}]", i + 1));
    s[i] = (y[i + 1] - y[i]) / h[i];
  }
  if (options.ends == SplineEnds::periodic) {
    if (y.front() != y.back())
      throw BadInput(fmt::format("a periodic spline's last value {} must equal the first, {}", y.back(), y.front()));
    return periodic_slopes(h, s);
  }
  if (n == 2 && options.ends != SplineEnds::clamped) return {s[0], s[0]};
  if (n == 3 && options.ends == SplineEnds::not_a_knot) {
    const double second = (s[1] - s[0]) / (h[0] + h[1]);
    return {s[0] - second * h[0], s[0] + second * h[0], s[1] + second * h[1]};
  }
  std::vector<double> below(n, 0.0), diagonal(n), above(n, 0.0), right(n);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    below[i] = h[i];
    diagonal[i] = 2 * (h[i - 1] + h[i]);
    above[i] = h[i - 1];
    right[i] = 3 * (h[i] * s[i - 1] + h[i - 1] * s[i]);
  }
  const std::size_t e = n - 1;
  switch (options.ends) {
    case SplineEnds::natural:
      diagonal[0] = diagonal[e] = 2;
      above[0] = below[e] = 1;
      right[0] = 3 * s.front();
      right[e] = 3 * s.back();
      break;
    case SplineEnds::clamped:
      diagonal[0] = diagonal[e] = 1;
      right[0] = options.first_slope;
      right[e] = options.last_slope;
      break;
    default: {
      double d = h[0] + h[1];
      diagonal[0] = h[1];
      above[0] = d;
      right[0] = ((h[0] + 2 * d) * h[1] * s[0] + h[0] * h[0] * s[1]) / d;
      const double a = h[n - 2], b = h[n - 3];
      d = a + b;
      diagonal[e] = b;
      below[e] = d;
      right[e] = ((a + 2 * d) * b * s[n - 2] + a * a * s[n - 3]) / d;
    }
  }
  return Tridiagonal(below, diagonal, above).solve(right);
}

Curve spline_graph(std::span<const double> x, std::span<const double> y, const SplineOptions& options) {
  const std::vector<double> m = spline_slopes(x, y, options);
  std::vector<Vec3> points, tangents;
  for (std::size_t i = 0; i < x.size(); ++i) {
    points.push_back({x[i], y[i], 0});
    tangents.push_back({1, m[i], 0});
  }
  return from_hermite(points, tangents, 2, x);
}

std::vector<double> point_parameters(std::span<const Vec3> points, Parameters kind) {
  std::vector<double> u = {kind == Parameters::x && !points.empty() ? points[0].x : 0.0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double d = norm(points[i] - points[i - 1]);
    const std::string where = fmt::format("points[{}]", i);
    if (kind == Parameters::x) {
      if (!(points[i].x > points[i - 1].x))
        throw BadInput(
            fmt::format("x = {} after {}: with the parameters \"x\" they must ascend", points[i].x, points[i - 1].x),
            {}, where);
      u.push_back(points[i].x);
      continue;
    }
    if (kind != Parameters::uniform && !(d > 0))
      throw BadInput("repeats the point before it: merge them, or use uniform parameters", {}, where);
    u.push_back(u.back() + (kind == Parameters::uniform ? 1.0 : kind == Parameters::chord ? d : std::sqrt(d)));
  }
  return u;
}

Curve interpolate_points(std::span<const Vec3> points, int dimension, const PointSplineOptions& options) {
  std::vector<Vec3> p(points.begin(), points.end());
  const bool periodic = options.closed || options.ends == SplineEnds::periodic;
  if (periodic && p.size() > 1 && !(p.front() == p.back())) p.push_back(p.front());
  if (p.size() < 2 || (periodic && p.size() < 4))
    throw BadInput(fmt::format("{} points: at least {} are needed", points.size(), periodic ? 3 : 2));
  const std::vector<double> u = point_parameters(p, options.parameters);
  std::vector<Vec3> tangents(p.size());
  const auto run = [&](double Vec3::*part) {
    std::vector<double> y;
    y.reserve(p.size());
    for (const Vec3& q : p) y.push_back(q.*part);
    const std::vector<double> m = spline_slopes(u, y,
                                                {.ends = periodic ? SplineEnds::periodic : options.ends,
                                                 .first_slope = options.first_tangent.*part,
                                                 .last_slope = options.last_tangent.*part});
    for (std::size_t i = 0; i < p.size(); ++i) tangents[i].*part = m[i];
  };
  run(&Vec3::x);
  run(&Vec3::y);
  if (dimension == 3) run(&Vec3::z);
  Curve curve = from_hermite(p, tangents, dimension, u);
  curve.closed = periodic;
  return curve;
}

Curve lagrange_curve(std::span<const Vec3> points, int dimension, Parameters parameters) {
  const std::vector<double> u = point_parameters(points, parameters);
  if (points.size() < 2) throw BadInput(fmt::format("{} point: at least 2 are needed", points.size()));
  std::vector<Vec3> control(points.size());
  const auto run = [&](double Vec3::*part) {
    std::vector<double> y;
    for (const Vec3& q : points) y.push_back(q.*part);
    const std::vector<double> b = Lagrange(u, y).bernstein(u.front(), u.back());
    for (std::size_t i = 0; i < b.size(); ++i) control[i].*part = b[i];
    control.front().*part = y.front();
    control.back().*part = y.back();
  };
  run(&Vec3::x);
  run(&Vec3::y);
  if (dimension == 3) run(&Vec3::z);
  Curve curve;
  curve.dimension = dimension;
  curve.breaks = {u.front()};
  curve.append(control, u.back() - u.front());
  curve.breaks.back() = u.back();
  return curve;
}

}  // namespace retalho
