#include "retalho/curve/continuity.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "retalho/curve/edit.h"
#include "retalho/curve/segment_forms.h"

namespace retalho {

namespace {

/// Limits at a join by one common parameter, and the scales that say what counts as zero.
struct Limit {
  std::array<Vec3, 4> d;          // point and derivatives
  std::array<double, 4> scale{};  // the largest n! / (n - k)! |k-th control difference|
  Vec3 tangent;                   // unit, in the direction of travel; 0 for a single point
  bool moving = false;            // the speed is not zero
};

std::array<double, 4> difference_scales(const CurveSegment& segment) {
  std::array<double, 4> scale{};
  std::vector<Vec3> row(segment.points.begin(), segment.points.end());
  double factor = 1;
  for (std::size_t k = 1; k < 4 && row.size() > 1; ++k) {
    factor *= static_cast<double>(row.size() - 1);
    for (std::size_t i = 0; i + 1 < row.size(); ++i) row[i] = row[i + 1] - row[i];
    row.pop_back();
    for (const Vec3& v : row) scale[k] = std::max(scale[k], factor * norm(v));
  }
  return scale;
}

/// Direction of travel from the first derivative that is not zero: sign + to the right, (-1)^(m - 1) to the left.
Vec3 travel_direction(const CurveSegment& segment, bool at_end, double tolerance) {
  // Derivative m at an end is zero for all m below the first control point that differs from the end point, and then
  // points along the difference: at the end of a segment the sign (-1)^(m-1) is already in "end minus point".
  const auto& p = segment.points;
  const double size = control_size(p);
  const std::size_t n = p.size();
  for (std::size_t k = 1; k < n; ++k) {
    const Vec3 d = at_end ? p[n - 1] - p[n - 1 - k] : p[k] - p[0];
    if (norm(d) > tolerance * size) return d / norm(d);
  }
  return {};
}

Limit limit_of(const CurveSegment& segment, bool at_end, double unit, double zero) {
  Limit limit;
  const CurveJet jet = evaluate_jet(segment, at_end ? 1 : 0);
  limit.scale = difference_scales(segment);
  const double s = unit / (segment.to - segment.from);
  limit.d = {jet.point, s * jet.first, s * s * jet.second, s * s * s * jet.third};
  double power = 1;
  for (std::size_t k = 1; k < 4; ++k) limit.scale[k] *= (power *= s);
  limit.moving = norm(limit.d[1]) > zero * limit.scale[1];
  limit.tangent = limit.moving ? limit.d[1] / norm(limit.d[1]) : travel_direction(segment, at_end, zero);
  return limit;
}

Vec3 curvature_vector(const Limit& limit) {
  const double speed2 = norm2(limit.d[1]);
  return (limit.d[2] - (dot(limit.d[2], limit.d[1]) / speed2) * limit.d[1]) / speed2;
}

double signed_curvature(const Limit& limit, const Vec3& vector, int dimension) {
  if (dimension == 3) return norm(vector);
  return limit.d[1].x * vector.y - limit.d[1].y * vector.x < 0 ? -norm(vector) : norm(vector);
}

double turning_angle(const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

}  // namespace

const char* join_kind_name(JoinKind kind) {
  switch (kind) {
    case JoinKind::regular:
      return "regular";
    case JoinKind::stop:
      return "stop";
    case JoinKind::cusp:
      return "cusp";
    case JoinKind::point:
      return "point";
  }
  return "";
}

Join analyse_join(const CurveSegment& left, const CurveSegment& right, int dimension,
                  const ContinuityOptions& options) {
  // One unit of the parameter for both sides, so that scales of the two can be compared.
  const double unit = std::max(left.to - left.from, right.to - right.from);
  const Limit l = limit_of(left, true, unit, options.derivative), r = limit_of(right, false, unit, options.derivative);
  const double size = std::max(control_size(left.points), control_size(right.points));
  Join join;
  join.point = l.d[0];
  join.gap = norm(r.d[0] - l.d[0]);
  const bool meets = join.gap <= options.position * size;
  const auto agrees = [&](std::size_t k) {
    // Rounding of a k-th difference is relative to the points; so a scale that is nothing but rounding (a straight
    // line's second differences) is lifted to that of the first differences.
    const double scale = std::max({l.scale[k], r.scale[k], l.scale[1], r.scale[1]});
    return norm(r.d[k] - l.d[k]) <= options.derivative * scale;
  };
  if (meets) join.c = agrees(1) ? (agrees(2) ? 2 : 1) : 0;
  const bool known = norm2(l.tangent) > 0 && norm2(r.tangent) > 0;
  join.angle = known ? turning_angle(l.tangent, r.tangent) : 0;
  if (!known)
    join.kind = JoinKind::point;
  else if (!l.moving || !r.moving)
    join.kind = std::numbers::pi - join.angle <= std::sqrt(options.angle) ? JoinKind::cusp : JoinKind::stop;
  if (meets) join.g = 0;
  const Vec3 kl = l.moving ? curvature_vector(l) : Vec3{}, kr = r.moving ? curvature_vector(r) : Vec3{};
  join.curvature_left = l.moving ? signed_curvature(l, kl, dimension) : 0;
  join.curvature_right = r.moving ? signed_curvature(r, kr, dimension) : 0;
  join.curvature_gap = norm(kr - kl);
  if (l.moving && r.moving) {
    join.speed_ratio = norm(r.d[1]) / norm(l.d[1]);
    if (meets && join.angle <= options.angle) {
      join.g = 1;
      if (join.curvature_gap * size <= options.curvature * std::max(1.0, norm(kl) * size)) join.g = 2;
    }
  } else {
    join.speed_ratio = l.moving || r.moving ? 0 : 1;
  }
  return join;
}

Join analyse_inside(const CurveSegment& segment, double t, int dimension, const ContinuityOptions& options) {
  const Curve halves = split_segment(segment, t);
  Join join = analyse_join(halves.segment(0), halves.segment(1), dimension, options);
  join.at = segment.from + t * (segment.to - segment.from);
  join.c = 2;  // one polynomial (or quotient with a positive denominator): every derivative exists
  return join;
}

std::vector<Join> analyse_joins(const Curve& curve, const ContinuityOptions& options) {
  std::vector<Join> joins;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment segment = curve.segment(i);
    if (segment.degree() >= 2) {
      for (const double t : speed_extrema(segment_forms(segment))) {
        if (t <= 1e-9 || t >= 1 - 1e-9) continue;
        Join join = analyse_inside(segment, t, curve.dimension, options);
        if (join.kind == JoinKind::regular) continue;
        join.left = join.right = i;
        joins.push_back(join);
      }
    }
    const bool last = i + 1 == curve.segment_count();
    if (last && !curve.closed) break;
    Join join = analyse_join(segment, curve.segment(last ? 0 : i + 1), curve.dimension, options);
    join.left = i;
    join.right = last ? 0 : i + 1;
    join.at = segment.to;
    joins.push_back(join);
  }
  return joins;
}

}  // namespace retalho
