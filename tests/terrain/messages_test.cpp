// What the calls of the room refuse, in its own words: those that no command line can ask for.
#include <gtest/gtest.h>

#include "retalho/core/error.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/point_report.h"
#include "retalho/terrain/report.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tin/refine.h"
#include "support/errors.h"
#include "support/grids.h"
#include "support/sample_terrain.h"

namespace retalho::test {
namespace {

TEST(TerrainMessages, AreThese) {
  const Terrain terrain = sample_terrain({});
  const TerrainEvaluator evaluator(terrain);
  const std::vector<Vec2> two{{0, 0}, {1, 0}};
  std::vector<double> one(1);
  const auto with = [&](SurfaceOptions options) { make_terrain(terrain.tin, Georef{}, options); };
  expect_refused<UsageError>({
      {"values: 2 points, but room for 1 heights", [&] { evaluator.values(two, one); }},
      {"a clough-tocher surface needs gradients: normals, quadratic, network or given",
       [&] { with({.gradients = GradientKind::none}); }},
      {"crease 999 is no edge: the triangulation has ", [&] { with({.creases = {999}}); }},
      {"gradients are to be given, but none were", [&] { with({.gradients = GradientKind::given}); }},
      {"2 gradients for 20 vertices", [&] { with({.gradients = GradientKind::given, .given = two}); }},
      {"relocations and exchanges must be 0 or more",
       [] { refine_surface(make_grid(4, 4, [](int x, int y) { return x * y; }), {.vertices = 9, .relocations = -1}); }},
  });
  const Raster grid = make_grid(6, 5, [](int x, int y) { return x * x + y; });
  const Raster other = make_grid(7, 5, [](int x, int y) { return x * x + y; });
  const std::vector<Vec3> far{{1e6, 1e6, 0}};
  expect_refused<BadInput>({
      {"a surface on 6 x 5 cells cannot be fitted to a grid of 7 x 5",
       [&] { fit_least_squares(make_terrain(refine_tin(grid, {.max_error = 1}), grid), other); }},
      {"the model covers none of the points", [&] { assess_points(terrain, far); }},
      {"the grid has no cells", [&] { assess(terrain, Raster{}); }},
  });
}

}  // namespace
}  // namespace retalho::test
