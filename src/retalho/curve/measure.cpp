#include "retalho/curve/measure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/curve/gauss.h"
#include "retalho/curve/segment_forms.h"

namespace retalho {

namespace {

bool is_zero(const Bernstein& b) {
  return std::all_of(b.begin(), b.end(), [](double v) { return v == 0; });
}

double magnitude(const Bernstein& b) {
  double m = 0;
  for (const double v : b) m = std::max(m, std::abs(v));
  return m;
}

/// Roots inside (0, 1), simple or not; nothing for the zero polynomial.
std::vector<double> inner_roots(const Bernstein& b, double zero = -1) {
  std::vector<double> result;
  if (is_zero(b)) return result;
  for (const BernsteinRoot& r : roots(b, {.zero = zero}))
    if (r.t > 0 && r.t < 1 && r.radius < 0.25) result.push_back(r.t);
  return result;
}

CurvePoint at_local(const CurveSegment& s, double t, double value) {
  return {s.from + t * (s.to - s.from), evaluate(s, t), value};
}

double local_curvature(const CurveSegment& s, double t, int dimension) {
  const CurveJet jet = evaluate_jet(s, t);
  const double speed = norm(jet.first);
  if (speed == 0) return 0;
  const Vec3 c = cross(jet.first, jet.second);
  return (dimension == 2 ? c.z : norm(c)) / (speed * speed * speed);
}

/// (Q - p) . Q' up to the positive factor w^3, in Bernstein form. Roots where Q' turns it from - to + are minima.
Bernstein approach(const SegmentForms& forms, Vec3 p) {
  const std::array<double, 3> q = {p.x, p.y, p.z};
  BernsteinVector d = forms.a;
  for (std::size_t k = 0; k < 3; ++k) {
    if (forms.w.size() == 1)
      for (double& v : d[k]) v -= q[k];
    else
      d[k] = sum(d[k], forms.w, -q[k]);
  }
  return dot(d, forms.n);
}

/// Local minima of the distance on one segment; ends count when the distance does not fall towards the inside.
void local_minima(const CurveSegment& s, Vec3 p, std::vector<CurvePoint>& out) {
  const auto add = [&](double t) {
    const Vec3 q = evaluate(s, t);
    out.push_back({t == 1 ? s.to : s.from + t * (s.to - s.from), q, norm(q - p)});
  };
  add(0);
  add(1);
  if (s.degree() < 1) return;
  const Bernstein b = approach(segment_forms(s), p);
  for (const double t : inner_roots(b)) add(t);
}

double box_distance(const CurveSegment& s, Vec3 p) {
  Vec3 low = s.points[0], high = s.points[0];
  for (const Vec3& q : s.points) {
    low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
  }
  return norm(Vec3{std::max({low.x - p.x, 0.0, p.x - high.x}), std::max({low.y - p.y, 0.0, p.y - high.y}),
                   std::max({low.z - p.z, 0.0, p.z - high.z})});
}

}  // namespace

Bounds3 exact_bounds(const Curve& curve) {
  if (curve.empty()) throw BadInput("an empty curve has no bounds");
  Bounds3 b{curve.points.front(), curve.points.front()};
  const auto take = [&](Vec3 p) {
    b.low = {std::min(b.low.x, p.x), std::min(b.low.y, p.y), std::min(b.low.z, p.z)};
    b.high = {std::max(b.high.x, p.x), std::max(b.high.y, p.y), std::max(b.high.z, p.z)};
  };
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    take(s.points.front());
    take(s.points.back());
    if (s.degree() < 2) continue;
    const SegmentForms forms = segment_forms(s);
    for (const Bernstein& slope : forms.n)
      for (const double t : inner_roots(slope)) take(evaluate(s, t));
  }
  return b;
}

double curvature(const Curve& curve, double u, Side side) {
  const auto [i, t] = locate(curve, u, side);
  return local_curvature(curve.segment(i), t, curve.dimension);
}

std::vector<CurvePoint> inflections(const Curve& curve) {
  if (curve.dimension != 2) throw UsageError("inflections are asked of plane curves only");
  std::vector<CurvePoint> result;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    const SegmentForms forms = segment_forms(s);
    const Bernstein turn = cross(forms.n, derivative(forms.n))[2];
    double size = 0;
    for (const double v : turn) size = std::max(size, std::abs(v));
    if (size <= 1e-14 * bounds(dot(forms.n, forms.n)).second) continue;  // a straight line
    const std::vector<double> found = inner_roots(turn);
    for (std::size_t k = 0; k < found.size(); ++k) {
      const double before = 0.5 * (found[k] + (k > 0 ? found[k - 1] : 0)),
                   after = 0.5 * (found[k] + (k + 1 < found.size() ? found[k + 1] : 1));
      if (evaluate(turn, before) * evaluate(turn, after) < 0)
        result.push_back(at_local(s, found[k], local_curvature(s, found[k], 2)));
    }
  }
  return result;
}

std::vector<CurvePoint> curvature_extrema(const Curve& curve) {
  // With N = Q' w^2, c = N x N': k = w^2 |c| / |N|^3. The derivative of k (plane) or k^2 (space) vanishes with
  //   (2 w' |c|^2 + w c.c') |N|^2 - 3 w |c|^2 (N.N')   (the plane: one factor c less).
  std::vector<CurvePoint> result;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    if (s.degree() < 2) continue;
    const SegmentForms forms = segment_forms(s);
    const BernsteinVector n1 = derivative(forms.n), c = cross(forms.n, n1), c1 = cross(forms.n, derivative(n1));
    const Bernstein speed2 = dot(forms.n, forms.n), turn = dot(forms.n, n1), w1 = derivative(forms.w);
    const bool plane = curve.dimension == 2;
    const Bernstein c2 = plane ? c[2] : dot(c, c), cc = plane ? c1[2] : dot(c, c1);
    Bernstein left = product(forms.w, cc);
    if (forms.w.size() > 1) left = sum(left, product(w1, c2), 2);
    const Bernstein slope = sum(product(left, speed2), product(product(forms.w, c2), turn), -3);
    double size = 0;
    for (const double v : c2) size = std::max(size, std::abs(v));
    if (size <= 1e-14 * bounds(speed2).second) continue;  // a straight line
    const double largest = bounds(speed2).second;
    // On a circle the two terms cancel all along: what is left of them is rounding, no extremum.
    const double zero = 1e-13 * (magnitude(left) * largest + 3 * magnitude(product(forms.w, c2)) * magnitude(turn));
    for (const double t : inner_roots(slope, zero)) {
      const double speed = evaluate(speed2, t);
      if (speed <= 1e-18 * largest) continue;  // a cusp: the curvature is infinite there
      result.push_back(at_local(s, t, local_curvature(s, t, curve.dimension)));
    }
  }
  return result;
}

double signed_area(const Curve& curve) {
  if (curve.dimension != 2) throw UsageError("the area under a curve in space is not defined: project it first");
  if (curve.empty()) return 0;
  double twice = 0;
  // Relative to the first point: no digits are lost to a far origin.
  const Vec3 origin = curve.points.front();
  Vec3 last = origin;
  const auto straight = [&](Vec3 a, Vec3 b) {
    return (a.x - origin.x) * (b.y - origin.y) - (a.y - origin.y) * (b.x - origin.x);
  };
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    twice += straight(last, s.points.front());
    last = s.points.back();
    if (!s.rational()) {
      Bernstein x, y;
      for (const Vec3& p : s.points) x.push_back(p.x - origin.x), y.push_back(p.y - origin.y);
      twice += integral(sum(product(x, derivative(y)), product(y, derivative(x)), -1));
      continue;
    }
    const double size = control_size(s.points);
    twice += integrate(
        [&](double t) {
          const CurveJet jet = evaluate_jet(s, t);
          return (jet.point.x - origin.x) * jet.first.y - (jet.point.y - origin.y) * jet.first.x;
        },
        0, 1, 1e-14 * size * (size + norm(last - origin)));
  }
  twice += straight(last, origin);
  return twice / 2;
}

std::vector<CurvePoint> closest_points(const Curve& curve, Vec3 p) {
  if (curve.empty()) throw BadInput("an empty curve has no nearest point");
  std::vector<CurvePoint> candidates;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const std::size_t before = candidates.size();
    local_minima(curve.segment(i), p, candidates);
    std::sort(candidates.begin() + static_cast<std::ptrdiff_t>(before), candidates.end(),
              [](const CurvePoint& a, const CurvePoint& b) { return a.at < b.at; });
  }
  // Ends of segments that meet are one candidate.
  std::vector<CurvePoint> chain;
  const double same = 1e-9 * control_size(curve.points);
  for (const CurvePoint& c : candidates)
    if (chain.empty() || c.at != chain.back().at || norm(c.point - chain.back().point) > same) chain.push_back(c);
  // A candidate is a minimum when neither neighbour along the curve is nearer: the chain holds every extremum. There is
  // no neighbour across a gap, where two candidates have one parameter.
  const std::size_t n = chain.size();
  const bool wraps = curve.closed && norm(chain.front().point - chain.back().point) <= same;
  std::vector<CurvePoint> minima;
  for (std::size_t i = 0; i < n; ++i) {
    const CurvePoint& c = chain[i];
    if (wraps && i + 1 == n && n > 1) break;  // the first one again
    const CurvePoint* left = i > 0 ? &chain[i - 1] : wraps && n > 2 ? &chain[n - 2] : nullptr;
    const CurvePoint* right = i + 1 < n ? &chain[i + 1] : nullptr;
    if (left && left->at != c.at && left->value < c.value) continue;
    if (right && right->at != c.at && right->value < c.value) continue;
    minima.push_back(c);
  }
  std::stable_sort(minima.begin(), minima.end(),
                   [](const CurvePoint& a, const CurvePoint& b) { return a.value < b.value; });
  return minima;
}

CurvePoint closest_point(const Curve& curve, Vec3 p) {
  if (curve.empty()) throw BadInput("an empty curve has no nearest point");
  std::vector<std::pair<double, std::size_t>> order(curve.segment_count());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = {box_distance(curve.segment(i), p), i};
  std::sort(order.begin(), order.end());
  std::optional<CurvePoint> best;
  std::vector<CurvePoint> candidates;
  for (const auto& [distance, i] : order) {
    if (best && distance > best->value) break;
    candidates.clear();
    local_minima(curve.segment(i), p, candidates);
    for (const CurvePoint& c : candidates)
      if (!best || c.value < best->value) best = c;
  }
  return *best;
}

}  // namespace retalho
