#include "retalho/patch/sides.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/intersect.h"

namespace retalho {
namespace {

constexpr double kSame = 1e-9;  ///< of the size: ends this near are one
constexpr const char* kCorner = "UVW";

auto key(Vec3 p) {
  return std::tuple(p.x, p.y, p.z);
}

/// Does the list of control points come first, read backwards?
bool backwards_first(const Curve& curve) {
  for (std::size_t i = 0, j = curve.points.size(); i < j--; ++i) {
    if (key(curve.points[j]) < key(curve.points[i])) return true;
    if (key(curve.points[i]) < key(curve.points[j])) return false;
  }
  return false;
}

std::string text(Vec3 p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

/// The curve plus a displacement that runs linearly from `d0` at its start to `d1` at its end (in `curve`'s direction).
Curve displaced(Curve curve, Vec3 d0, Vec3 d1) {
  const double from = curve.begin(), length = curve.end() - curve.begin();
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const std::uint32_t first = curve.first[i], last = curve.first[i + 1] - 1;
    for (std::uint32_t k = first; k <= last; ++k) {
      const double t = last > first ? static_cast<double>(k - first) / (last - first) : 0;
      const double s = (curve.breaks[i] + t * (curve.breaks[i + 1] - curve.breaks[i]) - from) / length;
      curve.points[k] = curve.points[k] + (1 - s) * d0 + s * d1;
    }
  }
  return curve;
}

/// Largest gap of the three corners when the sides of `mask` are run backwards.
double largest_gap(const PatchSides& sides, unsigned mask) {
  const auto start = [&](std::size_t i) { return (mask >> i & 1U) != 0 ? sides[i].end() : sides[i].start(); };
  const auto end = [&](std::size_t i) { return (mask >> i & 1U) != 0 ? sides[i].start() : sides[i].end(); };
  double gap = 0;
  for (std::size_t i = 0; i < 3; ++i) gap = std::max(gap, norm(end(i) - start((i + 1) % 3)));
  return gap;
}

std::string reversal_hint(const PatchSides& sides, double tolerance) {
  for (const unsigned mask : {1U, 2U, 4U, 3U, 5U, 6U}) {
    if (largest_gap(sides, mask) > tolerance) continue;
    std::string names;
    for (unsigned i = 0; i < 3; ++i)
      if ((mask >> i & 1U) != 0) names += fmt::format("{}{}", names.empty() ? "" : " and ", i + 1);
    return fmt::format(". Side {} {} reversed: give {} points in the other order, or \"reversed\": true", names,
                       names.size() > 1 ? "look" : "looks", names.size() > 1 ? "their" : "its");
  }
  const PatchSides turned = {sides[1], sides[0], sides[2]};
  for (unsigned mask = 0; mask < 8; ++mask)
    if (largest_gap(turned, mask) <= tolerance)
      return ". In another order they would meet: side 1 runs from U to V, side 2 from V to W, side 3 from W to U";
  return ". Sides that nearly meet are joined by --snap T, T at least the gap";
}

void check_crossings(const PatchSides& sides, double size, const std::string& where) {
  const auto fraction = [](const SideCurve& side, double u) {
    const double s = (u - side.curve().begin()) / (side.curve().end() - side.curve().begin());
    return side.reversed() ? 1 - s : s;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    for (const Crossing& hit : self_intersections(sides[i].curve())) {
      if (norm(sides[i].start() - hit.point) < 1e-6 * size && norm(sides[i].end() - hit.point) < 1e-6 * size) continue;
      throw BadInput(fmt::format("{}side {} crosses itself at {}", where, i + 1, text(hit.point)), {},
                     fmt::format("side {}", i + 1));
    }
    const std::size_t j = (i + 1) % 3;
    const Vec3 corner = sides[i].end();
    for (const Crossing& hit : intersections(sides[i].curve(), sides[j].curve())) {
      if (norm(hit.point - corner) < 1e-6 * size) continue;
      throw BadInput(
          fmt::format("{}sides {} and {} {} at {} (parameters {:.6g} and {:.6g} of 0 to 1), away from their corner {}",
                      where, i + 1, j + 1, hit.overlap ? "run along each other" : "cross", text(hit.point),
                      fraction(sides[i], hit.first), fraction(sides[j], hit.second), kCorner[j]),
          {}, fmt::format("sides {} and {}", i + 1, j + 1));
    }
  }
}

}  // namespace

SideCurve::SideCurve(Curve curve, bool reversed, SidePlacement placement)
    : curve_(std::move(curve)), reversed_(reversed), placement_(placement) {
  if (curve_.empty()) throw BadInput("a side is a curve without segments");
  if (backwards_first(curve_)) {
    curve_ = retalho::reverse(curve_);
    reversed_ = !reversed_;
  }
  if (placement_ == SidePlacement::arc_length) length_ = std::make_shared<const ArcLength>(curve_);
}

SideJet SideCurve::canonical(double s) const {
  if (function_) return function_(s);
  if (!length_) {
    const double length = curve_.end() - curve_.begin();
    const CurveJet jet = evaluate_jet(curve_, s >= 1 ? curve_.end() : curve_.begin() + s * length);
    return {jet.point, length * jet.first, (length * length) * jet.second};
  }
  const double total = length_->total();
  const double t = s >= 1 ? curve_.end() : length_->parameter_at(s * total);
  const CurveJet jet = evaluate_jet(curve_, t);
  const double speed = norm(jet.first);
  if (!(speed > 0)) return {jet.point, {}, {}};  // the curve stands still: no direction to be had
  const double t1 = total / speed, t2 = -total * dot(jet.first, jet.second) / (speed * speed * speed) * t1;
  return {jet.point, t1 * jet.first, (t1 * t1) * jet.second + t2 * jet.first};
}

SideJet SideCurve::jet(double s) const {
  if (!reversed_) return canonical(s);
  SideJet jet = canonical(1 - s);
  jet.first = -jet.first;
  return jet;
}

Vec3 SideCurve::point(double s) const {
  return canonical(reversed_ ? 1 - s : s).point;
}

Vec3 SideCurve::node(std::size_t k, std::size_t n) const {
  const std::size_t along = reversed_ ? n - k : k;
  return canonical(static_cast<double>(along) / static_cast<double>(n)).point;
}

double size_of(const PatchSides& sides) {
  std::vector<Vec3> all;
  for (const SideCurve& side : sides) all.insert(all.end(), side.curve().points.begin(), side.curve().points.end());
  return control_size(all);
}

PatchSides join_sides(const PatchSides& sides, const SideOptions& options, const std::string& where) {
  const std::string prefix = where.empty() ? std::string() : where + ": ";
  if (!(options.snap >= 0)) throw UsageError("the snapping distance must be 0 or more", {}, "--snap");
  for (const SideCurve& side : sides)
    if (side.curve().empty()) throw UsageError("only sides that are curves can be joined");
  const double size = size_of(sides), tolerance = std::max(kSame * size, options.snap);
  for (std::size_t i = 0; i < 3; ++i) {
    const double length = control_size(sides[i].curve().points);
    if (!(length > kSame * size))
      throw BadInput(fmt::format("{}side {} has no length: all of it is at {}", prefix, i + 1, text(sides[i].start())),
                     {}, fmt::format("side {}", i + 1));
    if (norm(sides[i].start() - sides[i].end()) <= tolerance)
      throw BadInput(fmt::format("{}side {} ends where it starts, at {}: a patch has three corners", prefix, i + 1,
                                 text(sides[i].start())),
                     {}, fmt::format("side {}", i + 1));
  }
  // The three corners: the end of side i and the start of the next.
  std::array<Vec3, 3> corner;  // where side i ends
  bool moved = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const Vec3 a = sides[i].end(), b = sides[j].start();
    const double gap = norm(a - b);
    if (!(gap <= tolerance))
      throw BadInput(
          fmt::format(
              "{}sides {} and {} do not meet at corner {}: side {} ends at {}, side {} starts at {}, {:.6g} apart{}",
              prefix, i + 1, j + 1, kCorner[j], i + 1, text(a), j + 1, text(b), gap, reversal_hint(sides, tolerance)),
          {}, fmt::format("corner {}", kCorner[j]));
    corner[i] = gap == 0 ? a : 0.5 * (a + b);
    moved = moved || gap != 0;
  }
  PatchSides joined = sides;
  for (std::size_t i = 0; moved && i < 3; ++i) {
    Vec3 d0 = corner[(i + 2) % 3] - sides[i].start(), d1 = corner[i] - sides[i].end();
    if (d0 == Vec3{} && d1 == Vec3{}) continue;
    if (sides[i].reversed()) std::swap(d0, d1);
    Curve curve = displaced(sides[i].curve(), d0, d1);
    curve.points.front() = sides[i].reversed() ? corner[i] : corner[(i + 2) % 3];
    curve.points.back() = sides[i].reversed() ? corner[(i + 2) % 3] : corner[i];
    joined[i] = SideCurve(std::move(curve), sides[i].reversed(), sides[i].placement());
  }
  if (options.crossings) check_crossings(joined, size, prefix);
  return joined;
}

Vec2 side_parameters(int side, double s) {
  if (side == 0) return {1 - s, s};
  return side == 1 ? Vec2{0, 1 - s} : Vec2{s, 0};
}

Vec2 side_direction(int side) {
  if (side == 0) return {-1, 1};
  return side == 1 ? Vec2{0, -1} : Vec2{1, 0};
}

double side_argument(int side, Vec2 uv) {
  if (side == 0) return uv.y;
  return side == 1 ? 1 - uv.y : uv.x;
}

}  // namespace retalho
