#include "retalho/curve/bspline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/curve/edit.h"

namespace retalho {

namespace {

struct Point4 {
  Vec3 p;
  double w = 1;
};
Point4 operator+(Point4 a, Point4 b) {
  return {a.p + b.p, a.w + b.w};
}
Point4 operator*(double s, Point4 a) {
  return {s * a.p, s * a.w};
}
double distance(Point4 a, Point4 b) {
  return std::sqrt(norm2(a.p - b.p) + (a.w - b.w) * (a.w - b.w));
}

std::vector<Point4> lift(const BSpline& s) {
  std::vector<Point4> out(s.points.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = s.weights.empty() ? Point4{s.points[i], 1} : Point4{s.weights[i] * s.points[i], s.weights[i]};
  return out;
}

void drop(const std::vector<Point4>& lifted, BSpline& s) {
  const bool rational = !s.weights.empty();
  s.points.resize(lifted.size());
  if (rational) s.weights.resize(lifted.size());
  for (std::size_t i = 0; i < lifted.size(); ++i) {
    s.points[i] = rational ? lifted[i].p / lifted[i].w : lifted[i].p;
    if (rational) s.weights[i] = lifted[i].w;
  }
}

std::size_t multiplicity(const BSpline& s, double u) {
  return static_cast<std::size_t>(std::count(s.knots.begin(), s.knots.end(), u));
}

/// k with knots[k] <= u < knots[k + 1], inside of the curve's range.
std::size_t span_of(const BSpline& s, double u) {
  const auto p = static_cast<std::size_t>(s.degree), n = s.points.size();
  auto k = static_cast<std::size_t>(std::upper_bound(s.knots.begin(), s.knots.end(), u) - s.knots.begin()) - 1;
  k = std::clamp(k, p, n - 1);
  while (k > p && s.knots[k] == s.knots[k + 1]) --k;
  return k;
}

void insert_once(std::vector<double>& knots, std::vector<Point4>& c, std::size_t p, double u, std::size_t k) {
  std::vector<Point4> q(c.size() + 1);
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (i + p <= k)
      q[i] = c[i];
    else if (i > k || i == c.size())  // at the end of an unclamped curve u is knots[n]: the share of c[n] is 0
      q[i] = c[i - 1];
    else {
      const double a = (u - knots[i]) / (knots[i + p] - knots[i]);
      q[i] = a * c[i] + (1 - a) * c[i - 1];
    }
  }
  knots.insert(knots.begin() + static_cast<std::ptrdiff_t>(k) + 1, u);
  c = std::move(q);
}

}  // namespace

void validate(const BSpline& s) {
  if (s.degree < 1 || s.degree > kMaxCurveDegree)
    throw BadInput(fmt::format("degree {}: 1 to {} is possible", s.degree, kMaxCurveDegree));
  const auto p = static_cast<std::size_t>(s.degree), n = s.points.size();
  if (n < p + 1) throw BadInput(fmt::format("{} points: a B-spline of degree {} needs at least {}", n, p, p + 1));
  if (s.knots.size() != n + p + 1)
    throw BadInput(fmt::format("{} knots: {} points of degree {} need {}", s.knots.size(), n, p, n + p + 1), {},
                   "knots");
  for (std::size_t i = 0; i < s.knots.size(); ++i) {
    if (!std::isfinite(s.knots[i])) throw BadInput("not a finite number", {}, fmt::format("knots[{}]", i));
    if (i > 0 && s.knots[i] < s.knots[i - 1])
      throw BadInput(fmt::format("{} after {}: knots must not descend", s.knots[i], s.knots[i - 1]), {},
                     fmt::format("knots[{}]", i));
  }
  if (!(s.begin() < s.end())) throw BadInput("the curve's knot interval is empty", {}, "knots");
  for (std::size_t i = 0; i + p + 1 < s.knots.size(); ++i)
    if (i > 0 && i < n - 1 && s.knots[i] == s.knots[i + p + 1])
      throw BadInput(fmt::format("knot {} more than {} times", s.knots[i], p + 1), {}, fmt::format("knots[{}]", i));
  if (!s.weights.empty() && s.weights.size() != n)
    throw BadInput(fmt::format("{} weights for {} points: one a point is needed", s.weights.size(), n), {}, "weights");
  for (std::size_t i = 0; i < s.weights.size(); ++i)
    if (!(s.weights[i] > 0) || !std::isfinite(s.weights[i]))
      throw BadInput(fmt::format("{}: weights must be positive", s.weights[i]), {}, fmt::format("weights[{}]", i));
}

Vec3 evaluate(const BSpline& s, double u) {
  const auto p = static_cast<std::size_t>(s.degree);
  u = std::clamp(u, s.begin(), s.end());
  const std::size_t k = span_of(s, u);
  std::vector<Point4> d(p + 1);
  for (std::size_t j = 0; j <= p; ++j) {
    const std::size_t i = k - p + j;
    d[j] = s.weights.empty() ? Point4{s.points[i], 1} : Point4{s.weights[i] * s.points[i], s.weights[i]};
  }
  for (std::size_t r = 1; r <= p; ++r)
    for (std::size_t j = p; j >= r; --j) {
      const std::size_t i = k - p + j;
      const double a = (u - s.knots[i]) / (s.knots[i + p + 1 - r] - s.knots[i]);
      d[j] = (1 - a) * d[j - 1] + a * d[j];
    }
  return s.weights.empty() ? d[p].p : d[p].p / d[p].w;
}

BSpline insert_knot(const BSpline& s, double u) {
  validate(s);
  if (!(u > s.begin() && u < s.end()))
    throw UsageError(fmt::format("knot {} is not between {} and {}", u, s.begin(), s.end()));
  if (multiplicity(s, u) >= static_cast<std::size_t>(s.degree))
    throw UsageError(fmt::format("knot {} already has multiplicity {}", u, multiplicity(s, u)));
  BSpline out = s;
  auto c = lift(s);
  insert_once(out.knots, c, static_cast<std::size_t>(s.degree), u, span_of(s, u));
  drop(c, out);
  return out;
}

KnotRemoval remove_knot(const BSpline& s, double u, double tolerance) {
  const auto p = static_cast<std::size_t>(s.degree);
  if (!(u > s.begin() && u < s.end()) || multiplicity(s, u) == 0)
    throw UsageError(fmt::format("{} is not an inner knot", u));
  KnotRemoval result{s, false, 0};
  // The last copy of the knot stands at r. Without it, knots v and points c give back q by one insertion of u:
  // q[i] = a_i c[i] + (1 - a_i) c[i - 1] for i in (k - p, k], k = r - 1. Solve from both sides and meet in the middle.
  const auto q = lift(s);
  const std::size_t r =
      static_cast<std::size_t>(std::upper_bound(s.knots.begin(), s.knots.end(), u) - s.knots.begin()) - 1;
  std::vector<double> v = s.knots;
  v.erase(v.begin() + static_cast<std::ptrdiff_t>(r));
  const std::size_t k = r - 1;  // v[k] <= u < v[k + 1]
  const std::size_t low = k + 1 - p;
  std::vector<Point4> c(q.size() - 1);
  for (std::size_t i = 0; i < low; ++i) c[i] = q[i];
  for (std::size_t i = k; i < c.size(); ++i) c[i] = q[i + 1];
  // Unknown c[low .. k - 1]; equations low .. k, one more than unknowns.
  const auto alpha = [&](std::size_t i) { return (u - v[i]) / (v[i + p] - v[i]); };
  std::vector<Point4> left(c), right(c);
  // Where u keeps m copies in v, the last m equations read c[i - 1] = q[i]: only the others can be solved from the
  // left.
  const std::size_t m = multiplicity(s, u) - 1, last = k - m;
  const std::size_t middle = std::max(low, (low + last + 1) / 2);
  for (std::size_t i = low; i < middle && i <= last; ++i) {
    const double a = alpha(i);
    left[i] = (1 / a) * (q[i] + (a - 1) * left[i - 1]);
  }
  for (std::size_t i = k; i > low; --i) {
    const double a = i > last ? 0 : alpha(i);
    right[i - 1] = (1 / (1 - a)) * (q[i] + (-a) * right[i]);
  }
  for (std::size_t i = low; i < k; ++i) c[i] = i < middle ? left[i] : right[i];
  BSpline candidate = s;
  candidate.knots = v;
  drop(c, candidate);
  // The error is what the candidate, with the knot put back, differs from the original.
  auto back = c;
  auto knots = v;
  insert_once(knots, back, p, u, k);
  for (std::size_t i = 0; i < q.size(); ++i) result.error = std::max(result.error, distance(back[i], q[i]));
  bool positive = true;
  for (const Point4& e : c) positive = positive && e.w > 0;
  if (positive && std::isfinite(result.error) && result.error <= tolerance) {
    result.spline = candidate;
    result.removed = true;
  }
  return result;
}

namespace {

struct Refined {
  std::vector<double> knots;
  std::vector<Point4> points;
};

/// The spline with each of its knots `wanted` (ascending) `degree` times at least: insert_once again and again, from
/// the left, on what lies to the left of the place alone. So it costs degree^2 a knot, and not the length of the
/// spline.
Refined with_full_knots(const BSpline& s, const std::vector<double>& wanted) {
  const auto p = static_cast<std::size_t>(s.degree);
  const std::vector<Point4> given = lift(s);
  Refined out;
  out.knots.reserve(s.knots.size() + p * wanted.size());
  out.points.reserve(given.size() + p * wanted.size());
  std::size_t next_knot = 0, next_point = 0;  // of those given: the first that are not taken over yet
  for (const double u : wanted) {
    for (; next_knot < s.knots.size() && s.knots[next_knot] <= u; ++next_knot) out.knots.push_back(s.knots[next_knot]);
    auto copies = static_cast<std::size_t>(out.knots.end() - std::lower_bound(out.knots.begin(), out.knots.end(), u));
    for (; copies < p; ++copies) {
      const std::size_t k = out.knots.size() - 1;  // of the last knot that is not above u
      while (out.points.size() <= k && next_point < given.size()) out.points.push_back(given[next_point++]);
      std::vector<Point4>& c = out.points;
      const auto knot = [&](std::size_t i) { return i <= k ? out.knots[i] : s.knots[next_knot + i - k - 1]; };
      c.push_back(c[std::min(k, c.size() - 1)]);  // at the end of an unclamped curve the share of a point k is 0
      for (std::size_t i = c.size() - 2; i + p > k; --i) {
        const double a = (u - knot(i)) / (knot(i + p) - knot(i));
        c[i] = a * c[i] + (1 - a) * c[i - 1];
      }
      out.knots.push_back(u);
    }
  }
  out.knots.insert(out.knots.end(), s.knots.begin() + static_cast<std::ptrdiff_t>(next_knot), s.knots.end());
  out.points.insert(out.points.end(), given.begin() + static_cast<std::ptrdiff_t>(next_point), given.end());
  return out;
}

}  // namespace

Curve to_curve(const BSpline& s) {
  validate(s);
  const auto p = static_cast<std::size_t>(s.degree);
  const double begin = s.begin(), end = s.end();
  std::vector<double> wanted;
  for (const double u : s.knots)
    if (u >= begin && u <= end && (wanted.empty() || u != wanted.back())) wanted.push_back(u);
  const auto [knots, c] = with_full_knots(s, wanted);
  Curve out;
  out.dimension = s.dimension;
  out.breaks = {begin};
  for (std::size_t i = 0; i + 1 < wanted.size(); ++i) {
    // The span that starts behind the last copy of wanted[i]: control points k - p .. k.
    const auto k =
        static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), wanted[i]) - knots.begin()) - 1;
    std::vector<Vec3> points(p + 1);
    std::vector<double> weights(s.weights.empty() ? 0 : p + 1);
    for (std::size_t j = 0; j <= p; ++j) {
      const Point4& e = c[k - p + j];
      points[j] = s.weights.empty() ? e.p : e.p / e.w;
      if (!s.weights.empty()) weights[j] = e.w;
    }
    out.append(points, wanted[i + 1] - wanted[i], weights);
    out.breaks.back() = wanted[i + 1];
  }
  out.closed = norm(out.points.front() - out.points.back()) <= 1e-12 * control_size(out.points);
  return out;
}

BSpline to_bspline(const Curve& curve, double tolerance) {
  if (curve.empty()) throw BadInput("an empty curve has no B-spline");
  const Curve even = elevate(curve, std::max(1, curve.degree()));
  BSpline s;
  s.degree = even.degree();
  s.dimension = curve.dimension;
  const auto p = static_cast<std::size_t>(s.degree);
  s.knots.assign(p + 1, even.begin());
  std::vector<double> inner;
  for (std::size_t i = 0; i < even.segment_count(); ++i) {
    const CurveSegment g = even.segment(i);
    const bool shared =
        i > 0 && g.points.front() == s.points.back() && (!g.rational() || g.weights.front() == s.weights.back());
    if (i > 0) {
      s.knots.insert(s.knots.end(), shared ? p : p + 1, g.from);
      inner.push_back(g.from);
    }
    const std::size_t skip = shared ? 1 : 0;
    s.points.insert(s.points.end(), g.points.begin() + static_cast<std::ptrdiff_t>(skip), g.points.end());
    if (g.rational())
      s.weights.insert(s.weights.end(), g.weights.begin() + static_cast<std::ptrdiff_t>(skip), g.weights.end());
  }
  s.knots.insert(s.knots.end(), p + 1, even.end());
  if (tolerance > 0) {
    const double allowed = tolerance * control_size(curve.points);
    for (const double u : inner)
      while (multiplicity(s, u) > 0 && multiplicity(s, u) <= p) {
        KnotRemoval removal = remove_knot(s, u, allowed);
        if (!removal.removed) break;
        s = std::move(removal.spline);
      }
  }
  return s;
}

std::vector<double> clamped_knots(std::size_t points, int degree) {
  const auto p = static_cast<std::size_t>(degree);
  std::vector<double> knots(p, 0.0);
  for (std::size_t i = 0; i + p < points + 1; ++i) knots.push_back(static_cast<double>(i));
  knots.insert(knots.end(), p, knots.back());
  return knots;
}

BSpline closed_bspline(const std::vector<Vec3>& points, int degree, int dimension) {
  BSpline s;
  s.degree = degree;
  s.dimension = dimension;
  s.points = points;
  for (int i = 0; i < degree; ++i) s.points.push_back(points[static_cast<std::size_t>(i) % points.size()]);
  for (std::size_t i = 0; i < s.points.size() + static_cast<std::size_t>(degree) + 1; ++i)
    s.knots.push_back(static_cast<double>(i) - degree);
  return s;
}

}  // namespace retalho
