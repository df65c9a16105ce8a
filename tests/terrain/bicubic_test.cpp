// The promises of terrain/bicubic.h.
#include "retalho/terrain/bicubic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "retalho/core/error.h"
#include "support/grids.h"
#include "support/paths.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::make_grid;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Bicubic, WithSplineTwistIsScipysRectBivariateSpline) {
  const auto reference =
      nlohmann::json::parse(test::bytes_of(test::source_folder() + "/tests/data/bicubic_reference.json"));
  const auto& z = reference["z"];
  const Raster raster = make_grid<double>(static_cast<int>(z[0].size()), static_cast<int>(z.size()), [&](int c, int r) {
    return z[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)].get<double>();
  });
  const BicubicGrid grid = make_bicubic(raster, {.keep_flats = false});
  for (std::size_t i = 0; i < reference["u"].size(); ++i) {
    const Jet jet = grid.at({reference["u"][i].get<double>(), -reference["v"][i].get<double>()}).value();
    EXPECT_NEAR(jet.value, reference["value"][i].get<double>(), 1e-12 * 10);
    EXPECT_NEAR(jet.gradient.x, reference["du"][i].get<double>(), 1e-11);
    EXPECT_NEAR(jet.gradient.y, -reference["dv"][i].get<double>(), 1e-11);
    EXPECT_NEAR(jet.xy, -reference["duv"][i].get<double>(), 1e-10);
  }
}

TEST(Bicubic, ReproducesWhatItsTwistCan) {
  const auto cubic = [](double u, double v) { return (1 + u - 2 * u * u + u * u * u) * (v * v * v - v + 2) / 50; };
  const auto ruled = [](double u, double v) { return u * v + u * u * u - 3 * v * v * v + u * u * v; };
  const auto plain = [](double u, double v) { return u * u * u - v * v + 3 * u; };
  const auto error = [&](const auto& f, Twist twist) {
    const Raster raster = make_grid<double>(9, 8, [&](int c, int r) { return f(c * 0.3, r * 0.3); });
    const BicubicGrid grid = make_bicubic(raster, {.twist = twist, .keep_flats = false});
    test::Random random;
    double worst = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec2 p{random.uniform(0, 8), -random.uniform(0, 7)};
      worst = std::max(worst, std::abs(grid.at(p)->value - f(p.x * 0.3, -p.y * 0.3)));
    }
    return worst;
  };
  EXPECT_LT(error(cubic, Twist::spline), 1e-12);
  EXPECT_LT(error(ruled, Twist::adini), 1e-12);
  EXPECT_LT(error(plain, Twist::zero), 1e-12);
  EXPECT_GT(error(ruled, Twist::zero), 1e-4);  // the paper's twist does not reproduce u v
}

TEST(Bicubic, ATileWithAHaloGivesTheSameBits) {
  test::Random random;
  std::vector<double> heights(150 * 140);
  for (double& h : heights) h = random.uniform(0, 100);
  const auto at = [&](int c, int r) { return heights[static_cast<std::size_t>(r * 150 + c)]; };
  const auto with_voids = [&](int c, int r) { return (c * 31 + r * 17) % 97 == 0 ? kNan : at(c, r); };
  for (const bool voids : {false, true}) {
    const auto height = [&](int c, int r) { return voids ? with_voids(c, r) : at(c, r); };
    const BicubicGrid whole = make_bicubic(make_grid<double>(150, 140, height));
    // The tile of samples [50, 90) x [40, 80), cut out with its halo.
    const int left = 50 - kSplineHalo, top = 40 - kSplineHalo, side = 40 + 2 * kSplineHalo;
    const BicubicGrid tile =
        make_bicubic(make_grid<double>(side, side, [&](int c, int r) { return height(left + c, top + r); }));
    for (int r = 40; r < 80; ++r)
      for (int c = 50; c < 90; ++c) {
        const auto i = static_cast<std::size_t>(r * 150 + c), j = static_cast<std::size_t>((r - top) * side + c - left);
        EXPECT_EQ(whole.zu[i], tile.zu[j]);
        EXPECT_EQ(whole.zv[i], tile.zv[j]);
      }
  }
}

TEST(Bicubic, RunsOfTwoAreLinearAndOfThreeParabolas) {
  const Raster raster = make_grid<double>(3, 2, [](int c, int) { return c * c; });
  const BicubicGrid grid = make_bicubic(raster);
  EXPECT_NEAR(grid.at({0.5, 0})->value, 0.25, 1e-15);
  EXPECT_NEAR(grid.at({1.5, -0.7})->value, 2.25, 1e-15);
  EXPECT_NEAR(grid.at({1.5, -0.7})->gradient.y, 0, 1e-15);
}

TEST(Bicubic, PatchesNeedFourSamplesAndVoidsSplitTheRuns) {
  const Raster raster = make_grid<double>(9, 9, [](int c, int r) { return c == 4 && r == 4 ? kNan : c * 2.0; });
  const BicubicGrid grid = make_bicubic(raster);
  EXPECT_FALSE(grid.at({3.5, -4.5}));
  EXPECT_FALSE(grid.at({4.5, -3.5}));
  EXPECT_FALSE(grid.at({8.5, -3.5}));
  EXPECT_NEAR(grid.at({2.5, -4})->value, 5, 1e-14);
}

TEST(Bicubic, KeepsFlatsFlatUnlessAskedToRing) {
  // A lake of 10 beside a hill.
  const Raster raster =
      make_grid<double>(20, 20, [](int c, int r) { return c < 10 ? 10.0 : 10.0 + 3 * (c - 9) + r % 3; });
  const BicubicGrid flat = make_bicubic(raster), ringing = make_bicubic(raster, {.keep_flats = false});
  double worst = 0, ring = 0;
  for (int i = 0; i < 80; ++i)
    for (int j = 0; j < 190; ++j) {
      const Vec2 p{0.1 * i, -0.1 * j};
      worst = std::max(worst, std::abs(flat.at(p)->value - 10));
      ring = std::max(ring, std::abs(ringing.at(p)->value - 10));
    }
  EXPECT_LT(worst, 1e-13);
  EXPECT_GT(ring, 0.01);
}

TEST(Bicubic, RefusesAGridWithoutCells) {
  EXPECT_THROW(make_bicubic(make_grid<double>(1, 5, [](int, int) { return 1.0; })), BadInput);
}

}  // namespace
}  // namespace retalho
