// Floater's parameters: validation, plane meshes reproduced, no flip on noisy meshes, split edges, corners.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "patch/support.h"
#include "patch/surfaces.h"
#include "retalho/core/error.h"
#include "retalho/patch/multigrid.h"
#include "retalho/patch/parameterize.h"
#include "retalho/patch/surface.h"
#include "support/support.h"

namespace retalho::test {
namespace {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

Mesh plane_mesh(const Domain& domain) {
  Mesh mesh;
  mesh.triangles = domain.triangles;
  for (const Vec2& p : domain.parameters)
    mesh.positions.push_back({2 * p.x + 0.3 * p.y, p.y - 0.2 * p.x, 0.5 * p.x + p.y});
  return mesh;
}

std::size_t flips(const Domain& domain) {
  std::size_t count = 0;
  for (const auto& t : domain.triangles) {
    const Vec2 a = domain.parameters[t[0]], b = domain.parameters[t[1]], c = domain.parameters[t[2]];
    count += cross(b - a, c - a) > 0 ? 0 : 1;
  }
  return count;
}

TEST(Parameters, OfAPlaneMeshAreItsOwn) {
  for (const Weights weights : {Weights::shape_preserving, Weights::mean_value})
    for (const std::size_t n : {6U, 90U}) {  // the direct solver, and the iterative one
      const Domain domain = irregular_domain(n, 3);
      const Mesh mesh = plane_mesh(domain);
      const std::array<std::uint32_t, 3> corners = {domain.sides[0][0], domain.sides[1][0], domain.sides[2][0]};
      const Parameterization p = parameterize(mesh.positions, mesh.triangles, {.weights = weights, .corners = corners});
      EXPECT_EQ(p.iterations > 0, n == 90);
      double worst = 0;
      for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        worst = std::max(worst, norm(p.domain.parameters[i] - domain.parameters[i]));
      EXPECT_LE(worst, 1e-11) << n;
    }
}

TEST(Parameters, NoFlipOnAThousandNoisyMeshes) {
  std::mt19937_64 random(test_seed());
  std::normal_distribution<double> normal;
  for (int round = 0; round < 1000; ++round) {
    const std::size_t n = round % 100 == 99 ? 80 : 12;
    const Domain domain = round % 2 == 0 ? regular_domain(n) : irregular_domain(n, static_cast<std::uint64_t>(round));
    Mesh mesh = plane_mesh(domain);
    const double noise = (round % 5 + 1) * 0.6 / static_cast<double>(n);
    for (Vec3& p : mesh.positions) {
      const double x = normal(random), y = normal(random), z = normal(random);
      p = p + noise * Vec3{x, y, z};
    }
    const std::array<std::uint32_t, 3> corners = {domain.sides[0][0], domain.sides[1][0], domain.sides[2][0]};
    for (const Weights weights : {Weights::shape_preserving, Weights::mean_value}) {
      const Parameterization p = parameterize(mesh.positions, mesh.triangles, {.weights = weights, .corners = corners});
      ASSERT_EQ(flips(p.domain), 0U) << round;
    }
  }
}

TEST(Parameters, DividingEdgesAreSplit) {
  // A side with an ear: vertices 0, 3, 1 are on one side and the edge 0 1 divides.
  const std::vector<Vec3> positions = {{0, 0, 0}, {2, 0, 0}, {1, 2, 0}, {1, -0.2, 0}, {1, 0.5, 0}};
  const std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 3, 1}, {0, 1, 4}, {1, 2, 4}, {2, 0, 4}};
  const Parameterization p = parameterize(positions, triangles, {.corners = std::array<std::uint32_t, 3>{0, 1, 2}});
  EXPECT_EQ(p.split_edges, 1U);
  EXPECT_EQ(p.positions.size(), 6U);
  EXPECT_EQ(p.domain.triangles.size(), 6U);
  EXPECT_EQ(flips(p.domain), 0U);
}

TEST(Parameters, CornersAreFoundAndTheBorderRunsByArcLength) {
  const Domain domain = regular_domain(10);
  Mesh mesh;
  mesh.triangles = domain.triangles;
  for (const Vec2& p : domain.parameters) mesh.positions.push_back(octant(p).point);
  const Parameterization p = parameterize(mesh.positions, mesh.triangles);
  std::array<std::uint32_t, 3> found = {p.domain.sides[0][0], p.domain.sides[1][0], p.domain.sides[2][0]};
  std::array<std::uint32_t, 3> wanted = {domain.sides[0][0], domain.sides[1][0], domain.sides[2][0]};
  std::sort(found.begin(), found.end());
  std::sort(wanted.begin(), wanted.end());
  EXPECT_EQ(found, wanted);
  for (int s = 0; s < 3; ++s) {
    const auto& side = p.domain.sides[static_cast<std::size_t>(s)];
    double total = 0, sum = 0;
    for (std::size_t k = 1; k < side.size(); ++k) total += norm(p.positions[side[k]] - p.positions[side[k - 1]]);
    for (std::size_t k = 1; k < side.size(); ++k) {
      sum += norm(p.positions[side[k]] - p.positions[side[k - 1]]);
      EXPECT_NEAR(side_argument(s, p.domain.parameters[side[k]]), sum / total, 1e-12);
    }
  }
}

TEST(Parameters, ASurfaceOverThem) {
  const Domain domain = irregular_domain(48, 8);
  Mesh mesh;
  mesh.triangles = domain.triangles;
  for (const Vec2& p : domain.parameters) mesh.positions.push_back(octant(p).point);
  for (const Weights weights : {Weights::shape_preserving, Weights::mean_value}) {
    const Patch patch = patch_of(parameterize(mesh.positions, mesh.triangles, {.weights = weights}));
    const PatchSurface surface(patch);
    std::mt19937_64 random(1);
    for (int k = 0; k < 2000; ++k) EXPECT_NEAR(norm(surface.point(random_parameters(random))), 1, 2e-5);
    for (std::size_t i = 0; i < patch.positions.size(); ++i)
      EXPECT_LE(norm(surface.point(patch.domain.parameters[i]) - patch.positions[i]), 1e-12);
  }
}

std::string complaint(const Mesh& mesh) {
  try {
    check_disk(mesh.positions, mesh.triangles);
  } catch (const BadInput& error) {
    return std::string(error.what()) + " @ " + error.where();
  }
  return "";
}

void expect_words(const Mesh& mesh, const std::string& words) {
  EXPECT_NE(complaint(mesh).find(words), std::string::npos) << complaint(mesh);
}

TEST(Validation, SaysWhatIsWrongAndWhere) {
  const Mesh good = plane_mesh(regular_domain(4));
  EXPECT_EQ(complaint(good), "");
  Mesh mesh = good;
  mesh.triangles[3][1] = 99;
  expect_words(mesh, "triangle 3 names vertex 99");
  mesh = good;
  mesh.triangles[2] = {0, 1, 1};
  expect_words(mesh, "triangle 2 names vertex 1 twice");
  mesh = good;
  std::swap(mesh.triangles[5][0], mesh.triangles[5][1]);
  expect_words(mesh, "oriented against each other");
  mesh = good;  // a fin on an inner edge
  mesh.positions.push_back({0, 0, 9});
  const auto edge = mesh.triangles[1];
  mesh.triangles.push_back({edge[0], edge[1], 15});
  expect_words(mesh, "belongs to 3 triangles");
  mesh = good;
  mesh.positions.push_back({0, 0, 9});
  expect_words(mesh, "1 vertices belong to no triangle, the first is vertex 15");
  mesh = good;  // a hole
  mesh.triangles.clear();
  for (const auto& t : plane_mesh(regular_domain(6)).triangles) mesh.triangles.push_back(t);
  mesh.positions = plane_mesh(regular_domain(6)).positions;
  mesh.triangles.erase(mesh.triangles.begin() + 15);
  EXPECT_TRUE(complaint(mesh).find("borders") != std::string::npos ||
              complaint(mesh).find("touch") != std::string::npos)
      << complaint(mesh);
  mesh = good;  // two parts
  for (const auto& t : good.triangles) mesh.triangles.push_back({t[0] + 15, t[1] + 15, t[2] + 15});
  mesh.positions.insert(mesh.positions.end(), good.positions.begin(), good.positions.end());
  expect_words(mesh, "2 separate parts");
  mesh = {};  // two triangles that share a vertex only
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  expect_words(mesh, "touch at vertex 0");
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  mesh.positions.pop_back();
  expect_words(mesh, "closed");
  mesh.positions[2] = mesh.positions[1];
  expect_words(mesh, "no length");
}

TEST(Solver, IterativeAndDirectAgree) {
  const Domain domain = irregular_domain(80, 4);
  Mesh mesh = plane_mesh(domain);
  std::mt19937_64 random(test_seed());
  std::normal_distribution<double> normal(0, 0.02);
  for (Vec3& p : mesh.positions) p.z += normal(random);
  const std::array<std::uint32_t, 3> corners = {domain.sides[0][0], domain.sides[1][0], domain.sides[2][0]};
  const Parameterization p = parameterize(mesh.positions, mesh.triangles, {.corners = corners});
  EXPECT_GT(p.iterations, 0);
  EXPECT_LE(p.iterations, 40);
  std::vector<std::uint32_t> order(mesh.positions.size());  // the same vertices in another order: another multigrid
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), random);
  Mesh shuffled;
  shuffled.positions.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) shuffled.positions[order[i]] = mesh.positions[i];
  for (const auto& t : mesh.triangles) shuffled.triangles.push_back({order[t[0]], order[t[1]], order[t[2]]});
  const Parameterization q =
      parameterize(shuffled.positions, shuffled.triangles,
                   {.corners = std::array<std::uint32_t, 3>{order[corners[0]], order[corners[1]], order[corners[2]]}});
  double worst = 0;
  for (std::size_t i = 0; i < order.size(); ++i)
    worst = std::max(worst, norm(p.domain.parameters[i] - q.domain.parameters[order[i]]));
  EXPECT_LE(worst, 1e-11);
}

}  // namespace
}  // namespace retalho::test
