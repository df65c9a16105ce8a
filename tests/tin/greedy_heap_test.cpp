// The plain greedy refinement: Delaunay, within tolerance at every valid cell, whatever the voids.
#include "retalho/tin/greedy_heap.h"
#include "retalho/tin/greedy_tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace retalho {
namespace {

Raster random_grid(std::mt19937& rng) {
  const auto pick = [&](int a, int b) { return std::uniform_int_distribution<int>(a, b)(rng); };
  Raster r;
  r.columns = pick(2, 40);
  r.rows = pick(2, 40);
  const int kind = pick(0, 3), voids = pick(0, 1) * pick(0, 70);
  std::vector<float> z(r.cells());
  for (int y = 0; y < r.rows; ++y)
    for (int x = 0; x < r.columns; ++x) {
      float& h = z[r.index(x, y)];
      h = kind == 0   ? static_cast<float>(pick(0, 50))
          : kind == 1 ? static_cast<float>(x > r.columns / 2 ? 40 : 0)
          : kind == 2 ? static_cast<float>(20 * std::sin(x * 0.2) * std::cos(y * 0.15))
                      : 5.0F;
      if (pick(0, 99) < voids) h = std::numeric_limits<float>::quiet_NaN();
    }
  r.heights = std::move(z);
  return r;
}

std::int64_t col(std::uint32_t cell) {
  return cell & 0xffffU;
}
std::int64_t north(std::uint32_t cell) {
  return -static_cast<std::int64_t>(cell >> 16);
}
std::int64_t area2(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return (col(b) - col(a)) * (north(c) - north(a)) - (north(b) - north(a)) * (col(c) - col(a));
}

/// Is d strictly inside the circle of the counter-clockwise a, b, c?
bool in_circle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  const auto lift = [&](std::uint32_t p) {
    return (col(p) - col(d)) * (col(p) - col(d)) + (north(p) - north(d)) * (north(p) - north(d));
  };
  const auto minor = [&](std::uint32_t p, std::uint32_t q) {
    return (col(p) - col(d)) * (north(q) - north(d)) - (north(p) - north(d)) * (col(q) - col(d));
  };
  return lift(a) * minor(b, c) + lift(b) * minor(c, a) + lift(c) * minor(a, b) > 0;
}

void check(const Raster& r, const GridTin& tin, double tolerance) {
  std::vector<char> covered(r.cells(), 0);
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t];
    const std::uint32_t a = tin.cells[v[0]], b = tin.cells[v[1]], c = tin.cells[v[2]];
    const std::int64_t area = area2(a, b, c);
    ASSERT_GT(area, 0);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t u = tin.neighbors[t][k];
      if (u == kNone) continue;
      std::size_t m = 0;
      while (m < 3 && tin.neighbors[u][m] != t) ++m;
      ASSERT_LT(m, 3U);
      ASSERT_EQ(tin.triangles[u][(m + 1) % 3], v[(k + 2) % 3]);
      ASSERT_FALSE(in_circle(a, b, c, tin.cells[tin.triangles[u][m]]));
    }
    const double za = r.at(static_cast<int>(col(a)), static_cast<int>(-north(a))),
                 zb = r.at(static_cast<int>(col(b)), static_cast<int>(-north(b))),
                 zc = r.at(static_cast<int>(col(c)), static_cast<int>(-north(c)));
    ASSERT_FALSE(std::isnan(za + zb + zc));
    for (int y = 0; y < r.rows; ++y)
      for (int x = 0; x < r.columns; ++x) {
        const auto p = static_cast<std::uint32_t>(y << 16 | x);
        const std::int64_t wa = area2(p, b, c), wb = area2(a, p, c), wc = area2(a, b, p);
        if (wa < 0 || wb < 0 || wc < 0) continue;
        covered[r.index(x, y)] = 1;
        if (!r.valid(x, y)) continue;
        const double plane = static_cast<double>(wa) * za + static_cast<double>(wb) * zb + static_cast<double>(wc) * zc;
        ASSERT_LE(std::abs(r.at(x, y) * static_cast<double>(area) - plane),
                  (tolerance + 1e-9) * static_cast<double>(area))
            << x << ' ' << y;
      }
  }
  for (std::size_t i = 0; i < r.cells(); ++i) ASSERT_TRUE(covered[i] || std::isnan(r.at(i))) << i;
}

/// 300 random grids through one of the two refinements.
void check_random_grids(GridTin (*refine)(const Raster&, const RefineOptions&, const Context&), unsigned seed) {
  std::mt19937 rng(seed);
  int refined = 0;
  for (int round = 0; round < 300; ++round) {
    const Raster r = random_grid(rng);
    const double tolerance = std::uniform_int_distribution<int>(0, 8)(rng);
    GridTin tin;
    try {
      tin = refine(r, {.max_error = tolerance}, {});
    } catch (const BadInput&) {
      continue;
    }
    check(r, tin, tolerance);
    if (testing::Test::HasFatalFailure()) FAIL() << "seed " << seed << ", round " << round;
    refined += tin.cells.size() > 4 ? 1 : 0;
  }
  EXPECT_GT(refined, 150);
}

TEST(GreedyHeap, IsDelaunayAndWithinToleranceAtEveryValidCell) {
  check_random_grids(refine_grid_by_heap, 42);
}

TEST(GreedyTiles, IsDelaunayAndWithinToleranceAtEveryValidCell) {
  check_random_grids(refine_grid_in_tiles, 43);
}

TEST(GreedyHeap, KeepsToABudget) {
  std::mt19937 rng(1);
  for (int round = 0; round < 40; ++round) {
    const Raster r = random_grid(rng);
    if (r.cells() < 400) continue;
    try {
      const GridTin tin = refine_grid_by_heap(r, {.vertices = 20});
      EXPECT_LE(tin.cells.size(), 20U + 12U);  // a hull of voids may have more corners than the budget
    } catch (const BadInput&) {
    }
  }
}

TEST(GreedyHeap, SaysWhenThereIsNoArea) {
  Raster r;
  r.columns = 5;
  r.rows = 1;
  r.heights = std::vector<float>(5, 1.0F);
  EXPECT_THROW(refine_grid_by_heap(r), BadInput);
  r.heights = std::vector<float>(5, std::numeric_limits<float>::quiet_NaN());
  EXPECT_THROW(refine_grid_by_heap(r), BadInput);
}

}  // namespace
}  // namespace retalho
