// Slow, obvious answers about triangulations of scattered points, and hard sets of points.
#pragma once

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "retalho/core/vec.h"
#include "retalho/tin/tin.h"
#include "support/support.h"

namespace retalho::test {

/// Signs from rational arithmetic.
inline int exact_orientation(Vec2 a, Vec2 b, Vec2 c) {
  const mpq_class ax(a.x), ay(a.y), bx(b.x), by(b.y), cx(c.x), cy(c.y);
  return sgn((ax - cx) * (by - cy) - (ay - cy) * (bx - cx));
}
inline int exact_in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const mpq_class dx(d.x), dy(d.y);
  const mpq_class ax = mpq_class(a.x) - dx, ay = mpq_class(a.y) - dy, bx = mpq_class(b.x) - dx,
                  by = mpq_class(b.y) - dy, cx = mpq_class(c.x) - dx, cy = mpq_class(c.y) - dy;
  const mpq_class det = (ax * ax + ay * ay) * (bx * cy - cx * by) + (bx * bx + by * by) * (cx * ay - ax * cy) +
                        (cx * cx + cy * cy) * (ax * by - bx * ay);
  return sgn(det);
}

/// Corners of the convex hull and every point on its sides, counted by walking around it with exact signs.
inline std::size_t border_points(const std::vector<Vec2>& points) {
  std::size_t count = 0;
  for (const Vec2& p : points) {
    // p is on the border when some line through p and another point has everything on one side.
    bool border = false;
    for (const Vec2& q : points) {
      if (q == p) continue;
      border =
          std::all_of(points.begin(), points.end(), [&](const Vec2& r) { return exact_orientation(p, q, r) >= 0; });
      if (border) break;
    }
    count += border ? 1 : 0;
  }
  return count;
}

/// Links symmetric, every triangle counter-clockwise, Euler's count, the hull covered, canonical order.
inline void expect_sound(const Tin& tin) {
  std::size_t border = 0;
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t];
    ASSERT_EQ(exact_orientation(tin.points[v[0]], tin.points[v[1]], tin.points[v[2]]), 1) << "triangle " << t;
    ASSERT_TRUE(v[0] < v[1] && v[0] < v[2]) << "triangle " << t;
    ASSERT_TRUE(t == 0 || tin.triangles[t - 1] < v) << "triangle " << t;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = tin.neighbors[t][k];
      if (other == kNone) {
        ++border;
        continue;
      }
      const auto& w = tin.triangles[other];
      bool found = false;
      for (std::size_t m = 0; m < 3; ++m)
        found = found ||
                (tin.neighbors[other][m] == t && w[(m + 1) % 3] == v[(k + 2) % 3] && w[(m + 2) % 3] == v[(k + 1) % 3]);
      ASSERT_TRUE(found) << "triangles " << t << " and " << other;
    }
  }
  ASSERT_EQ(tin.triangles.size() + border + 2, 2 * tin.points.size());
  std::vector<bool> used(tin.points.size(), false);
  for (const auto& v : tin.triangles)
    for (const std::uint32_t k : v) used[k] = true;
  ASSERT_TRUE(std::all_of(used.begin(), used.end(), [](bool u) { return u; }));
}

/// No point lies inside the circle of an edge's two triangles: locally Delaunay everywhere, hence Delaunay.
inline void expect_delaunay(const Tin& tin) {
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t other = tin.neighbors[t][k];
      if (other == kNone || other < t) continue;
      const auto &v = tin.triangles[t], &w = tin.triangles[other];
      for (const std::uint32_t apex : w) {
        if (apex == v[0] || apex == v[1] || apex == v[2]) continue;
        ASSERT_LE(exact_in_circle(tin.points[v[0]], tin.points[v[1]], tin.points[v[2]], tin.points[apex]), 0)
            << "triangles " << t << " and " << other;
      }
    }
}

/// The same the long way: every point against every circle.
inline void expect_empty_circles(const Tin& tin) {
  for (const auto& v : tin.triangles)
    for (const Vec2& p : tin.points)
      ASSERT_LE(exact_in_circle(tin.points[v[0]], tin.points[v[1]], tin.points[v[2]], p), 0);
}

/// The sorts of point sets that break triangulations.
enum class Sort { uniform, lattice, circle, tracks, clusters, millimetres_far_out, tiny, huge, parabola, kSorts };

inline std::vector<Vec3> hard_points(Sort sort, std::size_t count, Random& random) {
  std::vector<Vec3> points(count);
  for (std::size_t k = 0; k < count; ++k) {
    Vec2 p;
    const double i = static_cast<double>(k);
    switch (sort) {
      case Sort::uniform:
        p = {random.uniform(), random.uniform()};
        break;
      case Sort::lattice: {  // many on one circle, many on one line, some twice
        const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count)) * 0.9));
        p = {static_cast<double>(random.index(side)), static_cast<double>(random.index(side))};
        break;
      }
      case Sort::circle:  // Pythagorean: exactly on one circle
        p = {random.chance(0.5) ? 3.0 : 4.0, 0};
        p.y = p.x == 3.0 ? 4.0 : 3.0;
        if (random.chance(0.3)) p = {0, 5};
        if (random.chance(0.3)) p = {5, 0};
        if (random.chance(0.5)) p.x = -p.x;
        if (random.chance(0.5)) p.y = -p.y;
        if (random.chance(0.2)) p = {random.uniform(-5, 5), random.uniform(-5, 5)};
        break;
      case Sort::tracks:  // long runs on a few lines, as a ship's soundings
        p = {i, static_cast<double>(random.index(3)) * 1000 + (random.chance(0.1) ? random.uniform() : 0)};
        break;
      case Sort::clusters:
        p = {static_cast<double>(random.index(4)) * 1e6 + random.uniform(0, 1e-3),
             static_cast<double>(random.index(4)) * 1e6 + random.uniform(0, 1e-3)};
        break;
      case Sort::millimetres_far_out:
        p = {5e6 + 1e-3 * static_cast<double>(random.index(100)),
             5.7e6 + 1e-3 * static_cast<double>(random.index(100))};
        break;
      case Sort::tiny:
        p = {random.uniform() * 1e-200, static_cast<double>(random.index(7)) * 1e-200};
        break;
      case Sort::huge:
        p = {random.uniform(-1e99, 1e99), static_cast<double>(random.index(7)) * 1e98};
        break;
      default:
        p = {i, i * i};
    }
    points[k] = {p.x, p.y, random.uniform(0, 100)};
  }
  return points;
}

}  // namespace retalho::test
