// Least-squares fits of surfaces with creases.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "fit_twin.h"
#include "retalho/core/error.h"
#include "retalho/terrain/creases.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/report.h"
#include "retalho/tin/breaklines.h"
#include "retalho/tin/refine.h"
#include "support/errors.h"
#include "support/grids.h"
#include "support/support.h"

namespace retalho {
namespace {

constexpr SurfaceKind kSmooth[] = {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher};
constexpr int kRidge = 20;  // column of the roof's ridge

Raster grid_of(int columns, int rows, const std::function<double(double, double)>& height) {
  return test::make_grid<double>(columns, rows, [&](int x, int y) { return height(x, y); });
}

/// Two quadratics that meet along the ridge.
double roof(double x, double y) {
  const double across = x - kRidge, common = 5 + 0.3 * y - 0.01 * y * y;
  return across < 0 ? common + 2 * across + 0.02 * across * across - 0.01 * across * y
                    : common - across + 0.03 * across * across;
}

double rough(double x, double y) {
  return 30 * std::sin(x / 4.0) * std::cos(y / 5.0) + (x + y > 40 ? 25 : 0);
}

/// Random cells and the ridge's, triangulated along the ridge; heights and gradients are not the roof's.
ConstrainedTin along_the_ridge(const Raster& raster) {
  test::Random random;
  std::vector<Vec3> points;
  const auto add = [&](int c, int r) {
    const Vec2 p = raster.centre(c, r);
    points.push_back({p.x, p.y, random.uniform(0, 10)});
  };
  for (const int c : {0, raster.columns - 1})
    for (const int r : {0, raster.rows - 1}) add(c, r);
  for (int k = 0; k < 40; ++k)
    add(static_cast<int>(random.uniform(1, raster.columns - 1)), static_cast<int>(random.uniform(1, raster.rows - 1)));
  std::vector<Vec3> line;
  for (int r = 0; r < raster.rows; r += 4) {
    const Vec2 p = raster.centre(kRidge, r);
    line.push_back({p.x, p.y, random.uniform(0, 10)});
  }
  return triangulate_points(points, std::vector<std::vector<Vec3>>{line});
}

TEST(CreaseFit, ARoofIsFoundExactly) {
  const Raster raster = grid_of(41, 33, roof);
  const ConstrainedTin made = along_the_ridge(raster);
  for (const SurfaceKind kind : kSmooth) {
    const auto fitted = [&](const std::vector<std::uint32_t>& creases) {
      return assess(fit_least_squares(make_terrain(made.tin, raster, {.surface = kind, .creases = creases}), raster,
                                      {.fairness = 0, .tolerance = 1e-13, .iterations = 20000}),
                    raster);
    };
    EXPECT_LT(fitted(made.edges).max_error, 1e-6) << surface_name(kind);
    EXPECT_GT(fitted({}).max_error, 0.05) << surface_name(kind);
  }
}

Terrain randomly_creased(const Raster& raster, SurfaceKind kind, std::size_t vertices, double share,
                         test::Random& random) {
  Tin tin = refine_tin(raster, {.vertices = vertices});
  const std::size_t edges = build_edges(tin).vertices.size();
  std::vector<std::uint32_t> creases;
  for (std::uint32_t e = 0; e < edges; ++e)
    if (random.uniform(0, 1) < share) creases.push_back(e);
  return make_terrain(std::move(tin), raster, {.surface = kind, .creases = std::move(creases)});
}

TEST(CreaseFit, MinimisesTheObjectiveOfTheDenseTwin) {
  test::Random random;
  Raster raster = grid_of(29, 26, rough);
  for (const Vec2 size : {Vec2{1, 1}, Vec2{30, 20}}) {
    raster.cell_width = size.x;
    raster.cell_height = size.y;
    for (const SurfaceKind kind : kSmooth)
      for (const double share : {0.1, 0.5}) {
        const Terrain start = randomly_creased(raster, kind, 30, share, random);
        // Heights alone: a cell on a crease has two slopes.
        const Terrain fitted = fit_least_squares(
            start, raster, {.slope_weight = 0, .fairness = 0, .tolerance = 1e-13, .iterations = 20000});
        const test::FitTwin twin(start, raster, 0);
        const double best = twin.best();
        EXPECT_NEAR(twin.cost(fitted), best, 1e-5 * best) << surface_name(kind) << ' ' << share;
        EXPECT_LT(best, twin.cost(start));
      }
  }
}

TEST(CreaseFit, HeightsStayContinuousAndTheSumOfSquaresIsNoLarger) {
  test::Random random;
  const Raster raster = grid_of(50, 40, rough);
  for (const SurfaceKind kind : kSmooth)
    for (const double share : {0.05, 0.3, 1.0}) {
      const Terrain terrain =
          fit_least_squares(randomly_creased(raster, kind, 100, share, random), raster, {.slope_weight = 0});
      const Terrain smooth =
          fit_least_squares(make_terrain(terrain.tin, raster, {.surface = kind}), raster, {.slope_weight = 0});
      EXPECT_LT(assess(terrain, raster).rmse, assess(smooth, raster).rmse * 1.001);
      const EdgeTable edges = build_edges(terrain.tin);
      std::map<std::uint32_t, std::vector<double>> seen;
      std::array<TerrainPatch, 6> patches;
      for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
        triangle_patches(terrain, edges, t, patches);
        for (std::size_t k = 0; k < 3; ++k) {
          std::vector<double> along;  // ordinates on edge k
          if (kind == SurfaceKind::clough_tocher) {
            const auto& o = patches[k].ordinates;
            along = {o[0], o[1], o[3], o[6]};
          } else {
            const auto &o = patches[2 * k].ordinates, &q = patches[2 * k + 1].ordinates;
            along = {o[3], o[4], o[5], q[3], q[4], q[5]};
          }
          const auto& v = terrain.tin.triangles[t];
          if (v[(k + 1) % 3] > v[(k + 2) % 3]) std::reverse(along.begin(), along.end());
          const auto [it, fresh] = seen.try_emplace(edges.of_triangle[t][k], along);
          if (!fresh) {
            EXPECT_EQ(it->second, along);
          }
        }
      }
    }
}

TEST(CreaseFit, HeldVerticesStay) {
  test::Random random;
  const Raster raster = grid_of(40, 30, rough);
  const Terrain start = randomly_creased(raster, SurfaceKind::clough_tocher, 60, 0.4, random);
  std::vector<std::uint8_t> held(start.tin.vertex_count(), 0);
  for (std::size_t v = 0; v < held.size(); v += 3) held[v] = 1;
  const Terrain fitted = fit_least_squares(start, raster, {.held = held});
  const std::vector<std::uint32_t> vertex = sector_vertices(start.tin, start.corner_gradients, start.gradients.size());
  int moved = 0;
  for (std::size_t n = 0; n < vertex.size(); ++n) {
    if (held[vertex[n]] != 0) {
      EXPECT_EQ(fitted.gradients[n], start.gradients[n]);
    } else {
      moved += fitted.gradients[n] != start.gradients[n];
    }
  }
  for (std::size_t v = 0; v < held.size(); v += 3) EXPECT_EQ(fitted.tin.heights[v], start.tin.heights[v]);
  EXPECT_GT(moved, 30);
}

TEST(CreaseFit, TheSameFromAnyNumberOfThreads) {
  test::Random random;
  const Raster raster = grid_of(200, 180, rough);
  for (const SurfaceKind kind : kSmooth) {
    const Terrain start = randomly_creased(raster, kind, 3000, 0.2, random);
    Context one, four;
    one.threads = 1;
    four.threads = 4;
    const Terrain a = fit_least_squares(start, raster, {}, one), b = fit_least_squares(start, raster, {}, four);
    EXPECT_EQ(a.tin.heights, b.tin.heights);
    EXPECT_EQ(a.gradients, b.gradients);
  }
}

TEST(CreaseFit, RefusesHeightsOnly) {
  test::Random random;
  const Raster raster = grid_of(30, 30, rough);
  const Terrain start = randomly_creased(raster, SurfaceKind::clough_tocher, 30, 0.5, random);
  EXPECT_TRUE(test::holds(test::words_of<UsageError>([&] { fit_least_squares(start, raster, {.heights_only = true}); }),
                          "creases"));
}

}  // namespace
}  // namespace retalho
