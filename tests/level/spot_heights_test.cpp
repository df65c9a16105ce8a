// The promises of level/spot_heights.h.
#include "retalho/level/spot_heights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "level/contour_support.h"
#include "retalho/core/error.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"

namespace retalho {
namespace {

double bump(double x, double y, double cx, double cy, double height) {
  return height * std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / 18);
}

/// Two hills and a hollow; nothing else rises or falls inside.
double hills(double x, double y) {
  return bump(x, y, 10.3, 10.4, 20) + bump(x, y, 22.2, 12.6, 12) - bump(x, y, 15.4, 28.7, 9);
}

TEST(SpotHeights, SummitsAndPitsAtTheSurfacesOwnExtrema) {
  const BicubicGrid grid = make_bicubic(test::contour_raster(34, 40, [](int c, int r) { return hills(c, r); }));
  const std::vector<SpotHeight> spots = find_spot_heights(grid, 1);
  ASSERT_EQ(spots.size(), 3U);
  // By prominence: the higher hill has all the range, then what the lower one and the hollow stand over their passes.
  EXPECT_TRUE(spots[0].summit);
  EXPECT_NEAR(spots[0].at.x, 10.3, 0.05);
  EXPECT_NEAR(spots[0].at.y, -10.4, 0.05);
  EXPECT_NEAR(spots[0].height, 20, 0.05);
  EXPECT_NEAR(spots[0].prominence, 29, 0.8);  // among samples: a little less than 20 + 9
  for (const SpotHeight& spot : spots) {
    const std::optional<Jet> jet = grid.at(spot.at);
    ASSERT_TRUE(jet);
    EXPECT_LT(norm(jet->gradient), 1e-4);
    EXPECT_EQ(jet->value, spot.height);
    EXPECT_EQ(spot.summit, jet->xx < 0);
  }
  EXPECT_EQ(find_spot_heights(grid, 10).size(), 2U) << "the lower hill stands less than 10 above its pass";
}

/// Prominence by its definition: the highest pass on the way to higher ground, by flooding from the summit.
double slow_prominence(const std::vector<double>& z, int columns, int rows, int start) {
  std::vector<char> seen(z.size(), 0);
  double pass = z[static_cast<std::size_t>(start)];
  std::vector<int> edge{start};
  seen[static_cast<std::size_t>(start)] = 1;
  double lowest = pass;
  while (!edge.empty()) {
    const auto best = std::max_element(edge.begin(), edge.end(), [&](int a, int b) {
      return z[static_cast<std::size_t>(a)] < z[static_cast<std::size_t>(b)];
    });
    const int i = *best;
    edge.erase(best);
    const double here = z[static_cast<std::size_t>(i)];
    if (here > z[static_cast<std::size_t>(start)]) return z[static_cast<std::size_t>(start)] - pass;
    pass = std::min(pass, here);
    lowest = std::min(lowest, here);
    for (int r = std::max(0, i / columns - 1); r <= std::min(rows - 1, i / columns + 1); ++r)
      for (int c = std::max(0, i % columns - 1); c <= std::min(columns - 1, i % columns + 1); ++c) {
        const int j = r * columns + c;
        if (seen[static_cast<std::size_t>(j)] != 0) continue;
        seen[static_cast<std::size_t>(j)] = 1;
        edge.push_back(j);
      }
  }
  return z[static_cast<std::size_t>(start)] - lowest;
}

TEST(SpotHeights, EqualTheDefinitionOnRandomGrids) {
  test::Random random;
  std::size_t found = 0;
  for (int round = 0; round < 20 * test::soak(); ++round) {
    const int columns = 12, rows = 10;
    const BicubicGrid grid =
        make_bicubic(test::contour_raster(columns, rows, [&](int, int) { return random.uniform(0, 10); }));
    std::vector<double> down(grid.z.size());
    std::transform(grid.z.begin(), grid.z.end(), down.begin(), [](double z) { return -z; });
    std::vector<double> expected;
    for (int r = 1; r + 1 < rows; ++r)
      for (int c = 1; c + 1 < columns; ++c)
        for (const std::vector<double>* z : {&grid.z, static_cast<const std::vector<double>*>(&down)}) {
          const int i = r * columns + c;
          bool top = true;
          for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc)
              if (dr != 0 || dc != 0)
                top = top && (*z)[static_cast<std::size_t>(i + dr * columns + dc)] < (*z)[static_cast<std::size_t>(i)];
          if (!top) continue;
          const double p = slow_prominence(*z, columns, rows, i);
          if (p >= 3) expected.push_back(p);
        }
    std::sort(expected.rbegin(), expected.rend());
    const std::vector<SpotHeight> spots = find_spot_heights(grid, 3);
    ASSERT_EQ(spots.size(), expected.size());
    for (std::size_t k = 0; k < spots.size(); ++k) EXPECT_EQ(spots[k].prominence, expected[k]);
    found += spots.size();
  }
  EXPECT_GT(found, 100U);
}

TEST(SpotHeights, NoneOnTheBorderAndLakesInTheirMiddle) {
  const auto slope = [](int c, int r) { return 3.0 * c + r; };
  EXPECT_TRUE(find_spot_heights(make_bicubic(test::contour_raster(12, 12, slope)), 0.5).empty());
  // A lake of 9 x 5 samples in a bowl; a sea that reaches the border is no pit.
  const auto bowl = [](int c, int r) {
    return std::max(4.0, std::max(2.0 * std::abs(c - 10) - 5, 3.0 * std::abs(r - 8) - 5));
  };
  const std::vector<SpotHeight> lake = find_spot_heights(make_bicubic(test::contour_raster(21, 17, bowl)), 2);
  ASSERT_EQ(lake.size(), 1U);
  EXPECT_FALSE(lake[0].summit);
  EXPECT_EQ(lake[0].height, 4);
  EXPECT_LE(std::abs(lake[0].at.x - 10), 2);
  EXPECT_EQ(lake[0].at.y, -8);
  const auto sea = [](int c, int r) { return std::max(0.0, 10.0 - std::hypot(c - 9, r - 9)); };
  const std::vector<SpotHeight> island = find_spot_heights(make_bicubic(test::contour_raster(19, 19, sea)), 1);
  ASSERT_EQ(island.size(), 1U);
  EXPECT_TRUE(island[0].summit);
  // Beside a void the ground may go on rising.
  const auto hole = [](int c, int r) {
    return c == 10 && r == 10 ? std::numeric_limits<double>::quiet_NaN() : 20 - std::hypot(c - 9, r - 9);
  };
  EXPECT_TRUE(find_spot_heights(make_bicubic(test::contour_raster(19, 19, hole)), 1).empty());
}

TEST(SpotHeights, OfModels) {
  const Raster raster = test::contour_raster(34, 40, [](int c, int r) { return hills(c, r); });
  const Terrain terrain = make_terrain(refine_tin(raster, {.max_error = 0.05}), raster, {});
  const std::vector<SpotHeight> spots = find_spot_heights(terrain, 3);
  ASSERT_EQ(spots.size(), 3U);
  EXPECT_LT(norm(spots[0].at - Vec2{10.3, -10.4}), 1.5);
}

TEST(SpotHeights, TheIntervalSetsTheProminence) {
  EXPECT_EQ(spot_prominence({100, 120, 140}, 90, 150), 20);
  EXPECT_EQ(spot_prominence({100}, 90, 150), 3);
  EXPECT_THROW(find_spot_heights(BicubicGrid{}, 0), BadInput);
}

}  // namespace
}  // namespace retalho
