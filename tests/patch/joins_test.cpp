// Several patches: shared sides are watertight and told with their angle; refined meshes lie on the surface; reports.
#include <gtest/gtest.h>

#include "patch/comparison.h"
#include "patch/support.h"
#include "retalho/core/error.h"
#include "retalho/mesh/patch_mesh.h"
#include "retalho/patch/document.h"
#include "retalho/patch/joins.h"
#include "retalho/patch/report.h"
#include "support/paths.h"
#include "support/support.h"

namespace retalho::test {
namespace {

std::vector<Patch> example(const std::string& name, std::array<std::size_t, 3> divisions = {16, 16, 16}) {
  std::vector<Patch> patches;
  for (const PatchSpec& spec : read_patches(source_folder() + "/examples/patches/" + name + ".json"))
    patches.push_back(make_patch(join_sides(spec.sides), {.divisions = divisions}));
  return patches;
}

std::vector<PatchSurface> surfaces_of(const std::vector<Patch>& patches) {
  std::vector<PatchSurface> surfaces;
  surfaces.reserve(patches.size());
  for (const Patch& patch : patches) surfaces.emplace_back(patch);
  return surfaces;
}

TEST(Joins, OfTheHullAreWatertightAtEveryFineness) {
  const std::vector<Patch> patches = example("hull");
  const auto surfaces = surfaces_of(patches);
  const auto joins = find_joins(patches, surfaces);
  ASSERT_EQ(joins.size(), 4U);
  for (const PatchJoin& join : joins) {
    EXPECT_TRUE(join.watertight);
    EXPECT_FALSE(join.g1);
    EXPECT_LE(join.gap, 1e-13);
    EXPECT_GT(join.degrees, 1);
  }
  for (const std::size_t factor : {1U, 2U, 5U}) {
    std::vector<Patch> fine;
    for (std::size_t i = 0; i < patches.size(); ++i) fine.push_back(refine(patches[i], surfaces[i], factor));
    const MeshCheck check = check_mesh(mesh_patches(fine));
    EXPECT_EQ(check.components, 1U);
    EXPECT_EQ(check.nonmanifold_edges, 0U);
    EXPECT_EQ(check.open_edges, 4 * 16 * factor);  // two sheers and two frames
  }
}

TEST(Joins, FlatNeighboursAreG1) {
  const std::vector<Vec3> diagonal = {{1, 0, 0}, {0.7, 0.5, 0}, {0, 1, 0}};
  const auto line = [](Vec3 a, Vec3 b) { return bezier_side({a, b}); };
  const Curve curve = make_bezier(diagonal, 2, 3);
  std::vector<Patch> patches;
  patches.push_back(make_patch({SideCurve(curve), line({0, 1, 0}, {0, 0, 0}), line({0, 0, 0}, {1, 0, 0})}));
  patches.push_back(make_patch({SideCurve(curve, true), line({1, 0, 0}, {1, 1, 0}), line({1, 1, 0}, {0, 1, 0})}));
  const auto surfaces = surfaces_of(patches);
  const auto joins = find_joins(patches, surfaces);
  ASSERT_EQ(joins.size(), 1U);
  EXPECT_TRUE(joins[0].watertight && joins[0].g1);
  EXPECT_LE(joins[0].degrees, 1e-6);
  // Other divisions: the same curve, but not the same nodes.
  patches[1] = make_patch(patches[1].sides, {.divisions = {9, 9, 9}});
  const auto others = surfaces_of(patches);
  EXPECT_FALSE(find_joins(patches, others)[0].watertight);
}

TEST(Refine, NodesLieOnTheSurfaceAndOnTheSides) {
  for (const Recovery recovery : {Recovery::barycentric, Recovery::spr, Recovery::smooth}) {
    const Patch patch = natural_patch(sine, irregular_domain(9, 2), recovery);
    const PatchSurface surface(patch);
    const Patch fine = refine(patch, surface, 3);
    EXPECT_EQ(fine.domain.triangles.size(), 9 * patch.domain.triangles.size());
    double area = 0;
    for (const auto& t : fine.domain.triangles) {
      const Vec2 a = fine.domain.parameters[t[0]], b = fine.domain.parameters[t[1]], c = fine.domain.parameters[t[2]];
      EXPECT_GT(cross(b - a, c - a), 0);
      area += cross(b - a, c - a);
    }
    EXPECT_NEAR(area, 1, 1e-12);
    for (std::size_t side = 0; side < 3; ++side) {
      EXPECT_EQ(fine.domain.sides[side].size(), 3 * (patch.domain.sides[side].size() - 1) + 1);
      for (const std::uint32_t v : fine.domain.sides[side]) {
        const double s = side_argument(static_cast<int>(side), fine.domain.parameters[v]);
        EXPECT_LE(norm(fine.positions[v] - patch.sides[side].point(s)), 1e-12);
      }
    }
    if (recovery != Recovery::smooth) continue;
    for (std::size_t i = 0; i < fine.positions.size(); ++i)
      EXPECT_LE(norm(fine.positions[i] - surface.point(fine.domain.parameters[i])), 1e-12);
  }
  const Patch patch = make_patch(bent_triangle(0.1));
  EXPECT_THROW(refine(patch, PatchSurface(patch), 0), UsageError);
}

TEST(Report, AgreesWithTheTestsOwnMeasures) {
  const Patch patch = natural_patch(octant, irregular_domain(20, 2), Recovery::spr);
  const PatchSurface surface(patch);
  const PatchReport report = assess(patch, surface);
  EXPECT_EQ(report.boundary_gap, side_gap(patch, surface));
  EXPECT_GT(report.gradient_jump, 0.1 * gradient_jump(patch, surface));
  EXPECT_LT(report.gradient_jump, gradient_jump(patch, surface));
  EXPECT_EQ(report.folds.folds, 0U);
  const PatchReport smooth =
      assess(patch, PatchSurface(natural_patch(octant, irregular_domain(20, 2), Recovery::smooth)));
  EXPECT_LE(smooth.boundary_gap, 1e-14);
  EXPECT_LE(smooth.gradient_jump, 1e-11);
  EXPECT_EQ(smooth.turned, 0U);
  EXPECT_GT(assess(make_patch(bent_triangle(0.6)), PatchSurface(make_patch(bent_triangle(0.6)))).folds.folds, 0U);
}

TEST(Examples, HaveNoFoldsAndExactSides) {
  for (const char* name : {"octant", "saddle", "hull", "blade"})
    for (const Patch& patch : example(name)) {
      const PatchReport report = assess(patch, PatchSurface(patch));
      EXPECT_EQ(report.folds.folds, 0U) << name;
      EXPECT_EQ(report.turned, 0U) << name;
      EXPECT_LE(report.boundary_gap, 1e-14 * control_size(patch.positions)) << name;
      EXPECT_LE(report.gradient_jump, 1e-11) << name;
    }
}

}  // namespace
}  // namespace retalho::test
