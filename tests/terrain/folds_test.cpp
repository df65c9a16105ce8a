// Folded vertices: the surface is continuous, flat where all corners are folded, and the fit minimises what the
// evaluator's surface misses.
#include "retalho/terrain/folds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "retalho/core/error.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/folded_surface.h"
#include "retalho/terrain/held_fit.h"
#include "retalho/tin/cell_delaunay.h"
#include "support/grids.h"

namespace retalho {
namespace {

using greedy::cell_at;

constexpr int kColumns = 40, kRows = 30;

/// A wall through waves, cells that are not square.
Raster wall() {
  Raster raster = test::make_grid<double>(kColumns, kRows, [](int x, int y) {
    return 3 * std::sin(x / 5.0) + 2 * std::cos(y / 4.0) + (3 * x > 2 * y + 40 ? 25.0 : 0.0);
  });
  raster.cell_width = 3;
  raster.cell_height = 2;
  return raster;
}

FoldedVertices some_vertices(unsigned seed) {
  std::mt19937 random(seed);
  FoldedVertices v;
  for (int y = 0; y < kRows; ++y)
    for (int x = 0; x < kColumns; ++x) {
      const bool corner = (x == 0 || x == kColumns - 1) && (y == 0 || y == kRows - 1);
      if (!corner && random() % 30 != 0) continue;
      v.cells.push_back(cell_at(x, y));
      v.folded.push_back(random() % 3 == 0 ? 1 : 0);
    }
  return v;
}

/// What the fit has found, as a terrain.
Terrain terrain_of(const HeldFit& fit, const FoldedVertices& v, const Raster& raster) {
  Tin tin;
  std::vector<Vec2> gradients;
  const double unit = std::sqrt(raster.cell_width * raster.cell_height);
  for (std::uint32_t k = 0; k < v.cells.size(); ++k) {
    tin.points.push_back(raster.centre(greedy::column_of(v.cells[k]), greedy::row_of(v.cells[k])));
    tin.heights.push_back(fit.height(k));
    gradients.push_back(fit.gradient(k) / unit);
  }
  const CellTriangulation t = triangulate_cells(v.cells);
  for (const auto& c : t.mesh.triangles()) tin.triangles.push_back({t.vertex[c[0]], t.vertex[c[1]], t.vertex[c[2]]});
  build_neighbors(tin);
  FoldedSurface surface = folded_surface(tin, v.folded, gradients);
  return make_terrain(std::move(tin), raster,
                      {.gradients = GradientKind::given, .given = surface.gradients, .creases = surface.creases});
}

TEST(Folds, TheFitsErrorsAreThoseOfTheTerrainWithCreases) {
  const Raster raster = wall();
  for (const unsigned seed : {1U, 2U, 3U}) {
    const FoldedVertices v = some_vertices(seed);
    HeldFit fit(raster, v.cells, {}, {}, v.folded);
    fit.solve(1e-9);
    const Terrain terrain = terrain_of(fit, v, raster);
    const TerrainEvaluator evaluator(terrain);
    const std::vector<double> errors = fit.errors();
    for (int y = 0; y < kRows; ++y)
      for (int x = 0; x < kColumns; ++x)
        EXPECT_NEAR(errors[raster.index(x, y)], evaluator.value(raster.centre(x, y)) - raster.at(x, y), 1e-9);
  }
}

TEST(Folds, NoOtherNumbersMissLess) {
  const Raster raster = wall();
  const FoldedVertices v = some_vertices(4);
  HeldFit fit(raster, v.cells, {.slope_weight = 0, .fairness = 0}, {}, v.folded);
  fit.solve(1e-12);
  const auto squares = [&] {
    double sum = 0;
    for (const double e : fit.errors()) sum += e * e;
    return sum;
  };
  const double least = squares();
  for (std::uint32_t k = 0; k < v.cells.size(); ++k) {
    const double z = fit.height(k);
    const Vec2 g = fit.gradient(k);
    for (const double by : {-0.05, 0.05}) {
      fit.set(k, z + by, g);
      EXPECT_GT(squares(), least) << k;
      for (const Vec2 other : {Vec2{g.x + by, g.y}, Vec2{g.x, g.y + by}}) {
        fit.set(k, z, other);
        if (v.folded[k] != 0)
          EXPECT_NEAR(squares(), least, 1e-9 * least) << k;  // it has no gradient
        else
          EXPECT_GT(squares(), least) << k;
      }
    }
    fit.set(k, z, g);
  }
}

TEST(Folds, TheSurfaceIsContinuousAndFlatBetweenFoldedVertices) {
  const Raster raster = wall();
  const FoldedVertices v = some_vertices(5);
  HeldFit fit(raster, v.cells, {}, {}, v.folded);
  fit.solve(1e-6);
  const Terrain terrain = terrain_of(fit, v, raster);
  const TerrainEvaluator evaluator(terrain);
  const auto& p = terrain.tin.points;
  std::size_t flat = 0;
  for (const auto& t : terrain.tin.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {  // just beside an edge, on both sides
      const Vec2 a = p[t[k]], b = p[t[(k + 1) % 3]], across = Vec2{a.y - b.y, b.x - a.x} * (1e-9 / norm(b - a));
      const Vec2 at = a + 0.3 * (b - a);
      if (at.x < 1 || at.y > -1 || at.x > 3 * (kColumns - 1) - 1 || at.y < -2 * (kRows - 1) + 1) continue;
      EXPECT_NEAR(evaluator.value(at + across), evaluator.value(at - across), 1e-6);
    }
    if (v.folded[t[0]] == 0 || v.folded[t[1]] == 0 || v.folded[t[2]] == 0) continue;
    ++flat;
    const auto& z = terrain.tin.heights;
    EXPECT_NEAR(evaluator.value((p[t[0]] + p[t[1]] + p[t[2]]) / 3), (z[t[0]] + z[t[1]] + z[t[2]]) / 3, 1e-9);
  }
  EXPECT_GT(flat, 0U);
}

TEST(Folds, VerticesFoldAtAWallAndNotOnAHill) {
  const SurfaceRefineOptions options{.max_error = 0.5};
  const auto share = [&](const Raster& raster) {
    const FoldedVertices v = refine_folded(raster, options);
    EXPECT_TRUE(std::is_sorted(v.cells.begin(), v.cells.end()));
    EXPECT_EQ(v.cells.size(), v.folded.size());
    return static_cast<double>(std::count(v.folded.begin(), v.folded.end(), 1)) / static_cast<double>(v.cells.size());
  };
  EXPECT_GT(share(wall()), 0.2);
  const Raster hill = test::make_grid<double>(
      80, 60, [](int x, int y) { return 40 * std::exp(-((x - 40) * (x - 40) + (y - 30) * (y - 30)) / 500.0); });
  EXPECT_LT(share(hill), 0.15);
  EXPECT_THROW(refine_folded(hill, {.surface = SurfaceKind::linear, .max_error = 1}), UsageError);
}

}  // namespace
}  // namespace retalho
