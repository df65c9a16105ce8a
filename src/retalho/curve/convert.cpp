#include "retalho/curve/convert.h"

#include <fmt/format.h>

#include <cmath>

#include "retalho/bernstein/segment.h"
#include "retalho/core/error.h"

namespace retalho {

namespace {

/// The parameters of `count` points (one more when closed), checked.
std::vector<double> checked_breaks(std::span<const double> breaks, std::size_t count) {
  if (!breaks.empty() && breaks.size() != count)
    throw BadInput(fmt::format("{} parameters: {} are needed", breaks.size(), count));
  std::vector<double> u(count);
  for (std::size_t i = 0; i < count; ++i) u[i] = breaks.empty() ? static_cast<double>(i) : breaks[i];
  for (std::size_t i = 1; i < count; ++i)
    if (!(u[i] > u[i - 1]))
      throw BadInput(fmt::format("parameter {} after {}: they must ascend", u[i], u[i - 1]), {},
                     fmt::format("breaks[{}]", i));
  return u;
}

void check_counts(std::size_t points, std::size_t others, const char* what) {
  if (points < 2) throw BadInput(fmt::format("{} point: at least 2 are needed", points));
  if (points != others) throw BadInput(fmt::format("{} {} for {} points: one a point is needed", others, what, points));
}

}  // namespace

Curve from_hermite(std::span<const Vec3> points, std::span<const Vec3> tangents, int dimension,
                   std::span<const double> breaks, bool closed) {
  check_counts(points.size(), tangents.size(), "tangents");
  const std::size_t n = points.size(), segments = closed ? n : n - 1;
  const std::vector<double> u = checked_breaks(breaks, segments + 1);
  Curve curve;
  curve.dimension = dimension;
  curve.closed = closed;
  curve.breaks = {u[0]};
  for (std::size_t i = 0; i < segments; ++i) {
    const std::size_t j = (i + 1) % n;
    const double h = u[i + 1] - u[i];
    curve.append(std::array{points[i], points[i] + (h / 3) * tangents[i], points[j] - (h / 3) * tangents[j], points[j]},
                 h);
    curve.breaks.back() = u[i + 1];
  }
  return curve;
}

Curve from_hermite_quintic(std::span<const Vec3> points, std::span<const Vec3> tangents, std::span<const Vec3> seconds,
                           int dimension, std::span<const double> breaks, bool closed) {
  check_counts(points.size(), tangents.size(), "tangents");
  check_counts(points.size(), seconds.size(), "second derivatives");
  const std::size_t n = points.size(), segments = closed ? n : n - 1;
  const std::vector<double> u = checked_breaks(breaks, segments + 1);
  Curve curve;
  curve.dimension = dimension;
  curve.closed = closed;
  curve.breaks = {u[0]};
  for (std::size_t i = 0; i < segments; ++i) {
    const std::size_t j = (i + 1) % n;
    const double h = u[i + 1] - u[i];
    const Vec3 p0 = points[i], p1 = points[j], d0 = h * tangents[i], d1 = h * tangents[j], s0 = h * h * seconds[i],
               s1 = h * h * seconds[j];
    curve.append(std::array{p0, p0 + d0 / 5, p0 + 2 * d0 / 5 + s0 / 20, p1 - 2 * d1 / 5 + s1 / 20, p1 - d1 / 5, p1}, h);
    curve.breaks.back() = u[i + 1];
  }
  return curve;
}

HermiteData to_hermite(const Curve& curve) {
  HermiteData data;
  for (std::size_t i = 0; i < curve.segment_count(); ++i)
    for (const double t : {0.0, 1.0}) {
      const CurveSegment s = curve.segment(i);
      const CurveJet jet = evaluate_jet(s, t);
      const double h = s.to - s.from;
      data.points.push_back(jet.point);
      data.tangents.push_back(jet.first / h);
      data.seconds.push_back(jet.second / (h * h));
      data.breaks.push_back(t == 0 ? s.from : s.to);
    }
  return data;
}

Curve from_power(std::span<const Vec3> coefficients, double from, double to, int dimension) {
  if (coefficients.empty()) throw BadInput("a polynomial needs at least one coefficient");
  if (!(from < to)) throw BadInput(fmt::format("the interval [{}, {}] is empty", from, to));
  const std::size_t count = coefficients.size();
  std::array<std::vector<double>, 3> parts = {std::vector<double>(count), std::vector<double>(count),
                                              std::vector<double>(count)};
  double power = 1;
  for (std::size_t i = 0; i < count; ++i) {
    parts[0][i] = power * coefficients[i].x;
    parts[1][i] = power * coefficients[i].y;
    parts[2][i] = power * coefficients[i].z;
    power *= to - from;
  }
  std::vector<Vec3> points(count);
  for (std::size_t k = 0; k < 3; ++k) parts[k] = power_to_bernstein(parts[k]);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {parts[0][i], parts[1][i], parts[2][i]};
  Curve curve;
  curve.dimension = dimension;
  curve.breaks = {from};
  curve.append(points, to - from);
  curve.breaks.back() = to;
  return curve;
}

std::vector<Vec3> to_power(const CurveSegment& segment) {
  if (segment.rational()) throw UsageError("a rational segment has no power basis form");
  const std::size_t count = segment.points.size();
  std::array<std::vector<double>, 3> parts = {std::vector<double>(count), std::vector<double>(count),
                                              std::vector<double>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    parts[0][i] = segment.points[i].x;
    parts[1][i] = segment.points[i].y;
    parts[2][i] = segment.points[i].z;
  }
  for (auto& part : parts) part = bernstein_to_power(part);
  std::vector<Vec3> result(segment.points.size());
  double power = 1;
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = Vec3{parts[0][i], parts[1][i], parts[2][i]} / power;
    power *= segment.to - segment.from;
  }
  return result;
}

Curve catmull_rom(std::span<const Vec3> points, int dimension, bool closed, double power) {
  const std::size_t n = points.size();
  if (n < 2 || (closed && n < 3)) throw BadInput(fmt::format("{} points: at least {} are needed", n, closed ? 3 : 2));
  const std::size_t segments = closed ? n : n - 1;
  std::vector<double> h(segments);
  std::vector<Vec3> slope(segments), tangent(n);
  std::vector<double> u = {0};
  for (std::size_t i = 0; i < segments; ++i) {
    const Vec3 d = points[(i + 1) % n] - points[i];
    h[i] = power == 0 ? 1.0 : std::pow(norm(d), power);
    if (!(h[i] > 0))
      throw BadInput("repeats the point before it: merge them", {}, fmt::format("points[{}]", (i + 1) % n));
    slope[i] = d / h[i];
    u.push_back(u.back() + h[i]);
  }
  const auto weighted = [&](std::size_t before, std::size_t after) {
    return (h[after] * slope[before] + h[before] * slope[after]) / (h[before] + h[after]);
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (closed)
      tangent[i] = weighted((i + n - 1) % n, i);
    else if (i > 0 && i + 1 < n)
      tangent[i] = weighted(i - 1, i);
  }
  if (!closed) {
    tangent.front() = n > 2 ? 2 * slope.front() - tangent[1] : slope.front();
    tangent.back() = n > 2 ? 2 * slope.back() - tangent[n - 2] : slope.back();
  }
  return from_hermite(points, tangent, dimension, u, closed);
}

Curve from_graph(std::span<const double> bernstein, double from, double to) {
  std::vector<Vec3> points;
  const Bernstein b = elevate_to(bernstein, 1);
  const auto n = static_cast<double>(b.size() - 1);
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double s = static_cast<double>(i) / n;
    points.push_back({i + 1 == b.size() ? to : from + s * (to - from), b[i], 0});
  }
  Curve curve;
  curve.breaks = {from};
  curve.append(points, to - from);
  curve.breaks.back() = to;
  return curve;
}

}  // namespace retalho
