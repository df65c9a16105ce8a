// check_mesh: what is a border, what is a crack, what is not a surface.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "retalho/core/error.h"
#include "sample_mesh.h"

namespace retalho {
namespace {

using test::sheet;

TEST(MeshCheck, ASheetHasABorderAndNoCracks) {
  const MeshCheck check = check_mesh(test::wavy_sheet());
  EXPECT_EQ(check.open_edges, 20U);
  EXPECT_EQ(check.boundary_edges, 20U);
  EXPECT_EQ(check.cracks, 0U);
  EXPECT_EQ(check.nonmanifold_edges, 0U);
  EXPECT_EQ(check.degenerate_triangles, 0U);
  EXPECT_EQ(check.components, 1U);
  EXPECT_TRUE(check.watertight());
}

TEST(MeshCheck, AClosedShapeHasNoOpenEdge) {
  const MeshCheck check = check_mesh(test::tetrahedron());
  EXPECT_EQ(check.open_edges, 0U);
  EXPECT_TRUE(check.watertight());
}

TEST(MeshCheck, TwoVerticesAtOnePlaceAreACrack) {
  TriangleMesh mesh = test::wavy_sheet();
  // The inner edge between the two triangles of the first cell, from vertex 0 to vertex 8: its ends once more.
  mesh.positions.push_back(mesh.positions[0]);
  mesh.positions.push_back(mesh.positions[8]);
  mesh.triangles[0] = {35, 1, 36};
  const MeshCheck check = check_mesh(mesh);
  EXPECT_FALSE(check.watertight());
  EXPECT_EQ(check.cracks, 4U) << "the diagonal, and the cell's side to its neighbour";
}

TEST(MeshCheck, AVertexOnlyOneSideHasIsACrackAtAnyHeight) {
  for (const double lift : {0.0, 1e-3, 5.0}) {
    TriangleMesh mesh = test::wavy_sheet();
    const Vec3 middle = 0.5 * (mesh.positions[0] + mesh.positions[8]) + Vec3{0, 0, lift};
    const auto m = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(middle);
    mesh.triangles[0] = {0, 1, m};
    mesh.triangles.push_back({1, 8, m});
    const MeshCheck check = check_mesh(mesh);
    EXPECT_EQ(check.cracks, 3U) << lift;
    EXPECT_EQ(check.boundary_edges, 20U);
    EXPECT_FALSE(check.watertight());
  }
}

TEST(MeshCheck, AMissingTriangleIsAHoleAndNotACrack) {
  TriangleMesh mesh = test::wavy_sheet();
  mesh.triangles.erase(mesh.triangles.begin() + 17);
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.boundary_edges, 23U);
  EXPECT_EQ(check.cracks, 0U);
}

TEST(MeshCheck, FindsWhatIsNoSurface) {
  TriangleMesh turned = test::wavy_sheet();
  std::swap(turned.triangles[9][0], turned.triangles[9][1]);
  EXPECT_EQ(check_mesh(turned).nonmanifold_edges, 3U);
  TriangleMesh fin = test::tetrahedron();
  fin.positions.push_back({2, 2, 2});
  fin.triangles.push_back({0, 1, 4});
  EXPECT_EQ(check_mesh(fin).nonmanifold_edges, 1U);
  TriangleMesh flat = test::tetrahedron();
  flat.positions[3] = flat.positions[1];
  EXPECT_EQ(check_mesh(flat).degenerate_triangles, 2U);
  TriangleMesh wild = test::tetrahedron();
  wild.triangles[2][1] = 4;
  EXPECT_THROW(check_mesh(wild), BadInput);
}

TEST(MeshCheck, CountsPartsThatShareNoVertex) {
  TriangleMesh two = test::tetrahedron();
  const TriangleMesh other = test::tetrahedron();
  for (const Vec3& p : other.positions) two.positions.push_back(p + Vec3{5, 0, 0});
  for (const auto& v : other.triangles) two.triangles.push_back({v[0] + 4, v[1] + 4, v[2] + 4});
  two.positions.push_back({9, 9, 9});
  EXPECT_EQ(check_mesh(two).components, 2U);
}

RC_GTEST_PROP(MeshCheckProperty, CutsAlongRandomInnerEdgesAreAllFound, ()) {
  // Take a random share of the triangles off the sheet by giving them vertices of their own. An obvious twin counts.
  const auto n = static_cast<std::uint32_t>(*rc::gen::inRange(3, 15));
  TriangleMesh mesh = sheet(n, n, [](double x, double y) { return x * y; });
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  const std::vector<Vec3> original = mesh.positions;
  std::vector<std::uint32_t> place(original.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) place[i] = i;
  for (auto& v : mesh.triangles)
    if (random() % 4 == 0)
      for (auto& k : v) {
        place.push_back(k);
        mesh.positions.push_back(original[k]);
        k = static_cast<std::uint32_t>(mesh.positions.size()) - 1;
      }
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides, joined;
  for (const auto& v : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      ++sides[std::minmax(a, b)];
      ++joined[std::minmax(place[a], place[b])];
    }
  std::size_t open = 0, cracks = 0;
  for (const auto& [side, count] : sides)
    if (count == 1) ++open, cracks += joined[std::minmax(place[side.first], place[side.second])] == 2;
  const MeshCheck check = check_mesh(mesh);
  RC_ASSERT(check.open_edges == open);
  RC_ASSERT(check.cracks == cracks);
  RC_CLASSIFY(cracks > 0, "with cracks");
}

}  // namespace
}  // namespace retalho
