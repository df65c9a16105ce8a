// Fitting: exact shapes come back, bad input is refused, the solver against a dense twin, and real points.
#include "retalho/tetraquad/fit.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/block_matrix.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

using test::sphere_points;
using test::torus_points;

class FitOnSplits : public testing::TestWithParam<TetSplit> {};
INSTANTIATE_TEST_SUITE_P(Both, FitOnSplits, testing::Values(TetSplit::five, TetSplit::kuhn));

TEST_P(FitOnSplits, ASphereComesBackWithoutAnExtraSheet) {
  // |p|^2 is a quadric: with gradients 2 p / 2 r as normals, the sphere is in the space, though its distance is not.
  const PointCloud cloud = sphere_points(4000, {3, -2, 1}, 0.5);
  TetraQuadFitReport report;
  const TetraQuad surface = fit_tetraquad(cloud, {.resolution = 6, .split = GetParam(), .bending = 0}, &report);
  EXPECT_LT(report.residual_max, 1e-6 * surface.mesh.step);
  EXPECT_TRUE(report.warnings.empty());
  const TetraQuadField field(surface);
  const TriangleMesh mesh = mesh_tetraquad(field, {.divisions = 3});
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(norm(p - Vec3{3, -2, 1}), 0.5, 1e-6);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_GT(dot(mesh.normals[v], normalized(mesh.positions[v] - Vec3{3, -2, 1})), 1 - 1e-6);
  const MeshTopology topology = topology_of(mesh);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.open_edges, 0U);
  EXPECT_EQ(topology.genus, 0);
  EXPECT_TRUE(check_mesh(mesh).watertight());
}

TEST(Fit, ATorusIsClosedOfGenusOneAndOfFourthOrder) {
  std::array<double, 2> mean{};
  for (const std::size_t round : {0U, 1U}) {
    const TetraQuad surface = fit_tetraquad(torus_points(20000, 1), {.resolution = round == 0 ? 8 : 16, .bending = 0});
    const TetraQuadField field(surface);
    const TriangleMesh mesh = mesh_tetraquad(field, {.divisions = 2});
    const MeshTopology topology = topology_of(mesh);
    EXPECT_EQ(topology.components, 1U);
    EXPECT_EQ(topology.open_edges, 0U);
    EXPECT_EQ(topology.genus, 1);
    EXPECT_TRUE(check_mesh(mesh).watertight());
    const PointCloud held_out = torus_points(2000, 99);
    double largest = 0;
    for (std::size_t k = 0; k < held_out.positions.size(); ++k) {
      const auto foot = field.project(held_out.positions[k]);
      ASSERT_TRUE(foot);
      mean[round] += norm(foot->point - held_out.positions[k]) / 2000;
      largest = std::max(largest, norm(foot->point - held_out.positions[k]));
    }
    // The other way: nothing of the surface lies away from the torus.
    for (const Vec3& p : mesh.positions) EXPECT_LT(test::torus_distance(p), 5 * largest);
  }
  EXPECT_GT(std::log2(mean[0] / mean[1]), 3);
}

TEST(Fit, TheSameBytesFromAnyNumberOfThreads) {
  const PointCloud cloud = torus_points(3000, 5);
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  const TetraQuad a = fit_tetraquad(cloud, {.resolution = 10}, nullptr, one);
  const TetraQuad b = fit_tetraquad(cloud, {.resolution = 10}, nullptr, two);
  EXPECT_EQ(a.quadrics, b.quadrics);
}

TEST(Fit, BadInputIsRefused) {
  PointCloud cloud;
  EXPECT_THROW(fit_tetraquad(cloud), BadInput);  // no points
  cloud.positions = {{1, 2, 3}};
  cloud.normals = {{0, 0, 1}};
  EXPECT_THROW(fit_tetraquad(cloud), BadInput);  // one
  cloud.positions.assign(1000, Vec3{1, 2, 3});
  cloud.normals.assign(1000, Vec3{0, 0, 1});
  EXPECT_THROW(fit_tetraquad(cloud), BadInput);  // all at one place
  cloud = sphere_points(100, {0, 0, 0}, 1);
  cloud.normals.clear();
  EXPECT_THROW(fit_tetraquad(cloud), BadInput);  // no normals
  cloud.normals.assign(100, Vec3{});
  EXPECT_THROW(fit_tetraquad(cloud), BadInput);  // all zero
  cloud.positions.assign(5, Vec3{NAN, 0, 0});
  EXPECT_THROW(fit_tetraquad(cloud), BadInput);
  EXPECT_THROW(fit_tetraquad(torus_points(100, 1), {.resolution = 1}), UsageError);
  EXPECT_THROW(fit_tetraquad(torus_points(100, 1), {.smoothness = -1}), UsageError);
}

TEST(Fit, HolesInTheDataAreLeftOutAndCounted) {
  PointCloud cloud = sphere_points(3000, {0, 0, 0}, 1);
  cloud.positions[5].x = NAN;
  cloud.positions[6].y = INFINITY;
  cloud.normals[7] = {};
  cloud.normals[8] = {NAN, 0, 0};
  for (int n = 0; n < 500; ++n) {  // duplicates
    cloud.positions.push_back(cloud.positions[100]);
    cloud.normals.push_back(cloud.normals[100]);
  }
  TetraQuadFitReport report;
  fit_tetraquad(cloud, {.resolution = 6, .bending = 0}, &report);
  EXPECT_EQ(report.points, 3500U);
  EXPECT_EQ(report.used, 3498U);
  EXPECT_EQ(report.without_normal, 2U);
  EXPECT_EQ(report.warnings.size(), 2U);
  EXPECT_LT(report.residual_max, 1e-5);
}

TEST(Fit, CoplanarPointsGiveTheirPlane) {
  test::Random random(21);
  PointCloud cloud;
  for (int n = 0; n < 2000; ++n) {
    cloud.positions.push_back({random.uniform(), random.uniform(), 5});
    cloud.normals.push_back({0, 0, 1});
  }
  const TetraQuad surface = fit_tetraquad(cloud, {.resolution = 5, .bending = 0});
  const TriangleMesh mesh = mesh_tetraquad(TetraQuadField(surface));
  EXPECT_FALSE(mesh.triangles.empty());
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(p.z, 5, 1e-7);
  EXPECT_EQ(topology_of(mesh).components, 1U);
  EXPECT_EQ(topology_of(mesh).borders, 1U);
}

TEST(Fit, MillimetresAtFiveMillion) {
  // What a survey has: a sphere of 2 m, known to the millimetre, 5,000 km from the origin.
  const Vec3 far = {5e6, 5.5e6, 300};
  const TetraQuad surface = fit_tetraquad(sphere_points(4000, far, 2), {.resolution = 6, .bending = 0});
  const TriangleMesh mesh = mesh_tetraquad(TetraQuadField(surface), {.divisions = 2});
  EXPECT_EQ(topology_of(mesh).open_edges, 0U);
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(norm(p - far), 2, 1e-5);
}

TEST(Fit, RefinesUntilThePointsAreWithin) {
  PointCloud cloud = torus_points(8000, 6);
  for (int n = 0; n < 20; ++n) {  // outliers, 0.25 %
    cloud.positions.push_back({0.01 * n, 0, 0.02});
    cloud.normals.push_back({0, 0, 1});
  }
  TetraQuadFitReport report;
  fit_tetraquad_to(cloud, {.max_error = 2e-3, .coarsest = 4}, {}, &report);
  EXPECT_LE(report.residual_quantile, 2e-3);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_LT(report.outliers, 80U);
  TetraQuadFitReport coarser;
  if (report.resolution > 4) {
    const int before = report.resolution == 6 ? 4 : report.resolution * 2 / 3;
    fit_tetraquad_to(cloud, {.max_error = 2e-3, .coarsest = 4, .finest = before}, {}, &coarser);
    EXPECT_GT(coarser.residual_quantile, 2e-3);
    EXPECT_EQ(coarser.warnings.size(), 1U);
  }
  EXPECT_THROW(fit_tetraquad_to(cloud, {.max_error = 0}), UsageError);
  EXPECT_THROW(fit_tetraquad_to(cloud, {.max_error = 1, .quantile = 2}), UsageError);
}

TEST(Fit, SheetsThatNoPointAsksForAreNotThereAndHolesClose) {
  // A sphere with a bald patch of about a cube's width: it closes, and nothing else appears.
  PointCloud cloud = sphere_points(8000, {0, 0, 0}, 1);
  PointCloud bald;
  for (std::size_t k = 0; k < cloud.positions.size(); ++k) {
    if (norm(cloud.positions[k] - Vec3{0, 0, 1}) < 0.15) continue;
    bald.positions.push_back(cloud.positions[k]);
    bald.normals.push_back(cloud.normals[k]);
  }
  ASSERT_LT(bald.positions.size(), 7980U);
  TetraQuadFitReport report;
  const TetraQuad surface = fit_tetraquad(bald, {.resolution = 12}, &report);
  EXPECT_EQ(report.open_faces, 0U);
  const TriangleMesh mesh = mesh_tetraquad(TetraQuadField(surface));
  const MeshTopology topology = topology_of(mesh);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.open_edges, 0U);
  EXPECT_EQ(topology.genus, 0);
  for (const Vec3& p : mesh.positions) EXPECT_NEAR(norm(p), 1, 0.02);
}

TEST(BlockCholesky, SolvesWhatADenseTwinSolves) {
  test::Random random(22);
  for (const std::size_t rows : {1U, 7U, 40U}) {
    std::vector<std::array<std::uint32_t, 2>> pairs;
    for (std::uint32_t v = 0; v < rows; ++v)
      for (std::uint32_t w = v + 1; w < rows; ++w)
        if (random.chance(0.15)) pairs.push_back({w, v});
    BlockMatrix matrix(rows, pairs);
    const auto size = static_cast<Eigen::Index>(10 * rows);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
    pairs.resize(pairs.size());
    for (const auto& [w, v] : pairs) {
      const Eigen::MatrixXd block = Eigen::MatrixXd::NullaryExpr(10, 10, [&] { return random.uniform(-1, 1); });
      matrix.add(w, v, [&](std::size_t i, std::size_t j) {
        return block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      });
      dense.block(10 * w, 10 * v, 10, 10) += block;
      dense.block(10 * v, 10 * w, 10, 10) += block.transpose();
    }
    matrix.add_ridge(100);
    dense.diagonal().array() += 100;
    std::vector<double> x(10 * rows), y(10 * rows);
    for (double& value : x) value = random.uniform(-1, 1);
    const Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(x.data(), size);
    matrix.multiply(x, y);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(y.data(), size) - dense * right).norm(), 1e-10);
    BlockCholesky(matrix).solve(x);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), size) - dense.llt().solve(right)).norm(), 1e-13);
    matrix.add_ridge(-300);
    EXPECT_THROW(BlockCholesky{matrix}, Error);
  }
}

TEST(Bunny, IsWithinThePromisedErrors) {
  RETALHO_DATA_FILE(points, "points/bunny.ply");
  RETALHO_DATA_FILE(check, "points/bunny_check.ply");
  TetraQuadFitReport report;
  const TetraQuad surface = fit_tetraquad(read_points(points), {.resolution = 16}, &report);
  const TetraQuadField field(surface);
  const PointCloud truth = read_points(check);
  const PointSummary box = summarize(truth);
  double error = 0;
  for (const Vec3& p : truth.positions) {
    const auto foot = field.project(p);
    if (foot) error += norm(foot->point - p) / static_cast<double>(truth.positions.size());
  }
  EXPECT_LT(error / norm(box.maximum - box.minimum), 4e-4);
  EXPECT_LT(report.coefficients, 14000U);
}

}  // namespace
}  // namespace retalho
