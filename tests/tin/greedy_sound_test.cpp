// What every result of the grid refinement is, whatever the grid: Delaunay, linked both ways, over the whole hull of
// the valid cells and nothing else, within the tolerance. All decided here by other means than the refinement's own: in
// integers, cell by cell. Small grids at random, and grids large enough for levels and tiles.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "retalho/core/error.h"
#include "retalho/tin/greedy_heap.h"
#include "retalho/tin/greedy_tiles.h"
#include "support/grids.h"
#include "support/support.h"

namespace retalho {
namespace {

constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();
using Wide = __int128;

struct Place {
  std::int64_t x, y;
};
Place place(std::uint32_t cell) {
  return {cell & 0xffffU, -static_cast<std::int64_t>(cell >> 16)};  // north up
}
std::int64_t turn(Place a, Place b, Place c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
bool inside_circle(Place a, Place b, Place c, Place d) {
  const auto lift = [&](Place p) { return (p.x - d.x) * (p.x - d.x) + (p.y - d.y) * (p.y - d.y); };
  return Wide(lift(a)) * turn(d, b, c) + Wide(lift(b)) * turn(d, c, a) + Wide(lift(c)) * turn(d, a, b) > 0;
}

/// Twice the area of the valid cells' convex hull (all valid cells, one chain).
std::int64_t hull_area2(const Raster& r) {
  std::vector<Place> points;
  for (int x = 0; x < r.columns; ++x)
    for (int y = r.rows - 1; y >= 0; --y)
      if (r.valid(x, y)) points.push_back({x, -y});
  std::vector<Place> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = hull.size();
    for (const Place& p : points) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  std::int64_t area = 0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) area += turn(hull[0], hull[i], hull[i + 1]);
  return area;
}

/// The first thing that is wrong with `tin`, or nothing.
std::string fault(const Raster& r, const GridTin& tin, double tolerance) {
  if (!std::is_sorted(tin.cells.begin(), tin.cells.end())) return "vertices are not in raster order";
  std::vector<char> named(tin.cells.size(), 0), covered(r.cells(), 0);
  std::int64_t area = 0;
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    Place p[3];
    long double z[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = tin.triangles[t][k];
      named[v] = 1;
      p[k] = place(tin.cells[v]);
      z[k] = r.at(static_cast<int>(p[k].x), static_cast<int>(-p[k].y));
      if (std::isnan(z[k])) return "a void vertex";
    }
    const std::int64_t twice = turn(p[0], p[1], p[2]);
    if (twice <= 0) return "a triangle turned round or flat";
    area += twice;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t u = tin.neighbors[t][k];
      if (u == kNone) continue;
      std::size_t m = 0;
      while (m < 3 && tin.neighbors[u][m] != t) ++m;
      if (m == 3 || tin.triangles[u][(m + 1) % 3] != tin.triangles[t][(k + 2) % 3] ||
          tin.triangles[u][(m + 2) % 3] != tin.triangles[t][(k + 1) % 3])
        return "a link that is not answered";
      if (inside_circle(p[0], p[1], p[2], place(tin.cells[tin.triangles[u][m]]))) return "an edge is not Delaunay";
    }
    for (std::int64_t y = std::min({p[0].y, p[1].y, p[2].y}); y <= std::max({p[0].y, p[1].y, p[2].y}); ++y)
      for (std::int64_t x = std::min({p[0].x, p[1].x, p[2].x}); x <= std::max({p[0].x, p[1].x, p[2].x}); ++x) {
        const std::int64_t w[3] = {turn({x, y}, p[1], p[2]), turn({x, y}, p[2], p[0]), turn({x, y}, p[0], p[1])};
        if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
        const std::size_t cell = r.index(static_cast<int>(x), static_cast<int>(-y));
        covered[cell] = 1;
        if (std::isnan(r.at(cell))) continue;
        const long double plane = static_cast<long double>(w[0]) * z[0] + static_cast<long double>(w[1]) * z[1] +
                                  static_cast<long double>(w[2]) * z[2];
        if (std::abs(plane / static_cast<long double>(twice) - static_cast<long double>(r.at(cell))) >
            static_cast<long double>(tolerance) * (1 + 1e-18L))
          return "a cell over the tolerance";
      }
  }
  for (std::size_t i = 0; i < r.cells(); ++i)
    if (covered[i] == 0 && !std::isnan(r.at(i))) return "a valid cell that no triangle covers";
  if (std::count(named.begin(), named.end(), 0) > 0) return "a vertex of no triangle";
  if (area != hull_area2(r)) return "not the hull's area";
  return {};
}

/// Noise, steps, waves, planes, with voids or without, in float or double.
Raster any_grid(test::Random& random, int columns, int rows) {
  const std::size_t kind = random.index(5);
  const double voids = random.chance(0.5) ? random.uniform(0, 0.7) : 0;
  const auto height = [&](int x, int y) {
    const double z = kind == 0   ? static_cast<double>(random.index(50))
                     : kind == 1 ? (2 * x > columns ? 40.3 : 0)
                     : kind == 2 ? 20 * std::sin(0.2 * x) * std::cos(0.15 * y)
                     : kind == 3 ? 5
                                 : 0.1 * x + 0.3 * y * x;
    return random.chance(voids) ? kVoid : z;
  };
  return random.chance(0.5) ? test::make_grid<float>(columns, rows, height)
                            : test::make_grid<double>(columns, rows, height);
}

RC_GTEST_PROP(GreedySound, EveryRandomGridIsTriangulatedRightByBothOrders, ()) {
  test::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const int columns = *rc::gen::inRange(2, 60), rows = *rc::gen::inRange(2, 60);
  const Raster r = any_grid(random, columns, rows);
  const double tolerance = 8 * std::pow(10.0, -*rc::gen::inRange(0, 7));
  GridTin tiles, plain;
  try {
    tiles = refine_grid_in_tiles(r, {.max_error = tolerance});
    plain = refine_grid_by_heap(r, {.max_error = tolerance});
  } catch (const BadInput&) {
    RC_DISCARD("no area");
  }
  RC_CLASSIFY(tiles.cells.size() > 20, "more than 20 vertices");
  RC_ASSERT(fault(r, tiles, tolerance) == "");
  RC_ASSERT(fault(r, plain, tolerance) == "");
}

/// Vertices in one row, as columns.
std::vector<std::uint32_t> in_row(const GridTin& tin, int row) {
  std::vector<std::uint32_t> columns;
  for (const std::uint32_t c : tin.cells)
    if (static_cast<int>(c >> 16) == row) columns.push_back(c & 0xffffU);
  return columns;
}

RC_GTEST_PROP(GreedySound, GridsThatShareARowAgreeAlongItVoidsOrNot, ()) {
  test::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const int columns = *rc::gen::inRange(2, 60), above = *rc::gen::inRange(2, 40), below = *rc::gen::inRange(2, 40);
  const Raster north = any_grid(random, columns, above);
  const Raster other = any_grid(random, columns, below);
  // The lower grid has heights of its own; its first row is the upper one's last.
  const Raster south = test::make_grid<double>(
      columns, below, [&](int x, int y) { return y == 0 ? north.at(x, above - 1) : other.at(x, y); });
  const double tolerance = 8 * std::pow(10.0, -*rc::gen::inRange(0, 5));
  GridTin a, b;
  try {
    a = refine_grid(north, {.max_error = tolerance});
    b = refine_grid(south, {.max_error = tolerance});
  } catch (const BadInput&) {
    RC_DISCARD("no area");
  }
  RC_CLASSIFY(in_row(b, 0).size() > 4, "more than 4 vertices on the row");
  RC_ASSERT(in_row(a, above - 1) == in_row(b, 0));
}

TEST(GreedySound, LevelsAndTilesKeepDelaunayLinksAndHull) {
  test::Random random;
  std::size_t round = 0;
  for (const double voids : {0.0, 0.3, 0.7}) {
    for (const double tolerance : {40.0, 8.0, 1.5}) {
      // Over a million cells: rounds instead of the exact start.
      const Raster r = test::make_grid<float>(1250, 850, [&](int x, int y) {
        const double z = 200 * std::sin(x * 0.011) * std::cos(y * 0.013) + 12 * std::sin(x * 0.2 + y * 0.17);
        return random.chance(voids) || (round % 2 == 1 && x + 2 * y < 700) ? kVoid : z;
      });
      const GridTin tin = refine_grid_in_tiles(r, {.max_error = tolerance});
      EXPECT_GT(tin.cells.size(), 100U);
      EXPECT_EQ(fault(r, tin, tolerance), "") << voids << ' ' << tolerance;
      ++round;
    }
  }
}

TEST(GreedySound, RoughSidesAroundAFlatMiddleOpenLargeCavities) {
  // All cells of the sides are vertices before the middle is looked at: the first cavity there takes a good part of
  // the triangles along the sides.
  test::Random random;
  const Raster r = test::make_grid<float>(900, 800, [&](int x, int y) {
    const bool side = x == 0 || y == 0 || x == 899 || y == 799;
    return side ? static_cast<double>(random.index(1000)) : x == 450 && y == 400 ? 5000.0 : 0.0;
  });
  const GridTin tin = refine_grid(r, {.max_error = 1});
  EXPECT_GT(tin.cells.size(), 3000U);
  EXPECT_EQ(fault(r, tin, 1), "");
}

TEST(GreedySound, SaysWhichOptionsAndHeightsItRefuses) {
  const Raster r = test::make_grid<float>(9, 7, [](int x, int y) { return x * y % 5; });
  EXPECT_THROW(refine_grid(r, {.max_error = -1}), UsageError);
  EXPECT_THROW(refine_grid(r, {.max_error = kVoid}), UsageError);
  const Raster infinite = test::make_grid<float>(
      9, 7, [](int x, int y) { return x == 4 && y == 3 ? std::numeric_limits<double>::infinity() : 0.0; });
  EXPECT_THROW(refine_grid(infinite, {.max_error = 1}), BadInput);
  EXPECT_THROW(refine_grid(test::make_grid<float>(1, 1, [](int, int) { return 1; })), BadInput);
  EXPECT_THROW(refine_grid(test::make_grid<float>(1, 9, [](int, int) { return 1; })), BadInput);
  EXPECT_THROW(refine_grid(test::make_grid<float>(9, 9, [](int x, int y) { return x == y ? 1 : kVoid; })), BadInput);
  EXPECT_THROW(refine_grid(test::make_grid<float>(9, 9, [](int, int) { return kVoid; })), BadInput);
}

}  // namespace
}  // namespace retalho
