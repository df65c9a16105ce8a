// What the tests of contour lines share: random grids, a crossing counter, the brute-force count of components.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "retalho/level/contours.h"
#include "retalho/raster/raster.h"
#include "support/support.h"

namespace retalho::test {

inline Raster contour_raster(int columns, int rows, const std::function<double(int, int)>& height, double width = 1,
                             double cell_height = 1) {
  Raster raster;
  raster.columns = columns;
  raster.rows = rows;
  raster.cell_width = width;
  raster.cell_height = cell_height;
  std::vector<double> z(raster.cells());
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) z[raster.index(c, r)] = height(c, r);
  raster.heights = std::move(z);
  return raster;
}

/// The area of a convex polygon in a box (Sutherland and Hodgman).
inline double clipped_area(std::vector<Vec2> ring, Vec2 low, Vec2 high) {
  const auto cut = [&](const std::function<double(Vec2)>& inside) {
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2 a = ring[i], b = ring[(i + 1) % ring.size()];
      const double u = inside(a), v = inside(b);
      if (u >= 0) kept.push_back(a);
      if ((u >= 0) != (v >= 0)) kept.push_back(a + (u / (u - v)) * (b - a));
    }
    ring = std::move(kept);
  };
  cut([&](Vec2 p) { return p.x - low.x; });
  cut([&](Vec2 p) { return high.x - p.x; });
  cut([&](Vec2 p) { return p.y - low.y; });
  cut([&](Vec2 p) { return high.y - p.y; });
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) sum += cross(ring[i], ring[(i + 1) % ring.size()]) / 2;
  return std::abs(sum);
}

struct Segment {
  Vec2 a, b;
  int level;
  std::size_t line, place, of;
};

inline std::vector<Segment> segments(const ContourSet& set) {
  std::vector<Segment> out;
  for (std::size_t l = 0; l < set.lines.size(); ++l) {
    const ContourLine& line = set.lines[l];
    const std::size_t n = line.end - line.begin, count = line.closed ? n : n - 1;
    for (std::size_t i = 0; i < count; ++i)
      out.push_back({set.points[line.begin + i], set.points[line.begin + (i + 1) % n], line.level, l, i, count});
  }
  return out;
}

/// Pairs of segments that meet, apart from neighbours in their common point. Exact up to long double's rounding.
inline std::size_t count_meetings(const ContourSet& set, double bin) {
  const std::vector<Segment> all = segments(set);
  if (all.empty()) return 0;
  Vec2 low = all[0].a, high = low;
  for (const Segment& s : all) {
    low = {std::min({low.x, s.a.x, s.b.x}), std::min({low.y, s.a.y, s.b.y})};
    high = {std::max({high.x, s.a.x, s.b.x}), std::max({high.y, s.a.y, s.b.y})};
  }
  const auto nx = static_cast<std::size_t>((high.x - low.x) / bin) + 1,
             ny = static_cast<std::size_t>((high.y - low.y) / bin) + 1;
  std::vector<std::vector<std::uint32_t>> bins(nx * ny);
  const auto range = [&](double a, double b, double o) {
    return std::pair{static_cast<std::size_t>((std::min(a, b) - o) / bin),
                     static_cast<std::size_t>((std::max(a, b) - o) / bin)};
  };
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    const auto [x0, x1] = range(all[i].a.x, all[i].b.x, low.x);
    const auto [y0, y1] = range(all[i].a.y, all[i].b.y, low.y);
    for (std::size_t y = y0; y <= y1; ++y)
      for (std::size_t x = x0; x <= x1; ++x) bins[y * nx + x].push_back(i);
  }
  const auto side = [](Vec2 a, Vec2 b, Vec2 p) {
    const long double ux = static_cast<long double>(b.x) - a.x, uy = static_cast<long double>(b.y) - a.y;
    const long double vx = static_cast<long double>(p.x) - a.x, vy = static_cast<long double>(p.y) - a.y;
    const long double d = ux * vy - uy * vx;
    return d > 0 ? 1 : d < 0 ? -1 : 0;
  };
  const auto within = [](Vec2 a, Vec2 b, Vec2 p) {
    return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
           p.y <= std::max(a.y, b.y);
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> met;
  for (const auto& bucket : bins)
    for (std::size_t i = 0; i < bucket.size(); ++i)
      for (std::size_t j = i + 1; j < bucket.size(); ++j) {
        const Segment &s = all[bucket[i]], &t = all[bucket[j]];
        if (std::max(s.a.x, s.b.x) < std::min(t.a.x, t.b.x) || std::max(t.a.x, t.b.x) < std::min(s.a.x, s.b.x) ||
            std::max(s.a.y, s.b.y) < std::min(t.a.y, t.b.y) || std::max(t.a.y, t.b.y) < std::min(s.a.y, s.b.y))
          continue;
        const int p = side(s.a, s.b, t.a), q = side(s.a, s.b, t.b), u = side(t.a, t.b, s.a), v = side(t.a, t.b, s.b);
        const bool neighbours = s.line == t.line && (s.b == t.a || t.b == s.a);
        bool meet = false;
        if (neighbours) {
          // They share one end; more than that only when the other ends fold back onto one another.
          const bool double_edge = s.b == t.a && t.b == s.a && s.of > 2;
          const Vec2 shared = s.b == t.a ? s.b : s.a, one = s.b == t.a ? s.a : s.b, two = s.b == t.a ? t.b : t.a;
          meet = double_edge || (p * q == 0 && u * v == 0 && side(one, shared, two) == 0 &&
                                 (within(one, shared, two) || within(shared, two, one)));
        } else if (p == 0 && q == 0) {
          meet = within(s.a, s.b, t.a) || within(s.a, s.b, t.b) || within(t.a, t.b, s.a);
        } else {
          meet = p * q <= 0 && u * v <= 0;
        }
        if (meet) met.emplace_back(std::min(bucket[i], bucket[j]), std::max(bucket[i], bucket[j]));
      }
  std::sort(met.begin(), met.end());
  met.erase(std::unique(met.begin(), met.end()), met.end());
  return met.size();
}

/// Regions above and below a level on samples (columns x rows), joined along rows, columns and one diagonal.
inline std::size_t count_regions(const std::vector<char>& above, std::size_t columns, std::size_t rows) {
  std::vector<std::uint32_t> parent(above.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto join = [&](std::size_t i, std::size_t j) {
    if (above[i] == above[j]) parent[root(static_cast<std::uint32_t>(i))] = root(static_cast<std::uint32_t>(j));
  };
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t i = r * columns + c;
      if (c + 1 < columns) join(i, i + 1);
      if (r + 1 < rows) join(i, i + columns);
      if (c + 1 < columns && r + 1 < rows) join(i, i + columns + 1);
    }
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < parent.size(); ++i) count += root(i) == i;
  return count;
}

}  // namespace retalho::test
