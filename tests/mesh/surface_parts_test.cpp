// Parts of a surface: counted, told from noise by the points near them, left out of triangles and of models.
#include "retalho/mesh/surface_parts.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "retalho/core/error.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/adaptive.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/without.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

void append(PointCloud& cloud, const PointCloud& more) {
  cloud.positions.insert(cloud.positions.end(), more.positions.begin(), more.positions.end());
  cloud.normals.insert(cloud.normals.end(), more.normals.begin(), more.normals.end());
}

/// A ball with 3000 points, one with 500 and one with 60.
PointCloud three_balls() {
  PointCloud cloud = test::sphere_points(60, {1.3, 1.3, 0}, 0.15);
  append(cloud, test::sphere_points(3000, {0, 0, 0}, 0.5));
  append(cloud, test::sphere_points(500, {1.3, 0, 0}, 0.3));
  return cloud;
}

struct Made {
  explicit Made(TetraQuad fitted) : surface(std::move(fitted)), field(surface), mesh(mesh_tetraquad(field)) {}
  TetraQuad surface;
  TetraQuadField field;
  TriangleMesh mesh;
};

TEST(SurfaceParts, AreCountedWithTheirPoints) {
  PointCloud cloud = three_balls();
  cloud.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  cloud.normals.push_back({0, 0, 1});
  const Made made(fit_tetraquad(cloud, {.resolution = 14}));
  const SurfaceParts found = find_parts(made.mesh, made.field, cloud);
  ASSERT_EQ(found.parts.size(), 3U);
  EXPECT_EQ(topology_of(made.mesh).components, 3U);
  // A foot in the tip of a tetrahedron that no triangle has its middle in counts for none, nor does what is not finite.
  EXPECT_NEAR(static_cast<double>(found.parts[0].points), 2997, 3);
  EXPECT_NEAR(static_cast<double>(found.parts[1].points), 498, 2);
  EXPECT_NEAR(static_cast<double>(found.parts[2].points), 59, 1);
  EXPECT_NEAR(found.parts[0].area, 4 * std::numbers::pi * 0.25, 0.03);
  EXPECT_NEAR(found.parts[1].area, 4 * std::numbers::pi * 0.09, 0.03);
  EXPECT_LT(norm(found.parts[0].low - Vec3{-0.5, -0.5, -0.5}), 0.02);
  EXPECT_LT(norm(found.parts[1].high - Vec3{1.6, 0.3, 0.3}), 0.02);
  std::vector<std::size_t> triangles(3, 0);
  for (const std::uint32_t part : found.of_triangle) ++triangles.at(part);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(triangles[n], found.parts[n].triangles);
  for (const int threads : {1, 5}) {
    Context context;
    context.threads = threads;
    const SurfaceParts again = find_parts(made.mesh, made.field, cloud, context);
    EXPECT_EQ(again.of_triangle, found.of_triangle);
    for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(again.parts[n].points, found.parts[n].points);
  }
}

TEST(SurfaceParts, LeaveTrianglesAndModelsWithoutOpeningWhatStays) {
  const PointCloud cloud = three_balls();
  const TetraQuadFitOptions options{.resolution = 14, .smoothness = 0.1};
  for (const bool is_adaptive : {false, true}) {
    TetraQuadFitReport report;
    const Made made(is_adaptive ? fit_tetraquad_adaptive(cloud, {.coefficients = 6000}, options, &report)
                                : fit_tetraquad(cloud, options, &report));
    const SurfaceParts found = find_parts(made.mesh, made.field, cloud);
    ASSERT_EQ(found.parts.size(), 3U) << is_adaptive;
    for (const std::vector<char>& wanted : {std::vector<char>{1, 0, 0}, {0, 1, 1}, {1, 1, 1}}) {
      const auto count = static_cast<std::size_t>(std::count(wanted.begin(), wanted.end(), 1));
      const TriangleMesh triangles = keep_parts(made.mesh, found, wanted);
      EXPECT_EQ(topology_of(triangles).components, count);
      EXPECT_EQ(topology_of(triangles).open_edges, 0U);
      EXPECT_EQ(triangles.normals.size(), triangles.positions.size());
      EXPECT_EQ(check_mesh(triangles).degenerate_triangles, 0U);
      std::vector<char> keep = wanted;
      const std::vector<char> left_out = tetrahedra_left_out(made.mesh, made.field, found, keep);
      EXPECT_EQ(keep, wanted);  // the balls share no tetrahedron
      const std::size_t before = report.coefficients;
      TetraQuadFitReport sizes = report;
      const TetraQuad rest = without_tetrahedra(made.surface, left_out, &sizes);
      const TriangleMesh again = mesh_tetraquad(TetraQuadField(rest));
      EXPECT_EQ(again.positions.size(), triangles.positions.size());
      EXPECT_EQ(topology_of(again).components, count);
      EXPECT_EQ(topology_of(again).open_edges, 0U);
      EXPECT_EQ(sizes.coefficients == before, count == 3);
      EXPECT_LE(sizes.coefficients, before);
      EXPECT_EQ(sizes.tetrahedra, rest.mesh.tets.size());
    }
  }
}

TEST(SurfaceParts, ThatShareATetrahedronStayTogetherInModels) {
  // Two sheets of one quadric through the same tetrahedron: (z - 0.4)(z - 0.6) = 0.
  std::vector<TetPlace> places;
  places.reserve(6);
  for (int t = 0; t < tets_of_cube(TetSplit::kuhn); ++t) places.push_back({{0, 0, 0}, static_cast<std::uint8_t>(t)});
  const Made made(quasi_interpolant(make_tet_mesh({0, 0, 0}, 1, TetSplit::kuhn, places), [](Vec3 p) {
    Jet3 jet;
    jet.value = (p.z - 0.4) * (p.z - 0.6);
    jet.gradient = {0, 0, 2 * p.z - 1};
    jet.hessian = {0, 0, 2, 0, 0, 0};
    return jet;
  }));
  const TriangleMesh fine = mesh_tetraquad(made.field, {.divisions = 10});
  PointCloud cloud;
  for (int n = 1; n < 10; ++n) cloud.positions.push_back({0.1 * n, 0.55 - 0.05 * n, n < 8 ? 0.61 : 0.38});
  const SurfaceParts found = find_parts(fine, made.field, cloud);
  ASSERT_EQ(found.parts.size(), 2U);
  EXPECT_EQ(found.parts[0].points, 7U);
  EXPECT_EQ(found.parts[1].points, 2U);
  EXPECT_NEAR(found.parts[0].low.z, 0.6, 1e-6);
  std::vector<char> keep = {1, 0};
  for (const Vec3& p : keep_parts(fine, found, keep).positions) EXPECT_NEAR(p.z, 0.6, 1e-6);
  const std::vector<char> left_out = tetrahedra_left_out(fine, made.field, found, keep);
  EXPECT_EQ(keep, (std::vector<char>{1, 1}));
  EXPECT_EQ(std::count(left_out.begin(), left_out.end(), 1), 0);
}

TEST(SurfaceParts, AreChosenByNumberAndByPoints) {
  SurfaceParts found;
  for (const std::size_t points : {900U, 80U, 80U, 3U}) found.parts.emplace_back().points = points;
  EXPECT_EQ(choose_parts(found, {}), (std::vector<char>{1, 1, 1, 1}));
  EXPECT_EQ(choose_parts(found, {.most = 2}), (std::vector<char>{1, 1, 0, 0}));
  EXPECT_EQ(choose_parts(found, {.points = 80}), (std::vector<char>{1, 1, 1, 0}));
  EXPECT_EQ(choose_parts(found, {.most = 2, .points = 81}), (std::vector<char>{1, 0, 0, 0}));
  EXPECT_TRUE(choose_parts({}, {.most = 2, .points = 81}).empty());
  EXPECT_THROW(choose_parts(found, {.most = 0}), UsageError);
  EXPECT_THROW(choose_parts(found, {.points = 901}), UsageError);
}

TEST(SurfaceParts, OfAScanWithHoles) {
  RETALHO_DATA_FILE(path, "points/hand.xyz");
  const PointCloud cloud = read_points(path);
  const Made made(fit_tetraquad(cloud, {.resolution = 48, .closed = true, .solver = TetraQuadSolver::cg}));
  const SurfaceParts found = find_parts(made.mesh, made.field, cloud);
  ASSERT_GT(found.parts.size(), 1U);
  EXPECT_GT(found.parts[0].points, 99 * cloud.positions.size() / 100);
  std::vector<char> keep(found.parts.size(), 0);
  keep[0] = 1;
  const MeshTopology topology = topology_of(keep_parts(made.mesh, found, keep));
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.open_edges, 0U);
  const std::vector<char> left_out = tetrahedra_left_out(made.mesh, made.field, found, keep);
  const MeshTopology model = topology_of(mesh_tetraquad(TetraQuadField(without_tetrahedra(made.surface, left_out))));
  EXPECT_EQ(model.components, static_cast<std::size_t>(std::count(keep.begin(), keep.end(), 1)));
  EXPECT_EQ(model.open_edges, 0U);
}

}  // namespace
}  // namespace retalho
