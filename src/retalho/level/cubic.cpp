#include "retalho/level/cubic.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

namespace retalho {
namespace {

Vec2 blend(Vec2 a, Vec2 b, double t) {
  return (1 - t) * a + t * b;
}

/// The two parts at t.
std::pair<Cubic, Cubic> cut(const Cubic& c, double t) {
  const Vec2 a = blend(c[0], c[1], t), b = blend(c[1], c[2], t), d = blend(c[2], c[3], t);
  const Vec2 e = blend(a, b, t), f = blend(b, d, t), g = blend(e, f, t);
  return {{c[0], a, e, g}, {g, f, d, c[3]}};
}

Vec2 point(const Cubic& c, double t) {
  const double s = 1 - t;
  return s * s * s * c[0] + 3 * s * s * t * c[1] + 3 * s * t * t * c[2] + t * t * t * c[3];
}

double distance2_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double length = norm2(d), t = length > 0 ? std::clamp(dot(p - a, d) / length, 0.0, 1.0) : 0;
  return norm2(p - (a + t * d));
}

/// Every difference of control points goes forward along `d`, by more than rounding.
bool advances(const Cubic& c, Vec2 d) {
  const double least = 1e-13 * (std::abs(c[0].x) + std::abs(c[0].y) + std::abs(c[3].x) + std::abs(c[3].y)) * norm(d);
  return dot(c[1] - c[0], d) > least && dot(c[2] - c[1], d) > least && dot(c[3] - c[2], d) > least;
}

/// How far along its tangents the inner control points lie: least squares for the parameters `t`.
Cubic best(std::span<const Vec2> q, std::span<const double> t, Vec2 start, Vec2 end) {
  double aa = 0, ab = 0, bb = 0, ar = 0, br = 0;
  const Vec2 p0 = q.front(), p3 = q.back();
  for (std::size_t i = 0; i < q.size(); ++i) {
    const double u = t[i], v = 1 - u, b1 = 3 * v * v * u, b2 = 3 * v * u * u;
    const Vec2 a = b1 * start, b = -b2 * end;
    const Vec2 rest = q[i] - ((v * v * v + b1) * p0 + (u * u * u + b2) * p3);
    aa += dot(a, a);
    ab += dot(a, b);
    bb += dot(b, b);
    ar += dot(a, rest);
    br += dot(b, rest);
  }
  const double chord = norm(p3 - p0), det = aa * bb - ab * ab;
  double alpha = chord / 3, beta = chord / 3;
  if (std::abs(det) > 1e-12 * aa * bb) {
    const double x = (ar * bb - br * ab) / det, y = (aa * br - ab * ar) / det;
    if (x > 0.02 * chord && y > 0.02 * chord && x < 3 * chord && y < 3 * chord) alpha = x, beta = y;
  }
  return {p0, p0 + alpha * start, p3 - beta * end, p3};
}

/// One Newton step of each inner parameter towards the curve's nearest point.
void reparametrize(const Cubic& c, std::span<const Vec2> q, std::span<double> t) {
  const Vec2 a = c[1] - c[0], b = c[2] - c[1], d = c[3] - c[2];
  for (std::size_t i = 1; i + 1 < q.size(); ++i) {
    const double u = t[i], v = 1 - u;
    const Vec2 first = 3 * (v * v * a + 2 * v * u * b + u * u * d), second = 6 * (v * (b - a) + u * (d - b));
    const Vec2 gap = point(c, u) - q[i];
    const double down = dot(first, first) + dot(gap, second);
    if (down > 0) t[i] = std::clamp(u - dot(gap, first) / down, 0.0, 1.0);
  }
}

bool keeps(const Cubic& c, std::span<const Vec2> q, std::span<const double> t, double tolerance) {
  const double most = tolerance * tolerance;
  Cubic rest = c;
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    if (!(t[i + 1] > t[i])) return false;
    const bool last = i + 2 == q.size();
    Cubic part = rest;
    if (!last) std::tie(part, rest) = cut(rest, (t[i + 1] - t[i]) / (1 - t[i]));
    if (norm2(part[3] - q[i + 1]) > most) return false;
    for (const Vec2 p : part)
      if (distance2_to_segment(p, q[i], q[i + 1]) > most) return false;
  }
  return true;
}

/// May a line separate the two hulls? Candidates: across each pair of a hull's points, and along the chords.
bool separated(const Cubic& a, const Cubic& b) {
  double size = 0;
  for (const Vec2 p : a) size = std::max({size, std::abs(p.x), std::abs(p.y)});
  for (const Vec2 p : b) size = std::max({size, std::abs(p.x), std::abs(p.y)});
  const auto along = [&](Vec2 d) {
    double a0 = dot(a[0], d), a1 = a0, b0 = dot(b[0], d), b1 = b0;
    for (std::size_t i = 1; i < 4; ++i) {
      const double x = dot(a[i], d), y = dot(b[i], d);
      a0 = std::min(a0, x);
      a1 = std::max(a1, x);
      b0 = std::min(b0, y);
      b1 = std::max(b1, y);
    }
    const double margin = 8e-16 * size * (std::abs(d.x) + std::abs(d.y));
    return a1 + margin < b0 || b1 + margin < a0;
  };
  if (along({1, 0}) || along({0, 1}) || along(a[3] - a[0]) || along(b[3] - b[0])) return true;
  for (const Cubic* c : {&a, &b})
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) {
        const Vec2 d = (*c)[j] - (*c)[i];
        if (along({-d.y, d.x})) return true;
      }
  return false;
}

Vec2 unit(Vec2 d) {
  const double length = norm(d);
  return length > 0 ? d / length : d;
}

/// A direction in which a arrives at the joint and b leaves it, all along both: they share the joint alone.
bool pass_on(const Cubic& a, const Cubic& b) {
  const Vec2 d = unit(a[3] - a[2]) + unit(b[1] - b[0]);
  return advances(a, d) && advances(b, d);
}

constexpr int kDeepest = 30;
constexpr int kMostTests = 4000;  // two curves that run side by side closer than any hull: give up

bool apart(const Cubic& a, const Cubic& b, bool ab, bool ba, int depth, int& tests) {
  if (++tests > kMostTests) return false;
  if (!ab && !ba && separated(a, b)) return true;
  if (ab && !ba && pass_on(a, b)) return true;
  if (ba && !ab && pass_on(b, a)) return true;
  if (depth == kDeepest) return false;
  const auto [a0, a1] = cut(a, 0.5);
  const auto [b0, b1] = cut(b, 0.5);
  return apart(a0, b0, false, false, depth + 1, tests) && apart(a0, b1, false, ba, depth + 1, tests) &&
         apart(a1, b0, ab, false, depth + 1, tests) && apart(a1, b1, false, false, depth + 1, tests);
}

}  // namespace

Cubic straight_cubic(Vec2 from, Vec2 to) {
  return {from, from + (to - from) / 3, to - (to - from) / 3, to};
}

bool fit_cubic(std::span<const Vec2> points, Vec2 start, Vec2 end, const CubicFit& options, Cubic& out) {
  const std::size_t n = points.size();
  std::vector<double> t(n, 0);
  for (std::size_t i = 1; i < n; ++i) t[i] = t[i - 1] + norm(points[i] - points[i - 1]);
  if (!(t.back() > 0)) return false;
  for (double& u : t) u /= t.back();
  t.back() = 1;
  const auto rounded = [&](Vec2 p) {
    const double s = options.per_unit;
    return s > 0 ? Vec2{std::round(p.x * s) / s, std::round(p.y * s) / s} : p;
  };
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    out = best(points, t, start, end);
    out[1] = rounded(out[1]);
    out[2] = rounded(out[2]);
    if (!advances(out, out[3] - out[0])) return false;
    reparametrize(out, points, t);
    if (keeps(out, points, t, options.tolerance)) return true;
  }
  return false;
}

bool apart(const Cubic& a, const Cubic& b, bool ab, bool ba) {
  int tests = 0;
  return apart(a, b, ab, ba, 0, tests);
}

}  // namespace retalho
