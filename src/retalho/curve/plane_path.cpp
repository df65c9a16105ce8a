#include "retalho/curve/plane_path.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>

#include "retalho/core/error.h"
#include "retalho/curve/flatten.h"

namespace retalho {

namespace {

Vec3 lift(Vec2 p) {
  return {p.x, p.y, 0};
}
Vec2 drop(Vec3 p) {
  return {p.x, p.y};
}

/// The text of a `d` attribute, token by token.
class PathText {
 public:
  explicit PathText(std::string_view d) : d_(d) {}

  bool done() {
    skip();
    return at_ >= d_.size();
  }
  /// The next command letter, or 0 when a number comes (the command before goes on).
  char command() {
    skip();
    const char c = d_[at_];
    if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z')) {
      ++at_;
      return c;
    }
    return 0;
  }
  double number() {
    skip();
    if (at_ < d_.size() && d_[at_] == '+') ++at_;
    double value = 0;
    const auto [end, code] = std::from_chars(d_.data() + at_, d_.data() + d_.size(), value);
    if (code != std::errc() || !std::isfinite(value)) fail("expected a number");
    at_ = static_cast<std::size_t>(end - d_.data());
    return value;
  }
  bool flag() {  // "0" or "1", which may be glued to what follows
    skip();
    if (at_ >= d_.size() || (d_[at_] != '0' && d_[at_] != '1')) fail("expected the flag 0 or 1");
    return d_[at_++] == '1';
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw BadInput(fmt::format("path data, character {}: {}", at_ + 1, what), {}, fmt::format("character {}", at_ + 1));
  }

 private:
  void skip() {
    while (at_ < d_.size() &&
           (d_[at_] == ' ' || d_[at_] == ',' || d_[at_] == '\n' || d_[at_] == '\t' || d_[at_] == '\r'))
      ++at_;
  }
  std::string_view d_;
  std::size_t at_ = 0;
};

/// An elliptic arc as rational quadratics of at most 90 degrees (SVG 1.1, appendix F.6).
void append_arc(Curve& curve, Vec2 from, Vec2 to, double rx, double ry, double degrees, bool large, bool sweep) {
  rx = std::abs(rx);
  ry = std::abs(ry);
  if (from == to) return;
  if (rx == 0 || ry == 0) {
    curve.append(std::array{lift(from), lift(to)});
    return;
  }
  const double phi = degrees * std::numbers::pi / 180, c = std::cos(phi), s = std::sin(phi);
  const Vec2 half = (from - to) / 2;
  const Vec2 p = {(c * half.x + s * half.y) / rx, (-s * half.x + c * half.y) / ry};  // on the unit circle's plane
  const double length2 = norm2(p);
  const double grow = length2 > 1 ? std::sqrt(length2) : 1;
  rx *= grow;
  ry *= grow;
  const Vec2 unit = p / grow;
  const double away = std::sqrt(std::max(0.0, 1 / std::max(norm2(unit), 1e-300) - 1)) * (large == sweep ? -1 : 1);
  const Vec2 centre = {away * unit.y, -away * unit.x};
  const double a0 = std::atan2(unit.y - centre.y, unit.x - centre.x);
  double turn = std::atan2(-unit.y - centre.y, -unit.x - centre.x) - a0;
  if (sweep && turn < 0) turn += 2 * std::numbers::pi;
  if (!sweep && turn > 0) turn -= 2 * std::numbers::pi;
  const Vec2 middle = (from + to) / 2;
  const auto place = [&](Vec2 q) {
    const Vec2 e = {rx * (q.x + centre.x), ry * (q.y + centre.y)};
    return Vec2{middle.x + c * e.x - s * e.y, middle.y + s * e.x + c * e.y};
  };
  const int parts = std::max(1, static_cast<int>(std::ceil(std::abs(turn) / (std::numbers::pi / 2) - 1e-9)));
  const double step = turn / parts, w = std::cos(step / 2);
  for (int i = 0; i < parts; ++i) {
    const double a = a0 + step * i, b = a + step;
    const Vec2 start = i == 0 ? from : drop(curve.points.back());
    const Vec2 stop = i + 1 == parts ? to : place({std::cos(b), std::sin(b)});
    const Vec2 corner = place({std::cos(a + step / 2) / w, std::sin(a + step / 2) / w});
    const std::array<double, 3> weights = {1, w, 1};
    curve.append(std::array{lift(start), lift(corner), lift(stop)}, 1, weights);
  }
}

}  // namespace

PlanePath to_path(const Curve& curve, double tolerance) {
  PlanePath path;
  for (std::size_t i = 0; i < curve.segment_count(); ++i) {
    const CurveSegment s = curve.segment(i);
    const Vec2 start = drop(s.points.front());
    if (path.points.empty() || !(path.points.back() == start)) {
      path.verbs.push_back(PathVerb::move);
      path.points.push_back(start);
    }
    if (s.degree() >= 1 && s.degree() <= 3 && !s.rational()) {
      path.verbs.push_back(s.degree() == 1 ? PathVerb::line : s.degree() == 2 ? PathVerb::quad : PathVerb::cubic);
      for (std::size_t k = 1; k < s.points.size(); ++k) path.points.push_back(drop(s.points[k]));
      continue;
    }
    Curve one;
    one.append(s.points, 1, s.weights);
    const FlatCurve flat = flatten(one, tolerance);
    for (std::size_t k = 1; k < flat.points.size(); ++k) {
      path.verbs.push_back(PathVerb::line);
      path.points.push_back(drop(flat.points[k]));
    }
  }
  if (curve.closed && !path.points.empty() && path.points.back() == path.points.front())
    path.verbs.push_back(PathVerb::close);
  return path;
}

std::string to_svg(const PlanePath& path) {
  std::string d;
  std::size_t at = 0;
  const auto pairs = [&](int count) {
    for (int k = 0; k < count; ++k, ++at)
      d += fmt::format("{}{},{}", k ? " " : "", path.points[at].x, path.points[at].y);
  };
  for (const PathVerb verb : path.verbs) {
    if (!d.empty()) d += ' ';
    switch (verb) {
      case PathVerb::move:
        d += 'M', pairs(1);
        break;
      case PathVerb::line:
        d += 'L', pairs(1);
        break;
      case PathVerb::quad:
        d += 'Q', pairs(2);
        break;
      case PathVerb::cubic:
        d += 'C', pairs(3);
        break;
      case PathVerb::close:
        d += 'Z';
        break;
    }
  }
  return d;
}

std::vector<Curve> parse_svg_path(std::string_view d) {
  std::vector<Curve> curves;
  PathText text(d);
  Vec2 start, at, handle;  // handle: the control point that S and T reflect
  char command = 0, before = 0;
  Curve* open = nullptr;
  const auto curve = [&]() -> Curve& {
    if (!open) {  // after a close, drawing goes on from the start point
      curves.emplace_back();
      open = &curves.back();
    }
    return *open;
  };
  while (!text.done()) {
    if (const char c = text.command()) {
      command = c;
    } else if (command == 0 || command == 'Z' || command == 'z') {
      text.fail("expected a command letter");
    } else if (command == 'M' || command == 'm') {
      command = command == 'M' ? 'L' : 'l';
    }
    if (curves.empty() && before == 0 && command != 'M' && command != 'm') text.fail("a path begins with M");
    const bool relative = command >= 'a';
    const char name = static_cast<char>(relative ? command - 'a' + 'A' : command);
    const auto pair = [&] {
      const double x = text.number(), y = text.number();
      return relative ? Vec2{at.x + x, at.y + y} : Vec2{x, y};
    };
    switch (name) {
      case 'M':
        start = at = pair();
        open = nullptr;
        break;
      case 'Z':
        if (open) {
          if (!(at == start)) open->append(std::array{lift(at), lift(start)});
          open->closed = true;
        }
        open = nullptr;
        at = start;
        break;
      case 'L': {
        const Vec2 p = pair();
        curve().append(std::array{lift(at), lift(p)});
        at = p;
        break;
      }
      case 'H': {
        const double x = text.number();
        const Vec2 p = {relative ? at.x + x : x, at.y};
        curve().append(std::array{lift(at), lift(p)});
        at = p;
        break;
      }
      case 'V': {
        const double y = text.number();
        const Vec2 p = {at.x, relative ? at.y + y : y};
        curve().append(std::array{lift(at), lift(p)});
        at = p;
        break;
      }
      case 'C':
      case 'S': {
        const Vec2 a = name == 'C' ? pair() : (before == 'C' || before == 'S') ? 2 * at - handle : at;
        const Vec2 b = pair(), p = pair();
        curve().append(std::array{lift(at), lift(a), lift(b), lift(p)});
        handle = b;
        at = p;
        break;
      }
      case 'Q':
      case 'T': {
        const Vec2 a = name == 'Q' ? pair() : (before == 'Q' || before == 'T') ? 2 * at - handle : at;
        const Vec2 p = pair();
        curve().append(std::array{lift(at), lift(a), lift(p)});
        handle = a;
        at = p;
        break;
      }
      case 'A': {
        const double rx = text.number(), ry = text.number(), angle = text.number();
        const bool large = text.flag(), sweep = text.flag();
        const Vec2 p = pair();
        append_arc(curve(), at, p, rx, ry, angle, large, sweep);
        at = p;
        break;
      }
      default:
        text.fail(fmt::format("'{}' is no path command", command));
    }
    before = name;
  }
  std::erase_if(curves, [](const Curve& c) { return c.empty(); });
  return curves;
}

}  // namespace retalho
