// Adaptive fits: the element on bisected meshes, and what refinement reaches.
#include "retalho/tetraquad/adaptive.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/rays.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

std::shared_ptr<TetForest> random_forest(test::Random& random, int rounds) {
  auto forest = std::make_shared<TetForest>(std::vector<LatticePoint>{{0, 0, 0}});
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint32_t> chosen;
    for (const std::uint32_t n : forest->leaves())
      if (random.chance(0.2)) chosen.push_back(n);
    forest->bisect(chosen);
  }
  return forest;
}

TEST(Adaptive, CubicsAreReproducedAndTheRedundancyStaysTwentyOnMixedLevels) {
  test::Random random(71);
  const auto forest = random_forest(random, 5);
  // In steps of the forest's lattice quadrics have large numbers: the step is chosen so that a cube's edge is 1.
  TetraQuad surface;
  surface.mesh = make_tet_mesh({0, 0, 0}, 1.0 / TetForest::kUnit, forest, forest->leaves());
  const auto f = [](Vec3 p) {
    Jet3 jet;
    jet.value = p.x * p.x * p.y + p.z * p.z - 0.4 * p.x * p.y * p.z;
    jet.gradient = {2 * p.x * p.y - 0.4 * p.y * p.z, p.x * p.x - 0.4 * p.x * p.z, 2 * p.z - 0.4 * p.x * p.y};
    jet.hessian = {2 * p.y, 0, 2, 2 * p.x - 0.4 * p.z, -0.4 * p.y, -0.4 * p.x};
    return jet;
  };
  surface = quasi_interpolant(surface.mesh, f);
  const TetraQuadField field(surface);
  for (int n = 0; n < 500; ++n) {
    const Vec3 p = {random.uniform(), random.uniform(), random.uniform()};
    EXPECT_NEAR(field.jet(p)->value, f(p).value, 1e-12);
    EXPECT_LT(norm(field.jet(p)->gradient - f(p).gradient), 1e-11);
  }
  surface.mesh.step = 1;
  const std::size_t unknowns = 10 * surface.mesh.lattice.size();
  ASSERT_LT(unknowns, 1500U);
  Eigen::MatrixXd map(static_cast<Eigen::Index>(20 * surface.mesh.tets.size()), static_cast<Eigen::Index>(unknowns));
  for (std::size_t u = 0; u < unknowns; ++u) {
    surface.quadrics.assign(surface.mesh.lattice.size(), Quadric{});
    // Scaled to a cube of edge 1, so that the rank can be told.
    surface.quadrics[u / 10][u % 10] = std::pow(1.0 / TetForest::kUnit, u % 10 == 0 ? 0 : u % 10 < 4 ? 1 : 2);
    for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t) {
      const TetCubic c = ordinates(surface, t);
      for (std::size_t k = 0; k < 20; ++k)
        map(static_cast<Eigen::Index>(20 * t + k), static_cast<Eigen::Index>(u)) = c[k];
    }
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(map);
  qr.setThreshold(1e-10);
  EXPECT_EQ(static_cast<std::size_t>(qr.rank()), unknowns - 20);
}

TEST(Adaptive, ATorusIsClosedAndBetterThanItsBudgetsGrid) {
  TetraQuadFitReport report;
  const TetraQuad surface = fit_tetraquad_adaptive(
      test::torus_points(10000, 1), {.coefficients = 8000, .start_level = 3}, {.smoothness = 0.1}, &report);
  EXPECT_LE(report.coefficients, 8200U);
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_EQ(report.open_faces, 0U);
  const TetraQuadField field(surface);
  const TriangleMesh mesh = mesh_tetraquad(field, {.divisions = 2});
  const MeshTopology topology = topology_of(mesh);
  EXPECT_EQ(topology.components, 1U);
  EXPECT_EQ(topology.open_edges, 0U);
  EXPECT_EQ(topology.genus, 1);
  EXPECT_TRUE(check_mesh(mesh).watertight());
  double mean = 0;
  const PointCloud held_out = test::torus_points(2000, 99);
  for (const Vec3& p : held_out.positions) {
    const auto foot = field.project(p);
    ASSERT_TRUE(foot);
    mean += norm(foot->point - p) / 2000;
  }
  EXPECT_LT(mean, 1.5e-5);
  // Rays from inside hit the torus from inside.
  const TetraQuadRays rays(field);
  test::Random random(72);
  for (int n = 0; n < 20000; ++n) {
    const Vec3 direction = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const auto hit = rays.first({test::kTorusRing, 0, 0}, direction);
    ASSERT_TRUE(hit.has_value());
    EXPECT_LT(test::torus_distance(Vec3{test::kTorusRing, 0, 0} + hit->t * direction), 1e-3);
  }
}

TEST(Adaptive, StopsWhereThePointsAreNearEnoughAndSaysWhatItCannot) {
  TetraQuadFitReport report;
  fit_tetraquad_adaptive(test::torus_points(10000, 1), {.max_error = 2e-3, .start_level = 2}, {.smoothness = 0.1},
                         &report);
  EXPECT_LE(report.residual_quantile, 2e-3);
  EXPECT_LT(report.coefficients, 8000U);
  fit_tetraquad_adaptive(test::torus_points(4000, 1), {.coefficients = 300, .start_level = 6}, {.smoothness = 0.1},
                         &report);
  EXPECT_EQ(report.warnings.size(), 1U);
  EXPECT_THROW(fit_tetraquad_adaptive(test::torus_points(100, 1), {.roots = 1}), UsageError);
  EXPECT_THROW(fit_tetraquad_adaptive({}, {}), BadInput);
}

}  // namespace
}  // namespace retalho
