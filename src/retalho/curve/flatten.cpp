#include "retalho/curve/flatten.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/segment_forms.h"

namespace retalho {

namespace {

/// Upper bound for the distance of a piece from its chord. The distance from a segment is a convex function, so the
/// largest one over the hull is at a control point. Where all control points project into the chord of a polynomial
/// piece, the distance of Q(t) is at most the sum of B_i(t) |h_i| over the inner points, hence 1 - 2^(1-n) of the
/// largest height: 1/2 for a quadratic (exact), 3/4 for a cubic, 4/9 when its two heights point to opposite sides.
double chord_bound(const CurveSegment& s) {
  const auto& p = s.points;
  const std::size_t n = p.size() - 1;
  if (n < 2) return 0;
  const Vec3 chord = p[n] - p[0];
  const double length2 = norm2(chord);
  double farthest = 0;
  bool inside = length2 > 0;
  for (std::size_t i = 1; i < n; ++i) {
    const Vec3 d = p[i] - p[0];
    const double foot = length2 > 0 ? dot(d, chord) / length2 : 0;
    inside = inside && foot >= 0 && foot <= 1;
    farthest = std::max(farthest, norm(d - std::clamp(foot, 0.0, 1.0) * chord));
  }
  if (!inside || s.rational()) return farthest;
  if (n == 3) {
    const auto height = [&](std::size_t i) { return p[i] - p[0] - (dot(p[i] - p[0], chord) / length2) * chord; };
    const Vec3 a = height(1), b = height(2);
    // B1 |a| and B2 |b| along opposite directions: |B1 a + B2 b| <= max(B1, B2) max(|a|, |b|) holds only on one line.
    const bool opposite = dot(a, b) < 0 && norm(cross(a, b)) <= 1e-9 * norm(a) * norm(b);
    return farthest * (opposite ? 4.0 / 9.0 * (1 + 1e-8) : 0.75);
  }
  return farthest * (1 - std::ldexp(1.0, 1 - static_cast<int>(n)));
}

class Flattening {
 public:
  Flattening(FlatCurve& out, double tolerance, const Context& context)
      : out_(out), tolerance_(tolerance), context_(context) {}

  void visit(const CurveSegment& s, int level) {
    const double bound = chord_bound(s);
    // Half a tolerance of 1e-12 is left to rounding; below the resolution of the coordinates nothing can be gained.
    if (bound <= tolerance_ * (1 - 1e-12) || level >= 52) {
      if (out_.points.size() % 1024 == 0) context_.check();
      out_.bound = std::max(out_.bound, bound);
      out_.points.push_back(s.points.back());
      out_.parameters.push_back(s.to);
      return;
    }
    const Curve halves = split_segment(s, 0.5);
    visit(halves.segment(0), level + 1);
    visit(halves.segment(1), level + 1);
  }

 private:
  FlatCurve& out_;
  double tolerance_;
  const Context& context_;
};

}  // namespace

FlatCurve flatten(const Curve& curve, double tolerance, const Context& context) {
  if (!(tolerance > 0)) throw UsageError(fmt::format("flattening tolerance {}: it must be positive", tolerance));
  FlatCurve out;
  Flattening work(out, tolerance, context);
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    context.check();
    const CurveSegment s = curve.segment(i);
    if (out.points.empty() || !(out.points.back() == s.points.front())) {
      const bool gap = out.points.empty() || norm(out.points.back() - s.points.front()) > 1e-9 * control_size(s.points);
      if (gap) {
        out.starts.push_back(static_cast<std::uint32_t>(out.points.size()));
        out.points.push_back(s.points.front());
        out.parameters.push_back(s.from);
      }
    }
    std::vector<double> cuts;
    if (s.degree() >= 2) {
      const SegmentForms forms = segment_forms(s);
      const Bernstein speed2 = dot(forms.n, forms.n);
      const double largest = bounds(speed2).second;
      if (bounds(speed2).first <= 1e-12 * largest)
        for (const double t : speed_extrema(forms))
          if (t > 1e-9 && t < 1 - 1e-9 && evaluate(speed2, t) <= 1e-18 * largest)
            cuts.push_back(s.from + t * (s.to - s.from));
    }
    if (cuts.empty()) {
      work.visit(s, 0);
    } else {
      const Curve parts = refine(cut(curve, s.from, s.to), cuts);
      for (std::size_t k = 0; k < parts.segment_count(); ++k) work.visit(parts.segment(k), 0);
    }
  }
  out.closed = curve.closed && out.starts.size() == 1;
  if (out.closed && !(out.points.back() == out.points.front())) out.points.back() = out.points.front();
  return out;
}

std::size_t wang_steps(const CurveSegment& s, double tolerance) {
  const std::size_t n = s.points.size() - 1;
  double largest = 0;
  for (std::size_t i = 0; i + 2 <= n; ++i)
    largest = std::max(largest, norm(s.points[i + 2] - 2 * s.points[i + 1] + s.points[i]));
  const auto degree = static_cast<double>(n);
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(std::sqrt(degree * (degree - 1) * largest / (8 * tolerance)))));
}

}  // namespace retalho
