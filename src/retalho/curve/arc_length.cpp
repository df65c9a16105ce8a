#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/curve/gauss.h"
#include "retalho/curve/measure.h"
#include "retalho/curve/segment_forms.h"

namespace retalho {

namespace {

/// Speed by the local parameter, from the hodograph in power-free form.
class Speed {
 public:
  explicit Speed(const CurveSegment& s) : segment_(s) {}
  double operator()(double t) const { return norm(evaluate_jet(segment_, t).first); }

 private:
  CurveSegment segment_;
};

/// Where panels must end: local parameters, 0 and 1 among them.
std::vector<double> panel_ends(const CurveSegment& s) {
  std::vector<double> ends = {0};
  if (s.degree() >= 2 || s.rational())
    for (const double t : speed_extrema(segment_forms(s)))
      if (t > ends.back() + 1e-12 && t < 1 - 1e-12) ends.push_back(t);
  ends.push_back(1);
  return ends;
}

/// The scale that tolerances refer to: the control polygon's length is no less than the segment's.
double polygon_length(const CurveSegment& s) {
  double l = 0;
  for (std::size_t i = 0; i + 1 < s.points.size(); ++i) l += norm(s.points[i + 1] - s.points[i]);
  return l;
}

double segment_length(const CurveSegment& s, double t0, double t1, const std::vector<double>& ends, double relative) {
  const Speed speed(s);
  // Far from the origin the speed itself is rounded, and panels would be halved for ever after nothing.
  double largest = 0;
  for (const auto& p : s.points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double rounding = 4e-16 * s.degree() * largest;
  const double tolerance = std::max(std::max(relative, 1e-15) * polygon_length(s), rounding);
  double total = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double a = std::max(t0, ends[i]), b = std::min(t1, ends[i + 1]);
    if (a < b) total += integrate(speed, a, b, tolerance);
  }
  return total;
}

}  // namespace

double arc_length(const Curve& curve, double relative) {
  return curve.empty() ? 0 : arc_length(curve, curve.begin(), curve.end(), relative);
}

double arc_length(const Curve& curve, double u0, double u1, double relative) {
  if (!(u0 <= u1))
    throw UsageError(fmt::format("length from {} to {}: the first must not be above the second", u0, u1));
  double total = 0;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    if (s.to <= u0 || s.from >= u1) continue;
    const double h = s.to - s.from;
    total +=
        segment_length(s, std::max(0.0, (u0 - s.from) / h), std::min(1.0, (u1 - s.from) / h), panel_ends(s), relative);
  }
  return total;
}

ArcLength::ArcLength(const Curve& curve, double relative)
    : curve_(curve), relative_(relative), parameters_{curve.begin()}, lengths_{0} {
  // Between two entries the speed has no cusp inside and changes monotonically: Newton is safe there.
  for (std::size_t i = 0; i < curve_.segment_count(); ++i) {
    const CurveSegment s = curve_.segment(i);
    const std::vector<double> ends = panel_ends(s);
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      lengths_.push_back(lengths_.back() + segment_length(s, ends[k], ends[k + 1], ends, relative_));
      parameters_.push_back(k + 2 == ends.size() ? s.to : s.from + ends[k + 1] * (s.to - s.from));
    }
  }
}

double ArcLength::length_at(double u) const {
  u = std::clamp(u, parameters_.front(), parameters_.back());
  const auto after = std::upper_bound(parameters_.begin(), parameters_.end(), u);
  const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - parameters_.begin() - 1));
  return lengths_[i] + (u > parameters_[i] ? arc_length(curve_, parameters_[i], u, relative_) : 0);
}

double ArcLength::parameter_at(double s) const {
  s = std::clamp(s, 0.0, total());
  const auto found = std::lower_bound(lengths_.begin(), lengths_.end(), s);
  const auto i = static_cast<std::size_t>(found - lengths_.begin());
  if (i == 0 || lengths_[i] == s) return parameters_[i];
  double low = parameters_[i - 1], high = parameters_[i];
  double u = low + (high - low) * (s - lengths_[i - 1]) / (lengths_[i] - lengths_[i - 1]);
  for (int step = 0; step < 60; ++step) {
    const double missing = s - lengths_[i - 1] - arc_length(curve_, parameters_[i - 1], u, relative_);
    (missing > 0 ? low : high) = u;
    if (std::abs(missing) <= 1e-15 * total()) break;
    const double speed = norm(evaluate_jet(curve_, u, Side::left).first);
    double next = speed > 0 ? u + missing / speed : low - 1;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == u) break;
    u = next;
  }
  return u;
}

std::vector<double> ArcLength::equal_parts(std::size_t n) const {
  if (n < 2) throw UsageError(fmt::format("{} points at equal distances: at least 2 are needed", n));
  std::vector<double> result(n);
  for (std::size_t i = 0; i < n; ++i)
    result[i] = parameter_at(total() * static_cast<double>(i) / static_cast<double>(n - 1));
  return result;
}

}  // namespace retalho
