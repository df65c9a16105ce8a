#include "retalho/curve/curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "retalho/core/error.h"

namespace retalho {

namespace {

struct Homogeneous {
  Vec3 p;
  double w = 1;
};

using Row = std::array<Homogeneous, kMaxCurveDegree + 1>;

void load(const CurveSegment& s, Row& row) {
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    const double w = s.rational() ? s.weights[i] : 1.0;
    row[i] = {s.rational() ? w * s.points[i] : s.points[i], w};
  }
}

Homogeneous blend(const Homogeneous& a, const Homogeneous& b, double t) {
  return {(1 - t) * a.p + t * b.p, (1 - t) * a.w + t * b.w};
}

Homogeneous minus(const Homogeneous& a, const Homogeneous& b) {
  return {a.p - b.p, a.w - b.w};
}

}  // namespace

int Curve::degree() const {
  std::uint32_t most = 1;
  for (std::size_t i = 0; i + 1 < first.size(); ++i) most = std::max(most, first[i + 1] - first[i]);
  return static_cast<int>(most) - 1;
}

CurveSegment Curve::segment(std::size_t i) const {
  assert(i < segment_count());
  const std::size_t begin_at = first[i], count = first[i + 1] - begin_at;
  return {std::span(points).subspan(begin_at, count),
          weights.empty() ? std::span<const double>() : std::span(weights).subspan(begin_at, count), breaks[i],
          breaks[i + 1]};
}

void Curve::append(std::span<const Vec3> segment_points, double length, std::span<const double> segment_weights) {
  if (segment_points.empty()) throw BadInput("a curve segment needs at least one control point");
  if (segment_points.size() > kMaxCurveDegree + 1)
    throw BadInput(fmt::format("a curve segment of degree {}: at most {} is possible; split it or fit a spline",
                               segment_points.size() - 1, kMaxCurveDegree));
  if (!(length > 0) || !std::isfinite(length))
    throw BadInput(fmt::format("a curve segment's parameter length is {}: it must be positive", length));
  if (!segment_weights.empty()) {
    if (segment_weights.size() != segment_points.size())
      throw BadInput(fmt::format("{} weights for {} points: one a point is needed", segment_weights.size(),
                                 segment_points.size()));
    for (const double w : segment_weights)
      if (!(w > 0) || !std::isfinite(w)) throw BadInput(fmt::format("weight {}: weights must be positive", w));
    if (weights.empty()) weights.assign(points.size(), 1.0);
  }
  points.insert(points.end(), segment_points.begin(), segment_points.end());
  if (!segment_weights.empty())
    weights.insert(weights.end(), segment_weights.begin(), segment_weights.end());
  else if (!weights.empty())
    weights.resize(points.size(), 1.0);
  first.push_back(static_cast<std::uint32_t>(points.size()));
  breaks.push_back(breaks.back() + length);
}

Curve make_bezier(std::span<const Vec3> points, int degree, int dimension, std::span<const double> weights) {
  if (degree < 1) throw BadInput(fmt::format("degree {}: at least 1 is needed", degree));
  const auto n = static_cast<std::size_t>(degree);
  if (points.size() < n + 1 || (points.size() - 1) % n != 0)
    throw BadInput(fmt::format("{} points do not make a chain of degree {}: {} n + 1 points are needed", points.size(),
                               degree, degree));
  if (!weights.empty() && weights.size() != points.size())
    throw BadInput(fmt::format("{} weights for {} points: one a point is needed", weights.size(), points.size()));
  Curve curve;
  curve.dimension = dimension;
  for (std::size_t at = 0; at + n < points.size(); at += n)
    curve.append(points.subspan(at, n + 1), 1, weights.empty() ? weights : weights.subspan(at, n + 1));
  return curve;
}

Curve make_bezier(std::span<const Vec2> points) {
  std::vector<Vec3> lifted;
  for (const Vec2 p : points) lifted.push_back({p.x, p.y, 0});
  return make_bezier(lifted, static_cast<int>(points.size()) - 1, 2);
}

Curve make_polyline(std::span<const Vec3> points, int dimension, bool closed) {
  if (points.size() < 2) throw BadInput(fmt::format("a polyline needs at least 2 points, got {}", points.size()));
  Curve curve;
  curve.dimension = dimension;
  curve.closed = closed;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) curve.append(points.subspan(i, 2));
  if (closed && !(points.front() == points.back())) curve.append(std::array{points.back(), points.front()});
  return curve;
}

Vec3 evaluate(const CurveSegment& segment, double t) {
  Row row;
  load(segment, row);
  for (int r = segment.degree(); r > 0; --r)
    for (std::size_t i = 0; i < static_cast<std::size_t>(r); ++i) row[i] = blend(row[i], row[i + 1], t);
  return segment.rational() ? row[0].p / row[0].w : row[0].p;
}

CurveJet evaluate_jet(const CurveSegment& segment, double t) {
  Row row;
  load(segment, row);
  const int n = segment.degree();
  // Derivative k is n! / (n - k)! times the k-th difference of row n - k of the triangle.
  std::array<Homogeneous, 4> d{};
  for (int r = n; r >= 0; --r) {
    if (r == 3)
      d[3] = minus(minus(row[3], row[2]), minus(row[2], row[1])),
      d[3] = minus(d[3], minus(minus(row[2], row[1]), minus(row[1], row[0])));
    if (r == 2) d[2] = minus(minus(row[2], row[1]), minus(row[1], row[0]));
    if (r == 1) d[1] = minus(row[1], row[0]);
    if (r == 0) d[0] = row[0];
    for (std::size_t i = 0; i < static_cast<std::size_t>(r); ++i) row[i] = blend(row[i], row[i + 1], t);
  }
  const double f1 = n, f2 = f1 * (n - 1), f3 = f2 * (n - 2);
  CurveJet jet{d[0].p, f1 * d[1].p, f2 * d[2].p, f3 * d[3].p};
  if (n < 1) jet.first = {};
  if (n < 2) jet.second = {};
  if (n < 3) jet.third = {};
  if (segment.rational()) {  // quotient rule, Q = A / w
    const double w = d[0].w, w1 = n < 1 ? 0 : f1 * d[1].w, w2 = n < 2 ? 0 : f2 * d[2].w, w3 = n < 3 ? 0 : f3 * d[3].w;
    jet.point = jet.point / w;
    jet.first = (jet.first - w1 * jet.point) / w;
    jet.second = (jet.second - 2 * w1 * jet.first - w2 * jet.point) / w;
    jet.third = (jet.third - 3 * w1 * jet.second - 3 * w2 * jet.first - w3 * jet.point) / w;
  }
  return jet;
}

std::pair<std::size_t, double> locate(const Curve& curve, double u, Side side) {
  assert(!curve.empty());
  const auto& breaks = curve.breaks;
  const auto after = side == Side::right ? std::upper_bound(breaks.begin(), breaks.end(), u)
                                         : std::lower_bound(breaks.begin(), breaks.end(), u);
  auto i = static_cast<std::ptrdiff_t>(after - breaks.begin()) - 1;
  i = std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(curve.segment_count()) - 1);
  const auto index = static_cast<std::size_t>(i);
  const double t = (u - breaks[index]) / (breaks[index + 1] - breaks[index]);
  return {index, std::clamp(t, 0.0, 1.0)};
}

Vec3 evaluate(const Curve& curve, double u, Side side) {
  const auto [i, t] = locate(curve, u, side);
  return evaluate(curve.segment(i), t);
}

CurveJet evaluate_jet(const Curve& curve, double u, Side side) {
  const auto [i, t] = locate(curve, u, side);
  const CurveSegment segment = curve.segment(i);
  CurveJet jet = evaluate_jet(segment, t);
  const double s = 1 / (segment.to - segment.from);
  jet.first = s * jet.first;
  jet.second = s * s * jet.second;
  jet.third = s * s * s * jet.third;
  return jet;
}

std::vector<std::vector<Vec3>> casteljau_rows(const CurveSegment& segment, double t) {
  Row row;
  load(segment, row);
  std::vector<std::vector<Vec3>> rows;
  for (int r = segment.degree(); r >= 0; --r) {
    auto& out = rows.emplace_back();
    for (std::size_t i = 0; i <= static_cast<std::size_t>(r); ++i) out.push_back(row[i].p / row[i].w);
    for (std::size_t i = 0; i < static_cast<std::size_t>(r); ++i) row[i] = blend(row[i], row[i + 1], t);
  }
  return rows;
}

double control_size(std::span<const Vec3> points) {
  if (points.empty()) return 0;
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return norm(high - low);
}

}  // namespace retalho
