#include "retalho/curve/edit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "retalho/bernstein/segment.h"
#include "retalho/core/error.h"
#include "retalho/curve/segment_forms.h"

namespace retalho {

namespace {

/// One coordinate (0..2) of a segment in homogeneous form, or its weights (3).
Bernstein coordinate(const CurveSegment& s, int which) {
  Bernstein c(s.points.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double w = s.rational() ? s.weights[i] : 1.0;
    const Vec3& p = s.points[i];
    const double v = which == 0 ? p.x : which == 1 ? p.y : which == 2 ? p.z : 1.0;
    c[i] = which == 3 ? w : s.rational() ? w * v : v;
  }
  return c;
}

/// Appends a segment given by its four coordinates.
void append_coordinates(Curve& curve, const std::array<Bernstein, 4>& c, double length, bool rational) {
  std::vector<Vec3> points(c[0].size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = {c[0][i], c[1][i], c[2][i]};
    if (rational) points[i] = points[i] / c[3][i];
  }
  curve.append(points, length, rational ? std::span<const double>(c[3]) : std::span<const double>());
}

Curve like(const Curve& curve) {
  Curve out;
  out.dimension = curve.dimension;
  out.breaks = {curve.breaks.front()};
  return out;
}

std::array<Bernstein, 4> coordinates(const CurveSegment& s) {
  return {coordinate(s, 0), coordinate(s, 1), coordinate(s, 2), s.rational() ? coordinate(s, 3) : Bernstein()};
}

void copy_segment(Curve& out, const CurveSegment& s) {
  out.append(s.points, s.to - s.from, s.weights);
}

void check_parameter(const Curve& curve, double u) {
  if (!(u >= curve.begin() && u <= curve.end()))
    throw UsageError(fmt::format("parameter {} is outside of the curve's [{}, {}]", u, curve.begin(), curve.end()));
}

Bernstein reduced(const Bernstein& b, int degree) {
  const auto m = static_cast<Eigen::Index>(degree), n = static_cast<Eigen::Index>(b.size()) - 1;
  // Elevation as a matrix: column j is the Bernstein polynomial B_j of degree m written in degree n.
  Eigen::MatrixXd e(n + 1, m + 1);
  for (Eigen::Index j = 0; j <= m; ++j) {
    Bernstein unit(static_cast<std::size_t>(m) + 1, 0.0);
    unit[static_cast<std::size_t>(j)] = 1;
    const Bernstein high = elevate_to(unit, static_cast<int>(n));
    for (Eigen::Index i = 0; i <= n; ++i) e(i, j) = high[static_cast<std::size_t>(i)];
  }
  Bernstein r(static_cast<std::size_t>(m) + 1);
  r.front() = b.front();
  r.back() = b.back();
  if (m >= 2) {
    Eigen::VectorXd rest =
        Eigen::Map<const Eigen::VectorXd>(b.data(), n + 1) - e.col(0) * b.front() - e.col(m) * b.back();
    const Eigen::VectorXd inner = e.middleCols(1, m - 1).colPivHouseholderQr().solve(rest);
    for (Eigen::Index j = 1; j < m; ++j) r[static_cast<std::size_t>(j)] = inner(j - 1);
  }
  return r;
}

}  // namespace

Curve split_segment(const CurveSegment& segment, double t) {
  std::array<Bernstein, 4> left, right;
  for (int k = 0; k < 4; ++k) {
    if (k == 3 && !segment.rational()) break;
    const auto at = static_cast<std::size_t>(k);
    const Bernstein c = coordinate(segment, k);
    left[at].resize(c.size());
    right[at].resize(c.size());
    subdivide(c, t, left[at], right[at]);
  }
  Curve out;
  out.breaks = {segment.from};
  const double middle = segment.from + t * (segment.to - segment.from);
  append_coordinates(out, left, middle - segment.from, segment.rational());
  append_coordinates(out, right, segment.to - middle, segment.rational());
  out.breaks = {segment.from, middle, segment.to};
  return out;
}

Curve cut_segment(const CurveSegment& segment, double t0, double t1) {
  Curve whole;
  whole.breaks = {segment.from};
  copy_segment(whole, segment);
  whole.breaks.back() = segment.to;
  const auto keep = [](const Curve& halves, std::size_t which) {
    const CurveSegment s = halves.segment(which);
    Curve out;
    out.breaks = {s.from};
    copy_segment(out, s);
    out.breaks = {s.from, s.to};
    return out;
  };
  if (t0 > 0) whole = keep(split_segment(whole.segment(0), t0), 1);
  if (t1 < 1) whole = keep(split_segment(whole.segment(0), (t1 - t0) / (1 - t0)), 0);
  return whole;
}

Curve cut(const Curve& curve, double u0, double u1) {
  check_parameter(curve, u0);
  check_parameter(curve, u1);
  if (!(u0 < u1)) throw UsageError(fmt::format("the part from {} to {} is empty", u0, u1));
  Curve out = like(curve);
  out.breaks = {u0};
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    const double from = std::max(u0, s.from), to = std::min(u1, s.to);
    if (!(from < to)) continue;
    const double length = s.to - s.from;
    const Curve piece = cut_segment(s, (from - s.from) / length, to == s.to ? 1.0 : (to - s.from) / length);
    copy_segment(out, piece.segment(0));
    out.breaks.back() = to;
  }
  return out;
}

std::pair<Curve, Curve> split(const Curve& curve, double u) {
  if (!(u > curve.begin() && u < curve.end()))
    throw UsageError(fmt::format("cannot split at {}: it is not between {} and {}", u, curve.begin(), curve.end()));
  return {cut(curve, curve.begin(), u), cut(curve, u, curve.end())};
}

Curve refine(const Curve& curve, std::span<const double> parameters) {
  std::vector<double> all(parameters.begin(), parameters.end());
  std::sort(all.begin(), all.end());
  Curve out = like(curve);
  out.closed = curve.closed;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    std::vector<double> inner = {s.from};
    for (const double u : all)
      if (u > inner.back() && u < s.to) inner.push_back(u);
    inner.push_back(s.to);
    for (std::size_t k = 0; k + 1 < inner.size(); ++k) {
      const double h = s.to - s.from;
      const Curve piece =
          cut_segment(s, (inner[k] - s.from) / h, k + 2 == inner.size() ? 1.0 : (inner[k + 1] - s.from) / h);
      copy_segment(out, piece.segment(0));
      out.breaks.back() = inner[k + 1];
    }
  }
  return out;
}

Curve reverse(const Curve& curve) {
  Curve out = like(curve);
  out.closed = curve.closed;
  for (std::size_t i = curve.segment_count(); i-- > 0;) {
    const CurveSegment s = curve.segment(i);
    const std::vector<Vec3> points(s.points.rbegin(), s.points.rend());
    const std::vector<double> weights(s.weights.rbegin(), s.weights.rend());
    out.append(points, s.to - s.from, weights);
  }
  out.breaks.back() = curve.end();
  return out;
}

Curve elevate(const Curve& curve, int degree) {
  if (degree > kMaxCurveDegree)
    throw BadInput(fmt::format("degree {}: at most {} is possible", degree, kMaxCurveDegree));
  Curve out = like(curve);
  out.closed = curve.closed;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    auto c = coordinates(s);
    for (auto& part : c)
      if (!part.empty()) part = elevate_to(part, degree);
    append_coordinates(out, c, s.to - s.from, s.rational());
  }
  out.breaks = curve.breaks;
  return out;
}

Reduction reduce(const Curve& curve, int degree) {
  if (degree < 1) throw UsageError(fmt::format("degree {}: at least 1 is needed", degree));
  if (curve.rational()) throw UsageError("the degree of a rational curve cannot be reduced: flatten or fit it instead");
  Reduction result{like(curve), 0};
  result.curve.closed = curve.closed;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    auto c = coordinates(s);
    if (s.degree() > degree) {
      std::array<Bernstein, 4> low;
      std::vector<double> distance2(s.points.size(), 0.0);
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = reduced(c[k], degree);
        const Bernstein back = elevate_to(low[k], s.degree());
        for (std::size_t j = 0; j < back.size(); ++j) distance2[j] += (back[j] - c[k][j]) * (back[j] - c[k][j]);
      }
      result.error = std::max(result.error, std::sqrt(*std::max_element(distance2.begin(), distance2.end())));
      c = low;
    }
    append_coordinates(result.curve, c, s.to - s.from, false);
  }
  result.curve.breaks = curve.breaks;
  return result;
}

Curve transform(const Curve& curve, const Affine& m) {
  Curve out = curve;
  for (Vec3& p : out.points) {
    const auto row = [&](std::size_t k) { return m[k][0] * p.x + m[k][1] * p.y + m[k][2] * p.z + m[k][3]; };
    p = {row(0), row(1), row(2)};
  }
  return out;
}

Curve hodograph(const Curve& curve) {
  Curve out = like(curve);
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    const SegmentForms forms = segment_forms(s);
    std::array<Bernstein, 4> c;
    const double scale = 1 / (s.to - s.from);
    if (s.rational()) c[3] = product(forms.w, forms.w);
    for (std::size_t k = 0; k < 3; ++k) {
      c[k] = forms.n[k];
      if (s.rational()) c[k] = elevate_to(c[k], static_cast<int>(c[3].size()) - 1);
      for (double& v : c[k]) v *= scale;
    }
    append_coordinates(out, c, s.to - s.from, s.rational());
  }
  out.breaks = curve.breaks;
  return out;
}

Curve with_dimension(const Curve& curve, int dimension) {
  Curve out = curve;
  out.dimension = dimension;
  if (dimension == 2)
    for (Vec3& p : out.points) p.z = 0;
  return out;
}

}  // namespace retalho
