// Which triangle holds a point: exact, with one owner, from wherever the walk starts.
#include "retalho/terrain/locate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/side.h"
#include "retalho/tin/predicates.h"
#include "synthetic.h"

namespace retalho {
namespace {

using namespace test;

TEST(Side, AgreesWithCgalsExactPredicate) {
  std::mt19937_64 random(21);
  std::uniform_real_distribution<double> unit(0, 1);
  int on_line = 0, near_line = 0;
  for (int k = 0; k < 20000; ++k) {
    // Points of a coarse lattice, and points a few units in the last place beside a line.
    const auto coarse = [&] { return 0.1 + std::floor(unit(random) * 8) / 8 * 0.1; };
    const Vec2 a{coarse(), coarse()}, b{coarse(), coarse()};
    Vec2 c{coarse(), coarse()};
    if (k % 2 == 0) {
      const double f = unit(random);
      c = a + f * (b - a);
      for (int n = static_cast<int>(unit(random) * 4); n > 0; --n) c.x = std::nextafter(c.x, 1.0);
      ++near_line;
    }
    const int expected = orientation_exact(a, b, c);
    on_line += expected == 0;
    ASSERT_EQ(side_of(a, b, c), expected);
    ASSERT_EQ(exact_side_of(a, b, c), expected);
  }
  EXPECT_GT(on_line, 1000);
  EXPECT_GT(near_line, 5000);
}

/// The highest-numbered closed triangle that holds `p`, by trying all.
std::uint32_t owner_by_search(const Tin& tin, Vec2 p) {
  for (auto t = static_cast<std::uint32_t>(tin.triangle_count()); t-- > 0;) {
    const auto& v = tin.triangles[t];
    bool holds = true;
    for (std::size_t k = 0; k < 3; ++k)
      holds = holds && orientation_exact(tin.points[v[k]], tin.points[v[(k + 1) % 3]], p) >= 0;
    if (holds) return t;
  }
  return kNone;
}

/// n x n lattice points of step 1, so that many queries lie exactly on edges and vertices.
Tin lattice_tin(int n) {
  std::vector<Vec2> points;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) points.push_back({static_cast<double>(x), static_cast<double>(y)});
  return delaunay(points, [](Vec2 p) { return p.x * p.y; });
}

TEST(Locate, APointOnAnEdgeBelongsToItsHighestTriangleFromAnyHint) {
  const Tin tin = lattice_tin(6);
  const PointLocator locator(tin);
  std::mt19937_64 random(22);
  int outside = 0;
  for (int y = -2; y <= 22; ++y)
    for (int x = -2; x <= 22; ++x) {
      const Vec2 p{x / 4.0, y / 4.0};
      const std::uint32_t expected = owner_by_search(tin, p);
      outside += expected == kNone;
      EXPECT_EQ(locator.locate(p), expected);
      for (int k = 0; k < 4; ++k)
        EXPECT_EQ(locator.locate(p, static_cast<std::uint32_t>(random() % tin.triangle_count())), expected);
    }
  EXPECT_EQ(outside, 25 * 25 - 21 * 21);
  EXPECT_EQ(locator.locate({std::nan(""), 0}), kNone);
}

TEST(Locate, AnOutlineThatIsNotConvexLosesNothing) {
  Tin tin = delaunay(random_points(300, 23), franke);
  Tin holed = tin;
  holed.triangles.clear();
  for (std::size_t t = 0; t < tin.triangle_count(); ++t)
    if (t % 5 != 0) holed.triangles.push_back(tin.triangles[t]);
  build_neighbors(holed);
  const PointLocator locator(holed);
  std::mt19937_64 random(24);
  std::uniform_real_distribution<double> unit(0, 1);
  int lost = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vec2 p{unit(random), unit(random)};
    const std::uint32_t expected = owner_by_search(holed, p);
    lost += expected == kNone;
    EXPECT_EQ(locator.locate(p), expected);
  }
  EXPECT_GT(lost, 50);
  EXPECT_LT(lost, 500);
}

TEST(GridValues, ARasterThroughTheVerticesIsExactAndTheSameFromAnyNumberOfThreads) {
  for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
    const Terrain terrain =
        make_terrain(lattice_tin(12), Georef{}, {.surface = kind, .gradients = GradientKind::normals});
    const TerrainEvaluator evaluator(terrain);
    const int n = 12 * 8 + 1;
    std::vector<double> one(static_cast<std::size_t>(n * n)), three(one.size());
    evaluator.grid_values({-0.5, 11.5}, {0.125, 0.125}, n, n, one, {}, {.threads = 1});
    evaluator.grid_values({-0.5, 11.5}, {0.125, 0.125}, n, n, three, {}, {.threads = 3});
    std::size_t vertices = 0;
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c) {
        const Vec2 p{-0.5 + c * 0.125, 11.5 - r * 0.125};
        const double z = one[static_cast<std::size_t>(r * n + c)], again = three[static_cast<std::size_t>(r * n + c)];
        ASSERT_EQ(std::isnan(z), owner_by_search(terrain.tin, p) == kNone);
        ASSERT_EQ(std::isnan(z), std::isnan(again));
        if (std::isnan(z)) continue;
        ASSERT_EQ(z, again);
        EXPECT_NEAR(z, evaluator.value(p), 1e-11);
        if (p.x == std::floor(p.x) && p.y == std::floor(p.y)) {
          EXPECT_NEAR(z, p.x * p.y, 1e-11);
          ++vertices;
        }
      }
    EXPECT_EQ(vertices, 144U);
  }
}

TEST(GridValues, AVoidCellReachesHalfWayToItsNeighbours) {
  Terrain terrain = make_terrain(lattice_tin(5), Georef{}, {.surface = SurfaceKind::linear});
  for (Vec2& p : terrain.tin.points) p.y -= 4;  // rows 0..4 from the north, as a grid's
  terrain.grid.columns = terrain.grid.rows = 5;
  terrain.grid.valid = Mask(5, 5, true);
  terrain.grid.valid.set(2, 1, false);
  const TerrainEvaluator evaluator(terrain);
  EXPECT_TRUE(std::isnan(evaluator.value({2, -1})));
  EXPECT_TRUE(std::isnan(evaluator.value({1.5, -1})));   // half way: belongs to the eastern cell, the void one
  EXPECT_FALSE(std::isnan(evaluator.value({2.5, -1})));  // half way: belongs to the eastern cell, which is valid
  EXPECT_TRUE(std::isnan(evaluator.value({2, -0.5})));   // half way: the southern one
  EXPECT_FALSE(std::isnan(evaluator.value({2, -1.5})));
  EXPECT_FALSE(evaluator.valid({2, -1}));
  EXPECT_FALSE(evaluator.jet({2, -1}).has_value());
  std::vector<double> z(25);
  evaluator.grid_values({0, 0}, {1, 1}, 5, 5, z);
  for (std::size_t k = 0; k < 25; ++k) EXPECT_EQ(std::isnan(z[k]), k == 7) << k;
}

}  // namespace
}  // namespace retalho
