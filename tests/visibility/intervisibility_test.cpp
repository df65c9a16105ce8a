// The intervisibility map against exact counts, and the properties that it must have.
#include "retalho/visibility/intervisibility.h"
#include "support/grids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace retalho {
namespace {

Raster hills(int columns, int rows) {
  return test::make_grid(columns, rows, [](int x, int y) {
    return 25 * std::sin(x * 0.09 + 0.02 * y) * std::cos(y * 0.07) + 4 * std::sin(x * 0.5) * std::sin(y * 0.41);
  });
}

struct Difference {
  double rmse = 0, maximum = 0, mean = 0;  // in % of the grid's cells
};
Difference compare(const Raster& r, const std::vector<float>& map, const std::vector<float>& exact) {
  Difference d;
  std::size_t n = 0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (std::isnan(exact[i])) continue;
    const double e =
        100 * (static_cast<double>(map[i]) - static_cast<double>(exact[i])) / static_cast<double>(r.cells());
    d.rmse += e * e;
    d.maximum = std::max(d.maximum, std::abs(e));
    d.mean += static_cast<double>(exact[i]) * 100 / static_cast<double>(r.cells());
    ++n;
  }
  d.rmse = std::sqrt(d.rmse / static_cast<double>(n));
  d.mean /= static_cast<double>(n);
  return d;
}

TEST(Intervisibility, IsWithinItsStatedErrorOfExactCounts) {
  const Raster r = hills(260, 220);
  const auto map = intervisibility_map(r), exact = exact_intervisibility(r, 9);
  const Difference d = compare(r, map, exact);
  EXPECT_GT(d.mean, 2);  // not degenerate
  EXPECT_LT(d.mean, 80);
  EXPECT_LT(d.rmse, 0.12) << "maximum " << d.maximum;
  EXPECT_LT(d.maximum, 0.6);
}

TEST(Intervisibility, FlatTerrainSeesAll) {
  const Raster r = test::make_grid(120, 90, [](int, int) { return 3; });
  for (const float v : intervisibility_map(r, {.directions = 360}))
    EXPECT_NEAR(static_cast<double>(v), 120 * 90, 0.02 * 120 * 90);
}

TEST(Intervisibility, TurnsAndMirrorsWithTheGrid) {
  const Raster r = hills(70, 50);
  const Raster mirrored = test::make_grid(70, 50, [&](int x, int y) { return r.at(69 - x, y); });
  const Raster turned = test::make_grid(50, 70, [&](int x, int y) { return r.at(y, x); });
  const auto a = intervisibility_map(r), b = intervisibility_map(mirrored), c = intervisibility_map(turned);
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 70; ++x) {
      EXPECT_NEAR(a[r.index(x, y)], b[r.index(69 - x, y)], 2);
      EXPECT_NEAR(a[r.index(x, y)], c[turned.index(y, x)], 2);
    }
}

TEST(Intervisibility, SameBytesFromAnyNumberOfThreadsAndAnyLanes) {
  const Raster r = hills(150, 130);
  Context one, many;
  one.threads = 1;
  many.threads = 5;
  EXPECT_EQ(intervisibility_map(r, {.directions = 36}, one), intervisibility_map(r, {.directions = 36}, many));
}

TEST(Intervisibility, RadiusAndHeightsAreMonotone) {
  const Raster r = hills(90, 90);
  const auto near = intervisibility_map(r, {.directions = 60, .radius = 20}),
             all = intervisibility_map(r, {.directions = 60});
  const auto high = intervisibility_map(r, {.directions = 60, .target_height = 5});
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_LE(near[i], all[i] + 1e-3F);
    EXPECT_LE(all[i], high[i] + 1e-3F);
  }
}

TEST(Intervisibility, VoidsAreNotSeenAndSeeNothing) {
  Raster r = test::make_grid(60, 60, [](int x, int y) {
    return x > 20 && x < 40 && y > 20 && y < 40 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  });
  const auto map = intervisibility_map(r, {.directions = 360});
  EXPECT_TRUE(std::isnan(map[r.index(30, 30)]));
  EXPECT_NEAR(static_cast<double>(map[r.index(3, 50)]), 3600 - 361, 90);
}

}  // namespace
}  // namespace retalho
