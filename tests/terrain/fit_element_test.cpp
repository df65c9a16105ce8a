// The parts of the least-squares fit: each cell belongs to one triangle, bending is exact, errors are those of the
// evaluator.
#include "retalho/terrain/fit_element.h"

#include <gtest/gtest.h>

#include <random>

#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"
#include "support/grids.h"

namespace retalho {
namespace {

FitTriangle triangle_of(const Terrain& terrain, const EdgeTable& edges, std::uint32_t t, const Raster& raster,
                        const FitGrid& grid) {
  FitTriangle result;
  result.vertex = terrain.tin.triangles[t];
  for (std::size_t k = 0; k < 3; ++k) {
    result.at[k] = cell_coordinates(terrain.tin.points[result.vertex[k]], raster);
    result.corner[k] = grid.place(result.at[k]);
    if (!terrain.edge_split.empty()) result.split[k] = terrain.edge_split[edges.of_triangle[t][k]];
  }
  return result;
}

Raster rough_grid(int columns, int rows, bool voids) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 100);
  Raster raster = test::make_grid<double>(columns, rows, [&](int x, int y) {
    const double z = unit(random);
    return voids && (x + y < 9 || (x - 20) * (x - 20) + (y - 15) * (y - 15) < 40) ? std::nan("") : z;
  });
  raster.cell_width = 3;
  raster.cell_height = 2;
  return raster;
}

TEST(FitElement, EveryCellBelongsToOneTriangleAndHasTheEvaluatorsError) {
  for (const bool voids : {false, true})
    for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
      const Raster raster = rough_grid(41, 33, voids);
      const Terrain terrain = make_terrain(refine_tin(raster, {.vertices = 70}), raster, {.surface = kind});
      const FitGrid grid(raster, {});
      const EdgeTable edges = build_edges(terrain.tin);
      const TerrainEvaluator evaluator(terrain);
      const FitTriangle first = triangle_of(terrain, edges, 0, raster, grid);
      const Vec2 inside = (first.at[0] + first.at[1] + first.at[2]) / 3;
      std::vector<int> count(raster.cells(), 0);
      for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
        CornerData data;
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint32_t v = terrain.tin.triangles[t][k];
          const Vec2 g = terrain.gradients.empty() ? Vec2{} : terrain.gradients[v] * grid.unit;
          data[k] = {terrain.tin.heights[v] - grid.reference, g.x, g.y};
        }
        each_error(kind, triangle_of(terrain, edges, t, raster, grid), data, grid, inside,
                   [&](std::size_t cell, double error) {
                     ++count[cell];
                     const int c = static_cast<int>(cell) % raster.columns, r = static_cast<int>(cell) / raster.columns;
                     EXPECT_NEAR(error, evaluator.value(raster.centre(c, r)) - raster.at(c, r), 1e-8);
                   });
      }
      for (std::size_t cell = 0; cell < count.size(); ++cell)
        EXPECT_EQ(count[cell], std::isnan(raster.at(cell)) ? 0 : 1);
    }
}

TEST(FitElement, BendingOfAQuadraticIsExact) {
  const Raster nothing = test::make_grid<double>(30, 30, [](int, int) { return std::nan(""); });
  const FitGrid grid(nothing, {});
  FitTriangle t;
  t.vertex = {4, 2, 9};
  t.at = {Vec2{2, -20}, Vec2{25, -17}, Vec2{9, -3}};
  t.corner = t.at;
  t.split = {0.4, 0.45, 0.6};
  const double xx = 0.7, xy = -0.3, yy = 1.1;  // second derivatives
  CornerData data;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 p = t.corner[k];
    data[k] = {5 + 2 * p.x - p.y + xx / 2 * p.x * p.x + xy * p.x * p.y + yy / 2 * p.y * p.y, 2 + xx * p.x + xy * p.y,
               -1 + xy * p.x + yy * p.y};
  }
  const double area = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]) / 2;
  const double expected = area * (xx * xx + 2 * xy * xy + yy * yy);
  for (const SurfaceKind kind : {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
    const FitElement element = fit_element(kind, t, grid, {.slope = 0.1, .fairness = 1, .inside = {12, -13}});
    EXPECT_NEAR(element_cost(kind, element, data), expected, 1e-7 * expected) << surface_name(kind);
  }
}

}  // namespace
}  // namespace retalho
