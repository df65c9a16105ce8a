// Sight lines over the surface itself: against dense samples of it, on every kind, with voids, through vertices.
#include "retalho/visibility/surface_viewshed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "retalho/core/error.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"
#include "retalho/visibility/surface_sight.h"
#include "support/support.h"

namespace retalho {
namespace {

using visibility_detail::SurfaceSight;

constexpr int kColumns = 24, kRows = 19;

Raster hills(test::Random& random, bool voids) {
  Raster raster;
  raster.columns = kColumns;
  raster.rows = kRows;
  raster.cell_width = 10;
  raster.cell_height = 8;
  std::vector<double> z(raster.cells());
  const double a = random.uniform(0, 6), b = random.uniform(0, 6), c = random.uniform(0.2, 0.6);
  for (int r = 0; r < kRows; ++r)
    for (int k = 0; k < kColumns; ++k)
      z[raster.index(k, r)] = 40 * std::sin(c * k + a) * std::cos(0.4 * r + b) + random.uniform(-6, 6);
  if (voids)
    for (int i = 0; i < 12; ++i) z[random.index(z.size())] = std::numeric_limits<double>::quiet_NaN();
  raster.heights = std::move(z);
  return raster;
}

Terrain model(test::Random& random, bool voids, SurfaceKind kind) {
  const Raster raster = hills(random, voids);
  return make_terrain(refine_tin(raster, {.vertices = 60}), raster, {.surface = kind});
}

/// The steepest slope over many points of the way: a lower bound, near the truth.
double sampled_slope(const TerrainEvaluator& evaluator, Vec2 from, double eye, Vec2 to, double slope, int samples) {
  for (int i = 1; i <= samples; ++i) {
    const double t = static_cast<double>(i) / samples, z = evaluator.value(from + t * (to - from));
    if (!std::isnan(z)) slope = std::max(slope, (z - eye) / t);
  }
  return slope;
}

Vec2 centre(int column, int row) {
  return {column * 10.0, -row * 8.0};
}

TEST(SurfaceSight, SlopesAreThoseOfDenseSamples) {
  test::Random random(71);
  for (int round = 0; round < 60; ++round) {
    const auto kind = static_cast<SurfaceKind>(1 + round % 3);
    const bool voids = round % 4 == 3;
    const Terrain terrain = model(random, voids, kind);
    const TerrainEvaluator evaluator(terrain);
    const SegmentWalk walk(evaluator);
    for (int i = 0; i < 12; ++i) {
      // At vertices (which lie on cells) and elsewhere; lines along rows and columns are every third.
      Vec2 from = centre(static_cast<int>(random.index(kColumns)), static_cast<int>(random.index(kRows)));
      if (i % 4 == 0) from = terrain.tin.points[random.index(terrain.tin.vertex_count())];
      if (i % 4 == 1) from = {random.uniform(0, 230), random.uniform(-144, 0)};
      Vec2 to = centre(static_cast<int>(random.index(kColumns)), static_cast<int>(random.index(kRows)));
      if (i % 6 == 0) to.x = from.x;
      if (i % 6 == 3) to.y = from.y;
      if (from == to || !evaluator.valid(from) || !evaluator.valid(to)) continue;
      const double eye = evaluator.value(from) + random.uniform(0, 10), ground = evaluator.value(to) - eye;
      const SurfaceSight sight(walk, from, eye, 0, VoidRule::transparent);
      const double slope = sight.raise(to, ground, 1e300);
      const double coarse = sampled_slope(evaluator, from, eye, to, ground, 5000);
      EXPECT_GE(slope, coarse - 1e-8) << "round " << round;
      // Near the eye a slope is a small difference over a small t; elsewhere samples miss the top by its curvature.
      EXPECT_LE(slope, coarse + 0.02 * (1 + std::abs(coarse))) << "round " << round << " kind " << surface_name(kind);
    }
  }
}

TEST(SurfaceViewshed, SeesWhatDenseSamplesSee) {
  test::Random random(72);
  std::size_t seen = 0, hidden = 0, close = 0;
  for (int round = 0; round < 12; ++round) {
    const Terrain terrain = model(random, round % 3 == 2, static_cast<SurfaceKind>(1 + round % 3));
    const TerrainEvaluator evaluator(terrain);
    SurfaceObserver observer{{random.uniform(0, 230), random.uniform(-144, 0)}, random.uniform(0.5, 12)};
    while (!evaluator.valid(observer.at)) observer.at = {random.uniform(0, 230), random.uniform(-144, 0)};
    const ViewshedOptions options{.target_height = random.uniform(0, 3)};
    const auto counts = surface_observer_counts(evaluator, std::vector{observer}, options);
    const auto needed = surface_needed_heights(evaluator, std::vector{observer}, options);
    const double eye = evaluator.value(observer.at) + observer.height;
    for (int r = 0; r < kRows; ++r)
      for (int c = 0; c < kColumns; ++c) {
        const std::size_t cell = static_cast<std::size_t>(r * kColumns + c);
        const double z = evaluator.value(centre(c, r));
        if (std::isnan(z)) {
          EXPECT_EQ(counts[cell], 0U);
          EXPECT_TRUE(std::isnan(needed[cell]));
          continue;
        }
        const double free =
            z + options.target_height - eye - sampled_slope(evaluator, observer.at, eye, centre(c, r), z - eye, 3000);
        EXPECT_EQ(counts[cell] == 1, static_cast<double>(needed[cell]) <= options.target_height);
        if (std::abs(free) < 0.02 * (1 + std::abs(z - eye))) {
          ++close;
        } else {
          EXPECT_EQ(counts[cell] == 1, free > 0) << c << " " << r << " free " << free;
          ++(free > 0 ? seen : hidden);
        }
      }
  }
  EXPECT_GT(seen, 500U);
  EXPECT_GT(hidden, 500U);
  EXPECT_LT(close, 600U);
}

TEST(SurfaceViewshed, ALinearModelOnEveryCellSeesAsItsTriangles) {
  // A wall along a column on flat ground: what lies behind it is hidden up to the line over its top.
  Raster raster;
  raster.columns = 21;
  raster.rows = 5;
  std::vector<double> z(raster.cells(), 0);
  for (int r = 0; r < 5; ++r) z[raster.index(10, r)] = 4;
  raster.heights = std::move(z);
  const Terrain terrain = make_terrain(refine_tin(raster, {.max_error = 0}), raster, {.surface = SurfaceKind::linear});
  const TerrainEvaluator evaluator(terrain);
  const std::vector<SurfaceObserver> observer{{{0, -2}, 2}};
  const auto needed = surface_needed_heights(evaluator, observer);
  // Along row 2: eye 2 at 0, the top 4 at 10: at c the line stands 2 + 0.2 c high.
  for (int c = 12; c < 21; ++c) EXPECT_NEAR(needed[static_cast<std::size_t>(2 * 21 + c)], 2 + 0.2 * c, 1e-6);
  for (int c = 0; c < 10; ++c) EXPECT_EQ(needed[static_cast<std::size_t>(2 * 21 + c)], 0.0F);
}

TEST(SurfaceViewshed, FlatModelsSeeAllAndVoidsBlockWhereAsked) {
  Raster raster;
  raster.columns = 30;
  raster.rows = 20;
  std::vector<double> z(raster.cells(), 7);
  for (int r = 5; r < 15; ++r) z[raster.index(15, r)] = std::numeric_limits<double>::quiet_NaN();
  raster.heights = std::move(z);
  const Terrain terrain = make_terrain(refine_tin(raster, {.max_error = 0}), raster, {});
  const TerrainEvaluator evaluator(terrain);
  const std::vector<SurfaceObserver> observer{{{3, -10}, 2}};
  const auto through = surface_observer_counts(evaluator, observer);
  const auto blocked = surface_observer_counts(evaluator, observer, {.voids = VoidRule::blocks});
  for (int r = 0; r < 20; ++r)
    for (int c = 0; c < 30; ++c) {
      const auto cell = static_cast<std::size_t>(r * 30 + c);
      EXPECT_EQ(through[cell], raster.valid(c, r) ? 1U : 0U);
      EXPECT_LE(blocked[cell], through[cell]);
    }
  EXPECT_EQ(blocked[10 * 30 + 20], 0U);
  EXPECT_EQ(blocked[0 * 30 + 10], 1U);
}

TEST(SurfaceViewshed, IsMonotoneSymmetricAndTheSameFromAnyThreads) {
  test::Random random(73);
  const Terrain terrain = model(random, false, SurfaceKind::clough_tocher);
  const TerrainEvaluator evaluator(terrain);
  const auto low = surface_observer_counts(evaluator, std::vector<SurfaceObserver>{{centre(4, 4), 1}});
  const auto high = surface_observer_counts(evaluator, std::vector<SurfaceObserver>{{centre(4, 4), 9}});
  const auto near =
      surface_observer_counts(evaluator, std::vector<SurfaceObserver>{{centre(4, 4), 9}}, {.radius = 100});
  for (std::size_t i = 0; i < low.size(); ++i) {
    EXPECT_LE(low[i], high[i]);
    EXPECT_LE(near[i], high[i]);
  }
  // Equal heights of eye and target: who sees is seen.
  for (int i = 0; i < 400; ++i) {
    const int c = static_cast<int>(random.index(kColumns)), r = static_cast<int>(random.index(kRows)),
              c2 = static_cast<int>(random.index(kColumns)), r2 = static_cast<int>(random.index(kRows));
    const auto a = surface_line_of_sight(evaluator, {centre(c, r), 3}, centre(c2, r2), {.target_height = 3});
    const auto b = surface_line_of_sight(evaluator, {centre(c2, r2), 3}, centre(c, r), {.target_height = 3});
    EXPECT_EQ(a.visible, b.visible) << c << "," << r << " to " << c2 << "," << r2;
  }
  const std::vector<SurfaceObserver> two{{{33.3, -41.7}, 2}, {centre(20, 10), 5}};
  Context one, many;
  one.threads = 1;
  many.threads = 5;
  EXPECT_EQ(surface_needed_heights(evaluator, two, {}, one), surface_needed_heights(evaluator, two, {}, many));
}

TEST(SurfaceLineOfSight, TellsClearanceAndTheFirstBlockingPlace) {
  test::Random random(74);
  int blocked = 0;
  for (int round = 0; round < 60; ++round) {
    const Terrain terrain = model(random, false, static_cast<SurfaceKind>(1 + round % 3));
    const TerrainEvaluator evaluator(terrain);
    const Vec2 from = centre(static_cast<int>(random.index(kColumns)), static_cast<int>(random.index(kRows))),
               to = centre(static_cast<int>(random.index(kColumns)), static_cast<int>(random.index(kRows)));
    if (from == to) continue;
    const SightLine line = surface_line_of_sight(evaluator, {from, 4}, to, {.target_height = 2, .frequency = 1e9});
    const double eye = evaluator.value(from) + 4, aim = evaluator.value(to) + 2, length = norm(to - from);
    double clearance = 1e300, first = -1;
    constexpr int kSamples = 4000;
    for (int i = 0; i <= kSamples; ++i) {
      const double t = static_cast<double>(i) / kSamples;
      const double free = eye + t * (aim - eye) - evaluator.value(from + t * (to - from));
      clearance = std::min(clearance, free);
      if (free < 0 && first < 0) first = t * length;
    }
    EXPECT_LE(line.clearance, clearance + 1e-9);
    EXPECT_GE(line.clearance, clearance - 0.05);
    EXPECT_EQ(line.visible, line.clearance >= -1e-8);
    if (!line.visible && first > 0) {
      EXPECT_NEAR(line.blocked_at, first, 2 * length / kSamples);
      ++blocked;
    }
    ASSERT_GE(line.profile.size(), 2U);
    EXPECT_EQ(line.profile.front().distance, 0);
    EXPECT_NEAR(line.profile.back().distance, length, 1e-9);
    for (const ProfilePoint& p : line.profile) EXPECT_NEAR(p.ground, evaluator.value(p.at), 1e-6);
  }
  EXPECT_GT(blocked, 10);
}

TEST(SurfaceViewshed, RefusesObserversOffTheData) {
  test::Random random(75);
  const Terrain terrain = model(random, false, SurfaceKind::powell_sabin);
  const TerrainEvaluator evaluator(terrain);
  EXPECT_THROW(surface_observer_counts(evaluator, std::vector<SurfaceObserver>{{{-500, 0}, 2}}), BadInput);
  EXPECT_THROW(surface_observer_counts(evaluator, std::vector<SurfaceObserver>{{{10, -10}, -2}}), BadInput);
  EXPECT_THROW(surface_line_of_sight(evaluator, {{10, -10}, 2}, {1e6, 0}), BadInput);
}

}  // namespace
}  // namespace retalho
