// The viewshed against its slow, obvious twin (a sight line to every cell), and the properties that must hold.
#include "retalho/visibility/viewshed.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>
#include <random>

#include "retalho/visibility/line_of_sight.h"
#include "support/grids.h"

namespace retalho {
namespace {

constexpr float kVoid = std::numeric_limits<float>::quiet_NaN();

std::vector<std::uint8_t> twin(const Raster& r, const Observer& o, const ViewshedOptions& options) {
  std::vector<std::uint8_t> seen(r.cells(), 0);
  for (int y = 0; y < r.rows; ++y)
    for (int x = 0; x < r.columns; ++x) {
      if (!r.valid(x, y)) continue;
      const double dx = (x - o.column) * r.cell_width, dy = (y - o.row) * r.cell_height;
      if (options.radius > 0 && dx * dx + dy * dy > options.radius * options.radius) continue;
      const SightOptions sight{.target_height = options.target_height,
                               .earth_curvature = options.earth_curvature,
                               .refraction = options.refraction,
                               .voids = options.voids};
      seen[r.index(x, y)] = line_of_sight(r, o, x, y, sight).visible ? 1 : 0;
    }
  return seen;
}

std::size_t differences(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < a.size(); ++i) n += a[i] != b[i] ? 1U : 0U;
  return n;
}

/// Terrain of many kinds: noise, steps, lakes at equal heights, ramps; voids in some.
Raster random_terrain(std::mt19937& rng, bool voids) {
  const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng); };
  const int columns = pick(1, 40), rows = pick(1, 40), kind = pick(0, 4), range = pick(1, 30);
  const int ax = pick(-3, 3), ay = pick(-3, 3);
  const int void_percent = voids ? pick(1, 70) : 0;
  return test::make_grid(columns, rows, [&](int x, int y) -> float {
    if (void_percent > 0 && pick(0, 99) < void_percent) return kVoid;
    switch (kind) {
      case 0:
        return static_cast<float>(pick(0, range));
      case 1:
        return static_cast<float>(ax * x + ay * y);
      case 2:
        return static_cast<float>(pick(0, 9) == 0 ? range : 0);
      case 3:
        return static_cast<float>(std::lround(10 * std::sin(0.3 * x) * std::cos(0.2 * y)));
      default:
        return static_cast<float>(pick(0, 1000000)) * 1e-5F;
    }
  });
}

TEST(Viewshed, EqualsTheSightLineInEveryCell) {
  const unsigned seed = 20261125;
  std::mt19937 rng(seed);
  RecordProperty("seed", static_cast<int>(seed));
  std::size_t cells = 0, seen = 0, checked = 0;
  for (int round = 0; round < 1500; ++round) {
    const Raster r = random_terrain(rng, round % 2 == 1);
    const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng); };
    Observer o{pick(0, r.columns - 1), pick(0, r.rows - 1), pick(0, 3) * 0.5};
    if (round % 5 == 0) o.column = round % 10 == 0 ? 0 : r.columns - 1;  // observers on the border
    if (!r.valid(o.column, o.row)) continue;
    ViewshedOptions options;
    options.target_height = pick(0, 2) * 0.75;
    options.voids = round % 4 == 1 ? VoidRule::blocks : VoidRule::transparent;
    if (round % 7 == 0) options.radius = pick(1, 20);
    if (round % 11 == 0) options.earth_curvature = true;
    const auto fast = viewshed(r, o, options), slow = twin(r, o, options);
    ASSERT_EQ(differences(fast, slow), 0U)
        << "round " << round << " of seed " << seed << ": " << r.columns << " x " << r.rows;
    for (const auto v : fast) seen += v;
    cells += r.cells();
    ++checked;
  }
  EXPECT_GT(checked, 1000U);
  EXPECT_GT(seen, cells / 20);       // not degenerate: a fair share is seen
  EXPECT_LT(seen, cells * 19 / 20);  // and a fair share is not
}

TEST(Viewshed, FlatTerrainSeesAll) {
  for (const double eye : {0.0, 1.7}) {
    const Raster r = test::make_grid(300, 200, [](int, int) { return 7; });
    const auto seen = viewshed(r, {17, 120, eye});
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 300 * 200) << eye;
  }
}

TEST(Viewshed, AWallHidesWhatIsBehindIt) {
  const Raster r = test::make_grid(21, 21, [](int x, int) { return x == 14 ? 5 : 0; });
  const auto seen = viewshed(r, {10, 10, 1});
  EXPECT_TRUE(seen[r.index(13, 10)]);
  EXPECT_TRUE(seen[r.index(14, 3)]);
  EXPECT_FALSE(seen[r.index(15, 10)]);
  EXPECT_FALSE(seen[r.index(20, 20)]);
  const auto needed = needed_heights(r, std::vector<Observer>{{10, 10, 1}});
  // The line from (10, 1) over (14, 5) reaches 1 + 4 * 8 / 4 = 9 at column 18.
  EXPECT_NEAR(static_cast<double>(needed[r.index(18, 10)]), 9, 1e-6);
  EXPECT_EQ(needed[r.index(12, 10)], 0);
}

TEST(Viewshed, SeesAsItIsSeenAtEqualHeights) {
  std::mt19937 rng(7);
  std::size_t pairs = 0;
  for (int round = 0; round < 60; ++round) {
    const Raster r = test::make_grid(20, 17, [&](int, int) { return std::uniform_int_distribution<int>(0, 12)(rng); });
    const auto pick = [&](int high) { return std::uniform_int_distribution<int>(0, high)(rng); };
    const int c0 = pick(19), r0 = pick(16), c1 = pick(19), r1 = pick(16);
    const ViewshedOptions options{.target_height = 1.5};
    const auto a = viewshed(r, {c0, r0, 1.5}, options), b = viewshed(r, {c1, r1, 1.5}, options);
    EXPECT_EQ(a[r.index(c1, r1)], b[r.index(c0, r0)]);
    pairs += a[r.index(c1, r1)];
  }
  EXPECT_GT(pairs, 5U);
  EXPECT_LT(pairs, 55U);
}

TEST(Viewshed, GrowsWithObserverHeightAndRadius) {
  std::mt19937 rng(11);
  for (int round = 0; round < 40; ++round) {
    const Raster r = random_terrain(rng, round % 2 == 1);
    const Observer low{r.columns / 2, r.rows / 2, 1}, high{low.column, low.row, 3};
    if (!r.valid(low.column, low.row)) continue;
    const auto a = viewshed(r, low), b = viewshed(r, high), near = viewshed(r, low, {.radius = 8});
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_LE(a[i], b[i]);
      EXPECT_LE(near[i], a[i]);
    }
  }
}

TEST(Viewshed, TurnsWithTheGrid) {
  std::mt19937 rng(13);
  const Raster r = test::make_grid(31, 24, [&](int, int) { return std::uniform_int_distribution<int>(0, 9)(rng); });
  const Raster turned =
      test::make_grid(24, 31, [&](int x, int y) { return r.at(30 - y, x); });  // (c, w) -> (w, 30 - c)
  const auto a = viewshed(r, {9, 5, 2}), b = viewshed(turned, {5, 30 - 9, 2});
  for (int y = 0; y < r.rows; ++y)
    for (int x = 0; x < r.columns; ++x) ASSERT_EQ(a[r.index(x, y)], b[turned.index(y, 30 - x)]) << x << ' ' << y;
}

TEST(Viewshed, SameFromAnyNumberOfThreads) {
  std::mt19937 rng(17);
  const Raster r = test::make_grid(200, 180, [&](int x, int y) {
    return 20 * std::sin(x * 0.1) + 15 * std::cos(y * 0.07) + std::uniform_real_distribution<double>(0, 2)(rng);
  });
  Context one, many;
  one.threads = 1;
  many.threads = 7;
  const std::vector<Observer> observers{{3, 4, 2}, {100, 90, 2}, {199, 179, 5}};
  EXPECT_EQ(observer_counts(r, observers, {}, one), observer_counts(r, observers, {}, many));
}

TEST(Viewshed, FieldOfViewIsAMask) {
  const Raster r = test::make_grid(41, 41, [](int x, int y) { return (x * 7 + y * 13) % 5; });
  const auto all = viewshed(r, {20, 20, 3});
  const auto north_east = viewshed(r, {20, 20, 3}, {.azimuth_from = 0, .azimuth_to = 90});
  const auto through_north = viewshed(r, {20, 20, 3}, {.azimuth_from = 315, .azimuth_to = 405});
  for (int y = 0; y < 41; ++y)
    for (int x = 0; x < 41; ++x) {
      if (x == 20 && y == 20) continue;
      EXPECT_EQ(north_east[r.index(x, y)], x >= 20 && y <= 20 ? all[r.index(x, y)] : 0);
      EXPECT_EQ(through_north[r.index(x, y)], 20 - y >= std::abs(x - 20) ? all[r.index(x, y)] : 0) << x << ' ' << y;
    }
}

TEST(Viewshed, RefusesObserversOffTheData) {
  const Raster r = test::make_grid(5, 5, [](int x, int) { return x == 2 ? kVoid : 1; });
  EXPECT_THROW(viewshed(r, {5, 0, 1}), BadInput);
  EXPECT_THROW(viewshed(r, {2, 0, 1}), BadInput);
  EXPECT_THROW(observer_at(r, {-3, 0}, 1), BadInput);
  EXPECT_EQ(observer_at(r, {3.4, -1.6}, 1).row, 2);
}

}  // namespace
}  // namespace retalho
