// The other ways to find the quadrics: conjugate gradients and local fits, against the factors and a dense twin.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/adaptive.h"
#include "retalho/tetraquad/block_cg.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/local_fit.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

using test::torus_points;

/// Mean distance of points that were not fitted.
double torus_error(const TetraQuad& surface) {
  const TetraQuadField field(surface);
  const PointCloud held_out = torus_points(2000, 99);
  double mean = 0;
  for (const Vec3& p : held_out.positions) {
    const auto foot = field.project(p);
    if (!foot) return HUGE_VAL;
    mean += norm(foot->point - p) / 2000;
  }
  return mean;
}

TEST(BlockCg, SolvesWhatADenseTwinSolves) {
  test::Random random(81);
  for (const std::size_t rows : {1U, 6U, 30U}) {
    std::vector<std::array<std::uint32_t, 2>> pairs;
    for (std::uint32_t v = 0; v < rows; ++v)
      for (std::uint32_t w = v + 1; w < rows; ++w)
        if (random.chance(0.2)) pairs.push_back({v, w});
    BlockMatrix matrix(rows, pairs);
    const auto size = static_cast<Eigen::Index>(10 * rows);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
    for (const auto& [v, w] : pairs) {
      const Eigen::MatrixXd block = Eigen::MatrixXd::NullaryExpr(10, 10, [&] { return random.uniform(-1, 1); });
      matrix.add(v, w, [&](std::size_t i, std::size_t j) {
        return block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      });
      dense.block(10 * v, 10 * w, 10, 10) += block;
      dense.block(10 * w, 10 * v, 10, 10) += block.transpose();
    }
    matrix.add_ridge(80);
    dense.diagonal().array() += 80;
    std::vector<double> right(10 * rows), x(10 * rows, 0.0);
    for (double& value : right) value = random.uniform(-1, 1);
    const CgNotes cold = solve_cg(matrix, right, x, {.tolerance = 1e-12});
    EXPECT_LE(cold.residual, 1e-12);
    const Eigen::VectorXd best = dense.llt().solve(Eigen::Map<Eigen::VectorXd>(right.data(), size));
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), size) - best).norm(), 1e-11 * best.norm());
    EXPECT_LE(solve_cg(matrix, right, x, {.tolerance = 1e-10}).iterations, 1);  // it is there already
    matrix.add_ridge(-300);
    EXPECT_THROW(solve_cg(matrix, right, x), Error);
  }
}

TEST(Solvers, ConjugateGradientsReachTheSurfaceOfTheFactors) {
  const PointCloud cloud = torus_points(10000, 3);
  TetraQuadFitReport direct, iterated;
  const TetraQuad a = fit_tetraquad(cloud, {.resolution = 12}, &direct);
  const TetraQuad b =
      fit_tetraquad(cloud, {.resolution = 12, .solver = TetraQuadSolver::cg, .cg_tolerance = 1e-6}, &iterated);
  EXPECT_GT(iterated.iterations, 10);
  EXPECT_EQ(iterated.factor_numbers, 0U);
  EXPECT_TRUE(iterated.warnings.empty());
  const TetraQuadField fa(a), fb(b);
  for (const Vec3& p : torus_points(500, 98).positions) {
    const auto one = fa.jet(p), other = fb.jet(p);
    ASSERT_TRUE(one && other);
    EXPECT_NEAR(one->value, other->value, 1e-4 * a.mesh.step);
  }
  EXPECT_NEAR(torus_error(b) / torus_error(a), 1, 0.05);
  EXPECT_EQ(topology_of(mesh_tetraquad(fb)).open_edges, 0U);
  EXPECT_THROW(fit_tetraquad(cloud, {.cg_tolerance = 0}), UsageError);
}

TEST(Solvers, LocalFitsAreRoughButClosedAndOfHighOrder) {
  const PointCloud cloud = torus_points(20000, 4);
  std::array<double, 2> error{};
  for (const std::size_t n : {0U, 1U}) {
    TetraQuadFitReport report;
    const TetraQuad surface =
        fit_tetraquad(cloud, {.resolution = n == 0 ? 8 : 16, .solver = TetraQuadSolver::local}, &report);
    EXPECT_EQ(report.iterations, 0);
    EXPECT_EQ(report.factor_numbers, 0U);
    error[n] = torus_error(surface);
    const MeshTopology topology = topology_of(mesh_tetraquad(TetraQuadField(surface)));
    EXPECT_EQ(topology.open_edges, 0U);
    EXPECT_EQ(topology.genus, 1);
    EXPECT_EQ(topology.components, 1U);
  }
  EXPECT_LT(error[1], 4e-5);
  EXPECT_GT(error[0] / error[1], 6);
}

TEST(Solvers, ACoarserFitIsAStart) {
  const PointCloud cloud = torus_points(10000, 5);
  const TetraQuadFitOptions options = {.resolution = 12, .solver = TetraQuadSolver::cg};
  TetraQuadFitReport at8, at12, both;
  fit_tetraquad(cloud, {.resolution = 8, .solver = TetraQuadSolver::cg}, &at8);
  fit_tetraquad(cloud, options, &at12);
  const TetraQuad warm = fit_tetraquad_to(cloud, {.max_error = 1e-9, .coarsest = 8, .finest = 12}, options, &both);
  EXPECT_EQ(both.resolution, 12);
  EXPECT_LT(both.iterations, 1.1 * (at8.iterations + at12.iterations));
  EXPECT_LT(torus_error(warm), 1e-5);
}

TEST(Solvers, AFinerMeshStartsWithTheSurfaceItself) {
  test::Random random(83);
  auto forest = std::make_shared<TetForest>(std::vector<LatticePoint>{{0, 0, 0}, {1, 0, 0}});
  const auto refine = [&](const TetForest& from) {
    auto finer = std::make_shared<TetForest>(from);
    std::vector<std::uint32_t> chosen;
    for (const std::uint32_t n : finer->leaves())
      if (random.chance(0.3)) chosen.push_back(n);
    finer->bisect(chosen);
    return finer;
  };
  TetraQuad surface;
  forest = refine(*refine(*forest));
  surface.mesh = make_tet_mesh({0, 0, 0}, 1.0 / TetForest::kUnit, forest, forest->leaves());
  for (std::size_t v = 0; v < surface.mesh.lattice.size(); ++v) {  // any function of the space, not a cubic
    Quadric q{};
    for (std::size_t n = 0; n < 10; ++n)
      q[n] = random.uniform(-1, 1) * std::pow(TetForest::kUnit, n == 0 ? 1 : n < 4 ? 0 : -1);
    surface.quadrics.push_back(q);
  }
  TetraQuad finer;
  const auto finer_forest = refine(*refine(*refine(*forest)));
  finer.mesh = make_tet_mesh({0, 0, 0}, surface.mesh.step, finer_forest, finer_forest->leaves());
  const std::vector<char> left = start_from(surface, finer.mesh, finer.quadrics);
  ASSERT_GT(finer.quadrics.size(), 2 * surface.quadrics.size());
  EXPECT_EQ(std::count(left.begin(), left.end(), 1), 0);
  const TetraQuadField before(surface), after(finer);
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p = {random.uniform(0, 2), random.uniform(), random.uniform()};
    EXPECT_NEAR(before.jet(p)->value, after.jet(p)->value, 1e-12);
  }
}

TEST(Solvers, AdaptiveFitsTakeThemAll) {
  const PointCloud cloud = torus_points(8000, 6);
  for (const TetraQuadSolver solver : {TetraQuadSolver::cg, TetraQuadSolver::local}) {
    TetraQuadFitReport report;
    const TetraQuad surface = fit_tetraquad_adaptive(cloud, {.coefficients = 8000, .start_level = 3},
                                                     {.smoothness = 0.1, .solver = solver}, &report);
    EXPECT_LT(torus_error(surface), solver == TetraQuadSolver::cg ? 2e-5 : 4e-4);
    EXPECT_EQ(report.iterations > 0, solver == TetraQuadSolver::cg);
    EXPECT_EQ(topology_of(mesh_tetraquad(TetraQuadField(surface))).open_edges, 0U);
  }
}

TEST(Solvers, TheSameBytesFromAnyNumberOfThreads) {
  const PointCloud cloud = torus_points(3000, 5);
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  for (const TetraQuadSolver solver : {TetraQuadSolver::cg, TetraQuadSolver::local})
    EXPECT_EQ(fit_tetraquad(cloud, {.resolution = 10, .solver = solver}, nullptr, one).quadrics,
              fit_tetraquad(cloud, {.resolution = 10, .solver = solver}, nullptr, two).quadrics);
}

}  // namespace
}  // namespace retalho
