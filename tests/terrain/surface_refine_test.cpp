// Refinement by the surface's own error, in the words of its header.
#include "retalho/terrain/surface_refine.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/report.h"
#include "retalho/tin/grid_cell.h"
#include "retalho/tin/refine.h"
#include "support/grids.h"

namespace retalho {
namespace {

constexpr SurfaceKind kKinds[] = {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher};

double hills(double x, double y) {
  return 40 * std::sin(x / 9.0) * std::cos(y / 12.0) + 10 * std::sin((x + 2 * y) / 5.0) + x / 3 +
         3 * std::sin(x * y / 300);
}

Raster hill_grid(int columns, int rows) {
  return test::make_grid<double>(columns, rows, [](int x, int y) { return hills(x, y); });
}

void expect_delaunay(const Terrain& terrain, const Raster& raster) {
  std::vector<greedy::Cell> cells;
  for (const Vec2 p : terrain.tin.points) {
    const double column = p.x / raster.cell_width, row = -p.y / raster.cell_height;
    ASSERT_NEAR(column, std::round(column), 1e-9);
    ASSERT_NEAR(row, std::round(row), 1e-9);
    cells.push_back(greedy::cell_at(static_cast<int>(std::lround(column)), static_cast<int>(std::lround(row))));
  }
  for (std::size_t t = 0; t < terrain.tin.triangle_count(); ++t) {
    const auto& v = terrain.tin.triangles[t];
    for (const std::uint32_t n : terrain.tin.neighbors[t]) {
      if (n == kNone) continue;
      for (const std::uint32_t far : terrain.tin.triangles[n]) {
        ASSERT_FALSE(greedy::in_circle(cells[v[0]], cells[v[2]], cells[v[1]], cells[far]));
      }
    }
  }
}

TEST(RefineSurface, BeatsFlatRefinementAtEqualNumbers) {
  const Raster raster = hill_grid(130, 110);
  const ErrorReport flat =
      assess(make_terrain(refine_tin(raster, {.vertices = 500}), raster, {SurfaceKind::linear}), raster);
  for (const SurfaceKind kind : kKinds) {
    const std::size_t vertices = kind == SurfaceKind::linear ? 500 : 300;
    const Terrain terrain = refine_surface(raster, {.surface = kind, .vertices = vertices});
    EXPECT_EQ(terrain.tin.vertex_count(), vertices);
    expect_delaunay(terrain, raster);
    const ErrorReport ours = assess(terrain, raster);
    EXPECT_EQ(ours.uncovered, 0U);
    EXPECT_LT(ours.rmse, (kind == SurfaceKind::linear ? 0.75 : 0.5) * flat.rmse) << surface_name(kind);
    if (kind != SurfaceKind::linear) {
      EXPECT_LT(ours.slope_rmse, 0.6 * flat.slope_rmse) << surface_name(kind);
    }
  }
}

// The payload of a flat model, on vertices of its own: better than on the flat refinement's, and than the flat surface.
TEST(RefineSurface, HeightsAloneBeatTheFlatSurfaceAtItsPayload) {
  const Raster raster = hill_grid(130, 110);
  const Tin tin = refine_tin(raster, {.vertices = 500});
  const double flat = assess(make_terrain(tin, raster, {SurfaceKind::linear}), raster).rmse;
  for (const SurfaceKind kind : {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
    const Terrain there =
        fit_least_squares(make_terrain(tin, raster, {.surface = kind}), raster, {.heights_only = true});
    const Terrain own = refine_surface(raster, {.surface = kind, .vertices = 500, .heights_only = true});
    EXPECT_EQ(own.kind, kind);
    EXPECT_EQ(own.tin.vertex_count(), 500);
    EXPECT_EQ(own.gradient_kind, GradientKind::normals);  // they follow from the heights: no number is stored for them
    EXPECT_LT(assess(own, raster).rmse, assess(there, raster).rmse);
    EXPECT_LT(assess(own, raster).rmse, 0.7 * flat);
  }
}

TEST(RefineSurface, EveryStageHelps) {
  const Raster raster = hill_grid(130, 110);
  for (const SurfaceKind kind : kKinds) {
    SurfaceRefineOptions options{.surface = kind, .vertices = 250, .relocations = 0, .exchanges = 0};
    const double grown = assess(refine_surface(raster, options), raster).rmse;
    options.relocations = 3;
    const double relocated = assess(refine_surface(raster, options), raster).rmse;
    options.exchanges = 5;
    const double exchanged = assess(refine_surface(raster, options), raster).rmse;
    EXPECT_LT(relocated, grown) << surface_name(kind);
    EXPECT_LT(exchanged, relocated) << surface_name(kind);
    const Terrain greedy =
        fit_least_squares(make_terrain(refine_tin(raster, {.vertices = 250}), raster, {.surface = kind}), raster);
    EXPECT_LT(exchanged, assess(greedy, raster).rmse) << surface_name(kind);
  }
}

TEST(RefineSurface, TheSameFromAnyNumberOfThreads) {
  const Raster raster = hill_grid(160, 150);
  for (const SurfaceKind kind : kKinds) {
    Context one, four;
    one.threads = 1;
    four.threads = 4;
    const SurfaceRefineOptions budget{.surface = kind, .vertices = 700, .relocations = 2, .exchanges = 1};
    const SurfaceRefineOptions tolerance{.surface = kind, .max_error = 2, .relocations = 1, .exchanges = 1};
    for (const SurfaceRefineOptions& options : {budget, tolerance}) {
      const Terrain a = refine_surface(raster, options, one), b = refine_surface(raster, options, four);
      EXPECT_EQ(a.tin.points, b.tin.points);
      EXPECT_EQ(a.tin.heights, b.tin.heights);
      EXPECT_EQ(a.tin.triangles, b.tin.triangles);
      EXPECT_EQ(a.gradients, b.gradients);
    }
  }
}

TEST(RefineSurface, VoidsAndOddGridsAreCovered) {
  const auto voids = [](int x, int y) {  // a slanting map sheet with a lake cut out
    const bool outside =
        9 * y < x - 4 || 9 * (89 - y) < 99 - x || x > 96 + (y / 20) || (x - 30) * (x - 30) + (y - 40) * (y - 40) < 150;
    return outside ? std::nan("") : hills(x, y);
  };
  const Raster sheet = test::make_grid<double>(100, 90, voids);
  const Raster flat = test::make_grid(30, 20, [](int, int) { return 5.0F; });
  const Raster narrow = test::make_grid<double>(200, 2, [](int x, int y) { return hills(x, y); });
  const Raster tiny = test::make_grid<double>(2, 2, [](int x, int y) { return x + 2.0 * y; });
  Raster oblong = hill_grid(60, 90);
  oblong.cell_width = 30;
  oblong.cell_height = 70;
  const std::array<const Raster*, 5> grids{&sheet, &flat, &narrow, &tiny, &oblong};
  for (const Raster* raster : grids)
    for (const SurfaceKind kind : kKinds) {
      const Terrain terrain =
          refine_surface(*raster, {.surface = kind, .vertices = 120, .relocations = 1, .exchanges = 1});
      EXPECT_LE(terrain.tin.vertex_count(), 120U);
      expect_delaunay(terrain, *raster);
      const ErrorReport report = assess(terrain, *raster);
      EXPECT_EQ(report.uncovered, 0U);
      EXPECT_TRUE(std::isfinite(report.rmse) && std::isfinite(report.slope_rmse));
      for (const double z : terrain.tin.heights) EXPECT_TRUE(std::isfinite(z));
      for (const Vec2 g : terrain.gradients) EXPECT_TRUE(std::isfinite(g.x) && std::isfinite(g.y));
    }
  EXPECT_LT(assess(refine_surface(flat, {.vertices = 50}), flat).max_error, 1e-6);
}

/// Every valid cell, by the evaluator: neither the refinement's scan nor the report's.
double largest_error(const Terrain& terrain, const Raster& raster) {
  const TerrainEvaluator evaluator(terrain);
  double largest = 0;
  for (int y = 0; y < raster.rows; ++y)
    for (int x = 0; x < raster.columns; ++x) {
      if (!raster.valid(x, y)) continue;
      const double error = std::abs(evaluator.value(raster.centre(x, y)) - raster.at(x, y));
      if (!(error <= largest)) largest = error;
    }
  return largest;
}

TEST(RefineSurface, EveryCellIsWithinTheTolerance) {
  const Raster smooth = hill_grid(110, 90);
  const Raster steps = test::make_grid<double>(70, 60, [](int x, int y) {  // buildings
    const double ground = hills(x, y) / 4;
    return (x / 12 + y / 15) % 2 == 0 ? ground + 25 : ground;
  });
  const Raster voids = test::make_grid<double>(70, 60, [](int x, int y) {
    return 7 * y < x - 9 || (x - 30) * (x - 30) + (y - 40) * (y - 40) < 150 ? std::nan("") : hills(x, y);
  });
  const std::array<const Raster*, 3> grids{&smooth, &steps, &voids};
  for (const Raster* raster : grids)
    for (const SurfaceKind kind : kKinds)
      for (const double tolerance : {6.0, 1.0}) {
        const Terrain terrain = refine_surface(*raster, {.surface = kind, .max_error = tolerance, .exchanges = 2});
        EXPECT_EQ(assess(terrain, *raster, tolerance).violations, 0U) << surface_name(kind) << " " << tolerance;
        EXPECT_LE(largest_error(terrain, *raster), tolerance * (1 + 1e-12)) << surface_name(kind) << " " << tolerance;
        EXPECT_EQ(terrain.tolerance, tolerance);
      }
  const std::size_t flat = refine_tin(smooth, {.max_error = 1}).vertex_count();
  EXPECT_LT(5 * refine_surface(smooth, {.max_error = 1}).tin.vertex_count(), 0.6 * 3 * static_cast<double>(flat));
}

TEST(RefineSurface, AToleranceThatNothingMeetsButEveryCellEnds) {
  const Raster noise = test::make_grid<double>(24, 20, [](int x, int y) { return (x * 7919 + y * 104729) % 101; });
  for (const SurfaceKind kind : kKinds)
    for (const double tolerance : {1e-3, 1e-12}) {
      const Terrain terrain = refine_surface(noise, {.surface = kind, .max_error = tolerance});
      EXPECT_EQ(assess(terrain, noise, tolerance).violations, 0U) << surface_name(kind);
    }
}

TEST(RefineSurface, BudgetAndToleranceWhicheverComesFirst) {
  const Raster raster = hill_grid(110, 90);
  EXPECT_LE(refine_surface(raster, {.max_error = 0.1, .vertices = 100}).tin.vertex_count(), 100U);
  const Terrain loose = refine_surface(raster, {.max_error = 20, .vertices = 4000});
  EXPECT_LT(loose.tin.vertex_count(), 1000U);
  EXPECT_EQ(assess(loose, raster, 20).violations, 0U);
}

TEST(RefineSurface, RefusesWhatMakesNoSense) {
  EXPECT_THROW(
      refine_surface(hill_grid(20, 20), {.surface = SurfaceKind::linear, .vertices = 30, .heights_only = true}),
      UsageError);
  EXPECT_THROW(refine_surface(hill_grid(20, 20), {.max_error = 1, .heights_only = true}), UsageError);
  const Raster raster = hill_grid(20, 20);
  EXPECT_THROW(refine_surface(raster, {.vertices = 10, .growth = 0}), UsageError);
  EXPECT_THROW(refine_surface(raster, {.vertices = 10, .relocations = -1}), UsageError);
  EXPECT_THROW(refine_surface(raster, {.max_error = -1}), UsageError);
  EXPECT_THROW(refine_surface(raster, {}), UsageError);
  EXPECT_THROW(refine_surface(raster, {.vertices = 10, .fairness = std::nan("")}), UsageError);
  const Raster nothing = test::make_grid<double>(20, 20, [](int, int) { return std::nan(""); });
  EXPECT_THROW(refine_surface(nothing, {.vertices = 10}), BadInput);
}

}  // namespace
}  // namespace retalho
