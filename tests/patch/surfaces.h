// The sheet's surfaces with natural parameters, and regular and irregular patches of them.
#pragma once

#include <cmath>
#include <complex>
#include <functional>
#include <random>

#include "retalho/patch/patch.h"
#include "retalho/tin/scattered.h"

namespace retalho::test {

/// X(u, v) with its first derivatives, exactly.
using Surface = std::function<SurfaceJet(Vec2)>;

inline SurfaceJet octant(Vec2 p) {
  const Vec3 q{p.x, p.y, 1 - p.x - p.y}, qu{1, 0, -1}, qv{0, 1, -1};
  const double r = norm(q);
  const auto derivative = [&](Vec3 d) { return d / r - (dot(q, d) / (r * r * r)) * q; };
  return {q / r, derivative(qu), derivative(qv)};
}

inline SurfaceJet sine(Vec2 p) {
  const double u = p.x, v = p.y;
  return {
      {u + 0.1 * std::sin(3 * v), v + 0.1 * std::sin(2 * u), 0.5 * std::sin(3 * u) * std::cos(4 * v) + u * u - v * v},
      {1, 0.2 * std::cos(2 * u), 1.5 * std::cos(3 * u) * std::cos(4 * v) + 2 * u},
      {0.3 * std::cos(3 * v), 1, -2 * std::sin(3 * u) * std::sin(4 * v) - 2 * v}};
}

inline SurfaceJet monkey(Vec2 p) {
  const double u = p.x - 0.3, v = p.y - 0.3;
  return {{u, v, u * u * u - 3 * u * v * v}, {1, 0, 3 * u * u - 3 * v * v}, {0, 1, -6 * u * v}};
}

/// A rational cubic triangle with fixed control points and weights, by its homogeneous polynomials.
inline SurfaceJet rational(Vec2 p) {
  static const auto net = [] {
    struct Point {
      Vec3 b;
      double w = 1;
    };
    std::mt19937_64 random(7);
    std::normal_distribution<double> normal(0, 0.15);
    std::uniform_real_distribution<double> unit(-0.7, 0.7);
    std::array<std::array<Point, 4>, 4> out{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; i + j < 4; ++j) {
        const double x = normal(random), y = normal(random), z = normal(random);
        out[i][j] = {{static_cast<double>(i) / 3 + x, static_cast<double>(j) / 3 + y, z}, std::exp(unit(random))};
      }
    return out;
  }();
  constexpr std::array<double, 4> factorial = {1, 1, 2, 6};
  const double w = 1 - p.x - p.y;
  const auto power = [](double x, std::size_t n) { return n == 0 ? 1.0 : std::pow(x, static_cast<double>(n)); };
  const auto slope = [&](double x, std::size_t n) { return n == 0 ? 0.0 : static_cast<double>(n) * power(x, n - 1); };
  Vec3 sum, su, sv;
  double all = 0, au = 0, av = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; i + j < 4; ++j) {
      const std::size_t k = 3 - i - j;
      const double c = 6 / (factorial[i] * factorial[j] * factorial[k]) * net[i][j].w;
      const double a = power(p.x, i), b = power(p.y, j), d = power(w, k), slope_w = slope(w, k);
      const double f = c * a * b * d, fu = c * (slope(p.x, i) * b * d - a * b * slope_w),
                   fv = c * (a * slope(p.y, j) * d - a * b * slope_w);
      sum = sum + f * net[i][j].b, su = su + fu * net[i][j].b, sv = sv + fv * net[i][j].b;
      all += f, au += fu, av += fv;
    }
  const Vec3 x = sum / all;
  return {x, (su - au * x) / all, (sv - av * x) / all};
}

/// A side of a surface: its second derivative along s by central differences of the exact first one.
inline PatchSides sides_of(const Surface& surface) {
  PatchSides sides;
  for (int side = 0; side < 3; ++side) {
    const auto first = [surface, side](double s) {
      const SurfaceJet jet = surface(side_parameters(side, s));
      const Vec2 d = side_direction(side);
      return SideJet{jet.point, d.x * jet.du + d.y * jet.dv, {}};
    };
    sides[static_cast<std::size_t>(side)] = SideCurve([first](double s) {
      SideJet jet = first(s);
      const double h = 1e-3;
      jet.second = (8 * (first(s + h).first - first(s - h).first) - (first(s + 2 * h).first - first(s - 2 * h).first)) /
                   (12 * h);
      return jet;
    });
  }
  return sides;
}

/// The regular domain, or the Delaunay triangulation of its nodes moved by up to 0.45 / n, sides along themselves.
inline Domain irregular_domain(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-0.45, 0.45);
  const Domain regular = regular_domain(n);
  const auto rounded = [](double x) { return std::ldexp(std::nearbyint(std::ldexp(x, 40)), -40); };
  const double size = static_cast<double>(n);
  std::vector<Vec3> places;
  for (Vec2 p : regular.parameters) {
    const double du = unit(random) / size, dv = unit(random) / size;
    const double w = 1 - p.x - p.y;
    const bool side_v = p.y == 0, side_u = p.x == 0, side_w = p.x + p.y == 1;
    if (side_u + side_v + side_w == 1) {
      if (side_v) p.x += du;
      if (side_u) p.y += dv;
      if (side_w) p = {p.x - dv, p.y + dv};
    } else if (side_u + side_v + side_w == 0 && p.x + du > 0.1 / size && p.y + dv > 0.1 / size &&
               w - du - dv > 0.1 / size) {
      p = {p.x + du, p.y + dv};
    }
    p = {rounded(p.x), rounded(p.y)};
    if (side_w && !side_u && !side_v) p.x = 1 - p.y;
    places.push_back({p.x + p.y / 2, p.y * 0.875, 0});
  }
  const Tin tin = triangulate_points(places);
  Domain domain;
  for (const Vec2& p : tin.points) {
    const double v = p.y / 0.875;
    domain.parameters.push_back({p.x - v / 2, v});
  }
  domain.triangles = tin.triangles;
  for (int side = 0; side < 3; ++side) {
    auto& nodes = domain.sides[static_cast<std::size_t>(side)];
    for (std::uint32_t i = 0; i < domain.parameters.size(); ++i) {
      const Vec2 p = domain.parameters[i];
      if (side == 0 ? p.x + p.y == 1 : side == 1 ? p.x == 0 : p.y == 0) nodes.push_back(i);
    }
    std::sort(nodes.begin(), nodes.end(), [&](std::uint32_t a, std::uint32_t b) {
      return side_argument(side, domain.parameters[a]) < side_argument(side, domain.parameters[b]);
    });
  }
  return domain;
}

/// A patch whose nodes are points of the surface at their parameters.
inline Patch natural_patch(const Surface& surface, Domain domain, Recovery recovery) {
  Patch patch;
  patch.sides = sides_of(surface);
  patch.domain = std::move(domain);
  patch.recovery = recovery;
  for (const Vec2& p : patch.domain.parameters) patch.positions.push_back(surface(p).point);
  return patch;
}

}  // namespace retalho::test
