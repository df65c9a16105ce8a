// The picture's level of detail (viewer/detail.h): no cracks between levels, finer where the eye is near, within the
// budget.
#include "viewer/detail.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"
#include "support/support.h"

namespace retalho::viewer {
namespace {

Raster waves(int columns, int rows, bool hole) {
  Raster raster;
  raster.columns = columns;
  raster.rows = rows;
  raster.cell_width = raster.cell_height = 10;
  std::vector<float> heights;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const bool empty = hole && std::hypot(c - columns / 2, r - rows / 2) < 9;
      heights.push_back(empty ? std::nanf("")
                              : static_cast<float>(200 + 60 * std::sin(c * 0.11) * std::cos(r * 0.07) + 0.2 * c));
    }
  raster.heights = std::move(heights);
  return raster;
}

struct Made {
  explicit Made(SurfaceKind kind, bool hole = false)
      : terrain(make_terrain(refine_tin(waves(120, 90, hole), {4, 0}), waves(120, 90, hole), {.surface = kind})),
        evaluator(terrain),
        bends(measure_bends(evaluator)) {}
  Terrain terrain;
  TerrainEvaluator evaluator;
  SurfaceBends bends;
};

constexpr SurfaceKind kKinds[] = {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher};

double area_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    EXPECT_GE(twice, -1e-9) << "a triangle is turned over";
    sum += twice / 2;
  }
  return sum;
}

TEST(Detail, LevelsMeetWithoutCracksAndCoverTheTerrain) {
  for (const SurfaceKind kind : kKinds)
    for (const bool hole : {false, true}) {
      const Made made(kind, hole);
      for (const Vec3 eye : {Vec3{300, -200, 320}, Vec3{1180, -880, 205}, Vec3{600, -450, 5000}, Vec3{0, 0, 200}}) {
        DetailNotes notes;
        const TriangleMesh mesh =
            detail_mesh(made.evaluator, made.bends, {.eye = eye, .angle = 5e-4, .budget = 60'000}, &notes);
        EXPECT_LE(mesh.triangles.size(), 60'000U);
        for (const Vec3 p : mesh.positions) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
        const double covered = area_of(mesh);
        if (!hole) {
          const MeshCheck check = check_mesh(mesh);
          EXPECT_EQ(check.cracks, 0U) << surface_name(kind);
          EXPECT_EQ(check.nonmanifold_edges, 0U);
          EXPECT_EQ(check.components, 1U);
          EXPECT_NEAR(covered, 1190.0 * 890.0, 1e-6 * covered);
        }
        if (kind == SurfaceKind::linear) {
          EXPECT_EQ(notes.finest, 1);
        }
      }
    }
}

TEST(Detail, VerticesLieOnTheSurfaceAndNearOnesAreCloser) {
  const Made made(SurfaceKind::clough_tocher);
  const Vec3 eye{150, -150, 330};
  const double angle = 4e-4;
  DetailNotes notes;
  const TriangleMesh mesh =
      detail_mesh(made.evaluator, made.bends, {.eye = eye, .angle = angle, .budget = 4'000'000}, &notes);
  EXPECT_EQ(notes.angle, angle);
  EXPECT_GE(notes.finest, 8);
  for (const Vec3 p : mesh.positions) EXPECT_NEAR(p.z, made.evaluator.value({p.x, p.y}), 1e-6);
  // Each triangle's error at its middle is within what its distance allows; beside a coarser edge, whose vertices lie
  // farther apart than its own, a little beyond.
  std::size_t beyond = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 middle = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
    const double error = std::abs(middle.z - made.evaluator.value({middle.x, middle.y}));
    const double distance = norm(middle - eye);
    EXPECT_LE(error, 2 * angle * distance) << distance;
    beyond += error > angle * distance ? 1U : 0U;
  }
  EXPECT_LE(beyond, mesh.triangles.size() / 1000);
}

TEST(Detail, TheBudgetGoesWhereTheEyeIs) {
  const Made made(SurfaceKind::clough_tocher);
  const auto west = [&](double x) {
    const TriangleMesh mesh =
        detail_mesh(made.evaluator, made.bends, {.eye = {x, -450, 300}, .angle = 1e-7, .budget = 20'000});
    EXPECT_GT(mesh.triangles.size(), 10'000U);
    return std::count_if(mesh.triangles.begin(), mesh.triangles.end(), [&](const std::array<std::uint32_t, 3>& t) {
      return mesh.positions[t[0]].x < 400 && mesh.positions[t[1]].x < 400 && mesh.positions[t[2]].x < 400;
    });
  };
  EXPECT_GT(west(-100), 4 * west(1300));
}

TEST(Detail, WhatLiesBehindIsCoarseAndStillMeetsTheRest) {
  const Made made(SurfaceKind::clough_tocher);
  const auto looking = [&](Vec3 forward) {
    return detail_mesh(made.evaluator, made.bends,
                       {.eye = {595, -445, 300}, .forward = forward, .angle = 4e-4, .budget = 4'000'000});
  };
  const auto east = [](const TriangleMesh& mesh) {
    return std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                         [&](const std::array<std::uint32_t, 3>& t) { return mesh.positions[t[0]].x > 800; });
  };
  const TriangleMesh all = looking({}), west = looking({-1, 0, 0}), ahead = looking({1, 0, 0});
  EXPECT_EQ(check_mesh(west).cracks, 0U);
  EXPECT_EQ(east(ahead), east(all));
  EXPECT_LT(4 * east(west), east(all));
}

TEST(Detail, KeepsToTheBudgetAndNeverGoesBelowTheTriangulation) {
  const Made made(SurfaceKind::clough_tocher);
  const std::size_t least = made.terrain.tin.triangle_count();
  std::size_t before = 0;
  for (const std::size_t budget : {least / 2, 2 * least, 8 * least, 40 * least}) {
    DetailNotes notes;
    const TriangleMesh mesh =
        detail_mesh(made.evaluator, made.bends, {.eye = {600, -1200, 500}, .angle = 1e-7, .budget = budget}, &notes);
    EXPECT_LE(mesh.triangles.size(), std::max(budget, least));
    EXPECT_GE(mesh.triangles.size(), std::max(least, before));
    EXPECT_GE(mesh.triangles.size(), std::min(budget, 40 * least) / 4) << "the budget is used";
    before = mesh.triangles.size();
  }
}

TEST(Detail, APictureThatIsStretchedAsksForMore) {
  const Made made(SurfaceKind::powell_sabin);
  const auto count = [&](double stretch) {
    return detail_mesh(made.evaluator, made.bends,
                       {.eye = {600, -1200, 800}, .stretch = stretch, .angle = 2e-3, .budget = 4'000'000})
        .triangles.size();
  };
  EXPECT_GT(count(4), count(1));
}

}  // namespace
}  // namespace retalho::viewer
