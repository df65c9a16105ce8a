// The element: continuity, what it reproduces, its redundancy.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "retalho/tetraquad/tetraquad.h"
#include "support/support.h"

namespace retalho {
namespace {

std::vector<TetPlace> block(TetSplit split, int n) {
  std::vector<TetPlace> places;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        for (int t = 0; t < tets_of_cube(split); ++t) places.push_back({{i, j, k}, static_cast<std::uint8_t>(t)});
  return places;
}

class ElementOnSplits : public testing::TestWithParam<TetSplit> {};
INSTANTIATE_TEST_SUITE_P(Both, ElementOnSplits, testing::Values(TetSplit::five, TetSplit::kuhn));

TetraQuad random_surface(TetSplit split, int n, test::Random& random) {
  TetraQuad surface;
  surface.mesh = make_tet_mesh({0.3, -0.2, 0.7}, 0.25, split, block(split, n));
  surface.quadrics.resize(surface.mesh.lattice.size());
  for (Quadric& q : surface.quadrics)
    for (double& c : q) c = random.uniform(-1, 1);
  return surface;
}

/// A cubic of three variables with all its derivatives.
struct Cubic {
  double c[4][4][4] = {};
  Jet3 operator()(Vec3 p) const {
    const auto power = [](double x, int n, int d) {  // the d-th derivative of x^n
      double f = 1;
      for (int k = 0; k < d; ++k) f *= n - k;
      return n < d ? 0.0 : f * std::pow(x, n - d);
    };
    Jet3 jet;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; i + j < 4; ++j)
        for (int k = 0; i + j + k < 4; ++k) {
          const auto term = [&](int a, int b, int d) {
            return c[i][j][k] * power(p.x, i, a) * power(p.y, j, b) * power(p.z, k, d);
          };
          jet.value += term(0, 0, 0);
          jet.gradient = jet.gradient + Vec3{term(1, 0, 0), term(0, 1, 0), term(0, 0, 1)};
          const std::array<double, 6> h = {term(2, 0, 0), term(0, 2, 0), term(0, 0, 2),
                                           term(1, 1, 0), term(1, 0, 1), term(0, 1, 1)};
          for (std::size_t n = 0; n < 6; ++n) jet.hessian[n] += h[n];
        }
    return jet;
  }
};

TEST_P(ElementOnSplits, IsContinuousAcrossEveryFace) {
  test::Random random(11);
  const TetraQuad surface = random_surface(GetParam(), 3, random);
  const TetraQuadField field(surface);
  const HalfFaces faces(surface.mesh.tets, surface.mesh.lattice.size());
  for (std::size_t f = 0; f < 4 * surface.mesh.tets.size(); ++f) {
    if (faces.is_border(f)) continue;
    TetBarycentric here{};
    for (std::size_t i = 0; i < 4; ++i) here[i] = i == f % 4 ? 0 : random.uniform(0.1, 1);
    const double sum = here[0] + here[1] + here[2] + here[3];
    Vec3 p{};
    for (std::size_t i = 0; i < 4; ++i) {
      here[i] /= sum;
      p = p + here[i] * surface.mesh.position(surface.mesh.tets[f / 4][i]);
    }
    const auto other = static_cast<std::size_t>(faces.opposite(f)) / 4;
    TetBarycentric there{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j)
        if (surface.mesh.tets[other][j] == surface.mesh.tets[f / 4][i]) there[j] = here[i];
    EXPECT_NEAR(evaluate(field.ordinates(f / 4), here), evaluate(field.ordinates(other), there), 1e-13);
  }
}

TEST_P(ElementOnSplits, IsTheBlendOfItsQuadrics) {
  test::Random random(12);
  const TetraQuad surface = random_surface(GetParam(), 2, random);
  const TetraQuadField field(surface);
  for (int n = 0; n < 500; ++n) {
    const Vec3 p = surface.mesh.origin + Vec3{random.uniform(0, 0.5), random.uniform(0, 0.5), random.uniform(0, 0.5)};
    TetBarycentric b;
    const auto t = static_cast<std::size_t>(surface.mesh.locate(p, &b));
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t v = surface.mesh.tets[t][i];
      const Vec3 u = (p - surface.mesh.position(v)) / surface.mesh.step;
      sum += b[i] * polar(surface.quadrics[v], u, u);
    }
    EXPECT_NEAR(field.jet(p)->value, surface.mesh.step * sum, 1e-13);
  }
}

TEST_P(ElementOnSplits, GradientsAndHessiansAreDerivatives) {
  test::Random random(13);
  const TetraQuad surface = random_surface(GetParam(), 1, random);
  const TetraQuadField field(surface);
  const double e = 1e-5;
  for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t) {
    Vec3 p{};
    for (std::size_t i = 0; i < 4; ++i) p = p + 0.25 * surface.mesh.position(surface.mesh.tets[t][i]);
    const auto at = [&](Vec3 q) { return field.jet(t, field.frame(t).barycentric(surface.mesh.to_lattice(q))); };
    const Jet3 jet = at(p);
    const Vec3 x{e, 0, 0}, y{0, e, 0}, z{0, 0, e};
    EXPECT_NEAR(jet.gradient.x, (at(p + x).value - at(p - x).value) / (2 * e), 1e-6);
    EXPECT_NEAR(jet.gradient.y, (at(p + y).value - at(p - y).value) / (2 * e), 1e-6);
    EXPECT_NEAR(jet.gradient.z, (at(p + z).value - at(p - z).value) / (2 * e), 1e-6);
    EXPECT_NEAR(jet.hessian[0], (at(p + x).gradient.x - at(p - x).gradient.x) / (2 * e), 1e-5);
    EXPECT_NEAR(jet.hessian[1], (at(p + y).gradient.y - at(p - y).gradient.y) / (2 * e), 1e-5);
    EXPECT_NEAR(jet.hessian[2], (at(p + z).gradient.z - at(p - z).gradient.z) / (2 * e), 1e-5);
    EXPECT_NEAR(jet.hessian[3], (at(p + y).gradient.x - at(p - y).gradient.x) / (2 * e), 1e-5);
    EXPECT_NEAR(jet.hessian[4], (at(p + z).gradient.x - at(p - z).gradient.x) / (2 * e), 1e-5);
    EXPECT_NEAR(jet.hessian[5], (at(p + z).gradient.y - at(p - z).gradient.y) / (2 * e), 1e-5);
  }
}

TEST_P(ElementOnSplits, EveryCubicIsReproduced) {
  test::Random random(14);
  for (int round = 0; round < 20; ++round) {
    Cubic cubic;
    for (auto& plane : cubic.c)
      for (auto& row : plane)
        for (double& c : row) c = random.uniform(-1, 1);
    const TetraQuad surface =
        quasi_interpolant(make_tet_mesh({-0.5, -0.5, -0.5}, 1.0 / 3, GetParam(), block(GetParam(), 3)), cubic);
    const TetraQuadField field(surface);
    for (int n = 0; n < 100; ++n) {
      const Vec3 p = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)};
      const Jet3 truth = cubic(p), found = *field.jet(p);
      EXPECT_NEAR(found.value, truth.value, 1e-12);
      EXPECT_LT(norm(found.gradient - truth.gradient), 1e-12);
      for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(found.hessian[k], truth.hessian[k], 2e-11);
    }
  }
}

TEST(QuasiInterpolant, TheErrorFallsWithTheFourthPower) {
  const auto f = [](Vec3 p) {
    Jet3 jet;
    const double s = std::sin(2 * p.x + p.y - p.z), c = std::cos(2 * p.x + p.y - p.z);
    jet.value = s;
    jet.gradient = {2 * c, c, -c};
    jet.hessian = {-4 * s, -s, -s, -2 * s, 2 * s, s};
    return jet;
  };
  double last = 0;
  for (const int n : {2, 4, 8}) {
    test::Random random(15);
    const TetraQuad surface =
        quasi_interpolant(make_tet_mesh({0, 0, 0}, 1.0 / n, TetSplit::five, block(TetSplit::five, n)), f);
    const TetraQuadField field(surface);
    double worst = 0;
    for (int k = 0; k < 3000; ++k) {
      const Vec3 p = {random.uniform(), random.uniform(), random.uniform()};
      worst = std::max(worst, std::abs(field.jet(p)->value - f(p).value));
    }
    if (last > 0) {
      EXPECT_GT(last / worst, 12);
    }
    last = worst;
  }
}

TEST_P(ElementOnSplits, QuadricsThatGiveTheSameFunctionHaveTwentyDimensions) {
  for (const int n : {1, 2}) {
    TetraQuad surface;
    surface.mesh = make_tet_mesh({0, 0, 0}, 1, GetParam(), block(GetParam(), n));
    const std::size_t unknowns = 10 * surface.mesh.lattice.size();
    Eigen::MatrixXd map(static_cast<Eigen::Index>(20 * surface.mesh.tets.size()), static_cast<Eigen::Index>(unknowns));
    for (std::size_t u = 0; u < unknowns; ++u) {
      surface.quadrics.assign(surface.mesh.lattice.size(), Quadric{});
      surface.quadrics[u / 10][u % 10] = 1;
      for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t) {
        const TetCubic c = ordinates(surface, t);
        for (std::size_t k = 0; k < 20; ++k)
          map(static_cast<Eigen::Index>(20 * t + k), static_cast<Eigen::Index>(u)) = c[k];
      }
    }
    Eigen::FullPivHouseholderQR<Eigen::MatrixXd> qr(map);
    qr.setThreshold(1e-10);
    EXPECT_EQ(static_cast<std::size_t>(qr.rank()), unknowns - 20);
  }
}

TEST_P(ElementOnSplits, ContinuedAcrossAFaceItIsTheSameCubic) {
  test::Random random(16);
  TetraQuad surface;
  surface.mesh = make_tet_mesh({0, 0, 0}, 1, GetParam(), {{{0, 0, 0}, 0}, across(GetParam(), {{0, 0, 0}, 0}, 2)});
  surface.quadrics.resize(5);
  const std::size_t near = surface.mesh.places[0] == TetPlace{{0, 0, 0}, 0} ? 0 : 1;
  for (const std::uint32_t v : surface.mesh.tets[near])
    for (double& c : surface.quadrics[v]) c = random.uniform(-1, 1);
  for (std::uint32_t v = 0; v < 5; ++v)
    if (std::count(surface.mesh.tets[near].begin(), surface.mesh.tets[near].end(), v) == 0)
      surface.quadrics[v] = continued(surface, near, surface.mesh.lattice[v]);
  const TetraQuadField field(surface);
  for (int n = 0; n < 100; ++n) {
    const Vec3 p = {random.uniform(-1, 2), random.uniform(-1, 2), random.uniform(-1, 2)};
    EXPECT_NEAR(evaluate(field.ordinates(0), field.frame(0).barycentric(p)),
                evaluate(field.ordinates(1), field.frame(1).barycentric(p)), 1e-10);
  }
}

TEST(TetCubicTables, BlossomIsSymmetricAndGivesTheOrdinates) {
  test::Random random(17);
  TetCubic c{};
  for (double& v : c) v = random.uniform(-1, 1);
  const auto any = [&] {
    return TetBarycentric{random.uniform(), random.uniform(), random.uniform(), random.uniform()};
  };
  const TetBarycentric u = any(), v = any(), w = any();
  EXPECT_NEAR(blossom(c, u, v, w), blossom(c, w, u, v), 1e-14);
  for (std::size_t n = 0; n < 20; ++n) {
    std::array<TetBarycentric, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) corner[k][static_cast<std::size_t>(kTet.cubic[n][k])] = 1;
    EXPECT_EQ(blossom(c, corner[0], corner[1], corner[2]), c[n]);
  }
}

}  // namespace
}  // namespace retalho
