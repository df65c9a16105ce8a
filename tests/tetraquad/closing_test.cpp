// Shapes that are said to be closed: holes of any size close, on grids and on adaptive meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/adaptive.h"
#include "retalho/tetraquad/fit.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

/// A sphere about the origin without its southern cap and a spot in the north.
PointCloud bald_sphere() {
  const PointCloud whole = test::sphere_points(8000, {0, 0, 0}, 1);
  PointCloud cloud;
  for (std::size_t k = 0; k < whole.positions.size(); ++k) {
    const Vec3 p = whole.positions[k];
    if (p.z < -0.5 || norm(p - Vec3{0, 0.6, 0.8}) < 0.35) continue;
    cloud.positions.push_back(p);
    cloud.normals.push_back(whole.normals[k]);
  }
  return cloud;
}

void expect_closed(const TetraQuad& surface, const PointCloud& cloud) {
  const TriangleMesh mesh = mesh_tetraquad(TetraQuadField(surface));
  const MeshTopology topology = topology_of(mesh);
  EXPECT_EQ(topology.open_edges, 0U);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.genus, 0);
  EXPECT_TRUE(check_mesh(mesh).watertight());
  for (const Vec3& p : mesh.positions) {
    EXPECT_LT(norm(p), 1.3);
    EXPECT_GT(norm(p), 0.3);
  }
  // Where there are points, nothing has moved.
  const TetraQuadField field(surface);
  for (std::size_t k = 0; k < cloud.positions.size(); k += 50) {
    const auto foot = field.project(cloud.positions[k]);
    ASSERT_TRUE(foot);
    EXPECT_LT(norm(foot->point - cloud.positions[k]), 2e-3);
  }
}

TEST(Closing, HolesOfAnySizeOnGrids) {
  const PointCloud cloud = bald_sphere();
  for (const int resolution : {12, 20}) {
    TetraQuadFitReport report;
    fit_tetraquad(cloud, {.resolution = resolution}, &report);
    EXPECT_GT(report.open_faces, 0U);  // without the word the borders stay
    for (const TetSplit split : {TetSplit::five, TetSplit::kuhn}) {
      const TetraQuad surface = fit_tetraquad(
          cloud, {.resolution = resolution, .split = split, .closed = true, .solver = TetraQuadSolver::cg}, &report);
      EXPECT_EQ(report.open_faces, 0U);
      expect_closed(surface, cloud);
    }
  }
}

TEST(Closing, HolesOfAnySizeOnAdaptiveMeshes) {
  const PointCloud cloud = bald_sphere();
  TetraQuadFitReport report;
  fit_tetraquad_adaptive(cloud, {.coefficients = 6000}, {.smoothness = 0.1}, &report);
  EXPECT_GT(report.open_faces, 0U);
  const TetraQuad surface =
      fit_tetraquad_adaptive(cloud, {.coefficients = 6000}, {.smoothness = 0.1, .closed = true}, &report);
  EXPECT_EQ(report.open_faces, 0U);
  expect_closed(surface, cloud);
}

TEST(Closing, AnOpenScanOfAClosedShape) {
  RETALHO_DATA_FILE(points, "points/hand.xyz");
  TetraQuadFitReport report;
  const TetraQuad surface =
      fit_tetraquad(read_points(points), {.resolution = 24, .closed = true, .solver = TetraQuadSolver::cg}, &report);
  EXPECT_EQ(report.open_faces, 0U);
  EXPECT_EQ(topology_of(mesh_tetraquad(TetraQuadField(surface))).open_edges, 0U);
}

TEST(Closing, ScansOfShapesThatAreOpen) {
  // A leg cut off at both ends, with holes and normals turned the wrong way; a house without a floor.
  for (const std::string name : {"points/scanned_leg.ply", "points/building.ply"}) {
    RETALHO_DATA_FILE(points, name);
    TetraQuadFitReport report;
    TetraQuadFitOptions options{.resolution = 16, .solver = TetraQuadSolver::cg};
    const PointCloud cloud = read_points(points);
    fit_tetraquad(cloud, options, &report);
    EXPECT_GT(report.open_faces, 100U) << name;
    options.closed = true;
    const TetraQuad surface = fit_tetraquad(cloud, options, &report);
    EXPECT_EQ(report.open_faces, 0U) << name;
    EXPECT_EQ(topology_of(mesh_tetraquad(TetraQuadField(surface))).open_edges, 0U) << name;
  }
}

}  // namespace
}  // namespace retalho
