// The promises of mesh_terrain (mesh/terrain_mesh.h), by samples of the true surface.
#include "retalho/mesh/terrain_mesh.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "support/sample_terrain.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::sample_terrain;

/// A smooth terrain of each kind on jittered points, with random data that no smooth function gives.
Terrain rough_terrain(SurfaceKind kind, CrossDerivative cross, int columns, int rows, std::uint64_t seed,
                      double steepness) {
  const Terrain sample = sample_terrain({.kind = SurfaceKind::linear,
                                         .columns = columns,
                                         .rows = rows,
                                         .on_grid = false,
                                         .integer_heights = false,
                                         .shuffled = true,
                                         .seed = seed});
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; };
  Tin tin = sample.tin;
  std::vector<Vec2> gradients;
  for (double& z : tin.heights) z = 10 * uniform(), gradients.push_back({steepness * uniform(), steepness * uniform()});
  return make_terrain(
      std::move(tin), Georef{},
      {.surface = kind, .gradients = GradientKind::given, .cross_derivative = cross, .given = gradients});
}

/// The largest vertical distance between the mesh and the surface at `samples` random points a triangle.
double largest_distance(const Terrain& terrain, const TriangleMesh& mesh, int samples) {
  const TerrainEvaluator surface(terrain);
  test::Random random(mesh.triangles.size());
  double largest = 0;
  std::size_t asked = 0, answered = 0;
  for (const auto& v : mesh.triangles)
    for (int k = 0; k < samples; ++k) {
      double r = random.uniform(0, 1), s = random.uniform(0, 1);
      if (r + s > 1) r = 1 - r, s = 1 - s;
      if (k == 0) r = s = 1.0 / 3;
      const Vec3 p = r * mesh.positions[v[0]] + s * mesh.positions[v[1]] + (1 - r - s) * mesh.positions[v[2]];
      const double z = surface.value({p.x, p.y});
      ++asked;
      if (std::isnan(z)) continue;  // on the border, or in a void cell that the triangle's centre is not in
      ++answered;
      largest = std::max(largest, std::abs(z - p.z));
    }
  EXPECT_GE(static_cast<double>(answered), 0.9 * static_cast<double>(asked));
  return largest;
}

double area_of(const Tin& tin) {
  double area = 0;
  for (const auto& v : tin.triangles)
    area += cross(tin.points[v[1]] - tin.points[v[0]], tin.points[v[2]] - tin.points[v[0]]) / 2;
  return area;
}

/// Area seen from above; every triangle must face up.
double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& v : mesh.triangles) {
    const Vec3 normal = cross(mesh.positions[v[1]] - mesh.positions[v[0]], mesh.positions[v[2]] - mesh.positions[v[0]]);
    EXPECT_GT(normal.z, 0);
    area += normal.z / 2;
  }
  return area;
}

void expect_no_cracks(const TriangleMesh& mesh) {
  const MeshCheck check = check_mesh(mesh);
  EXPECT_EQ(check.cracks, 0U);
  EXPECT_EQ(check.nonmanifold_edges, 0U);
  EXPECT_EQ(check.degenerate_triangles, 0U);
  EXPECT_TRUE(check.watertight());
}

struct Surface {
  SurfaceKind kind;
  CrossDerivative cross;
};
const Surface kSmooth[] = {{SurfaceKind::powell_sabin, CrossDerivative::perpendicular},
                           {SurfaceKind::clough_tocher, CrossDerivative::perpendicular},
                           {SurfaceKind::clough_tocher, CrossDerivative::cubic}};

TEST(TerrainMesh, ALinearSurfaceIsItsOwnMesh) {
  const Terrain t = sample_terrain({.kind = SurfaceKind::linear, .columns = 6, .rows = 5, .on_grid = false});
  const TriangleMesh mesh = mesh_terrain(t, {.tolerance = 1e-6});
  EXPECT_EQ(mesh.triangles, t.tin.triangles);
  EXPECT_EQ(mesh.positions.size(), t.tin.vertex_count());
  EXPECT_EQ(mesh.offset, (Vec3{t.georef.origin_x, t.georef.origin_y, 0}));
  expect_no_cracks(mesh);
}

TEST(TerrainMesh, NormalsOfALinearSurfaceAreTheMeanByArea) {
  Tin tin;
  tin.points = {{0, 0}, {2, 0}, {0, 1}, {-1, 0}};
  tin.heights = {0, 0, 0, 1};
  tin.triangles = {{0, 1, 2}, {0, 2, 3}};
  build_neighbors(tin);
  const TriangleMesh mesh = mesh_terrain(make_terrain(tin, Georef{}, {.surface = SurfaceKind::linear}));
  // Twice the area vectors: (0, 0, 2) and (0, 1, 0) x (-1, 0, 1) = (1, 0, 1).
  const Vec3 mean = normalized({1, 0, 3});
  EXPECT_NEAR(norm(mesh.normals[0] - mean), 0, 1e-15);
  EXPECT_NEAR(norm(mesh.normals[1] - Vec3{0, 0, 1}), 0, 1e-15);
}

RC_GTEST_PROP(TerrainMeshProperty, EveryTriangleIsWithinTheToleranceAndThereAreNoCracks, ()) {
  const Surface s = *rc::gen::elementOf(std::vector<Surface>(std::begin(kSmooth), std::end(kSmooth)));
  const int columns = *rc::gen::inRange(2, 7), rows = *rc::gen::inRange(2, 7);
  const double tolerance = *rc::gen::element(0.01, 0.05, 0.3, 1.0, 5.0);
  const double steepness = *rc::gen::element(0.0, 2.0, 20.0);
  const Terrain t = rough_terrain(s.kind, s.cross, columns, rows, *rc::gen::arbitrary<std::uint64_t>(), steepness);
  const TriangleMesh mesh = mesh_terrain(t, {.tolerance = tolerance});
  RC_ASSERT(largest_distance(t, mesh, 8) <= tolerance * (1 + 1e-9));
  const MeshCheck check = check_mesh(mesh);
  RC_ASSERT(check.cracks == 0U);
  RC_ASSERT(check.nonmanifold_edges == 0U);
  RC_ASSERT(check.degenerate_triangles == 0U);
  RC_ASSERT(std::abs(area_of(mesh) - area_of(t.tin)) <= 1e-9 * area_of(t.tin));
  RC_CLASSIFY(mesh.triangles.size() > 100 * t.tin.triangle_count(), "over 100 a triangle");
  RC_CLASSIFY(mesh.triangles.size() > 6 * t.tin.triangle_count(), "cut at all");
}

TEST(TerrainMesh, VerticesLieOnTheSurfaceAndNormalsAreItsOwn) {
  for (const Surface& s : kSmooth) {
    const Terrain t = rough_terrain(s.kind, s.cross, 5, 5, 7, 3);
    const TriangleMesh mesh = mesh_terrain(t, {.tolerance = 0.05});
    const TerrainEvaluator surface(t);
    std::size_t compared = 0;
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      EXPECT_NEAR(norm(mesh.normals[v]), 1, 1e-12);
      const auto jet = surface.jet({mesh.positions[v].x, mesh.positions[v].y});
      if (!jet) continue;
      ++compared;
      EXPECT_NEAR(jet->value, mesh.positions[v].z, 1e-10);
      EXPECT_NEAR(norm(mesh.normals[v] - normalized(Vec3{-jet->gradient.x, -jet->gradient.y, 1})), 0, 1e-9) << v;
    }
    EXPECT_GT(compared, mesh.positions.size() / 2);
  }
}

TEST(TerrainMesh, APlaneIsNotCut) {
  for (const Surface& s : kSmooth) {
    Tin tin = sample_terrain({.kind = SurfaceKind::linear, .columns = 5, .rows = 5, .on_grid = false}).tin;
    std::vector<Vec2> gradients(tin.points.size(), Vec2{0.5, -0.25});
    for (std::size_t v = 0; v < tin.points.size(); ++v) tin.heights[v] = 0.5 * tin.points[v].x - 0.25 * tin.points[v].y;
    const Terrain t = make_terrain(
        tin, Georef{},
        {.surface = s.kind, .gradients = GradientKind::given, .cross_derivative = s.cross, .given = gradients});
    const TriangleMesh mesh = mesh_terrain(t);
    EXPECT_EQ(mesh.triangles.size(), t.tin.triangle_count() * static_cast<std::size_t>(patches_per_triangle(s.kind)));
    expect_no_cracks(mesh);
  }
}

TEST(TerrainMesh, TheNumberOfTrianglesIsNearTheOptimum) {
  // z = (x^2 + y^2) / 2: an interpolating mesh of triangles with circumradius R is off by R^2 / 2, so no mesh with
  // vertices on the surface needs fewer than area / (3 sqrt(3) / 4 * 2 tolerance) triangles.
  for (const Surface& s : kSmooth)
    for (const double tolerance : {1e-2, 3e-3, 1e-3, 3e-4}) {
      Tin tin = sample_terrain({.kind = SurfaceKind::linear, .columns = 4, .rows = 4, .on_grid = false}).tin;
      std::vector<Vec2> gradients = tin.points;
      for (std::size_t v = 0; v < tin.points.size(); ++v) tin.heights[v] = norm2(tin.points[v]) / 2;
      const Terrain t = make_terrain(
          tin, Georef{},
          {.surface = s.kind, .gradients = GradientKind::given, .cross_derivative = s.cross, .given = gradients});
      const TriangleMesh mesh = mesh_terrain(t, {.tolerance = tolerance});
      const double least = area_of(t.tin) / (1.5 * std::sqrt(3.0) * tolerance);
      const double ratio = static_cast<double>(mesh.triangles.size()) / least;
      EXPECT_LT(ratio, 6) << surface_name(s.kind) << ", tolerance " << tolerance;
      const double distance = largest_distance(t, mesh, 8);
      EXPECT_LE(distance, tolerance);
      EXPECT_GT(distance, tolerance / 5) << "a mesh much finer than asked for";
    }
}

TEST(TerrainMesh, TheBytesDoNotDependOnTheNumberOfThreads) {
  for (const Surface& s : kSmooth) {
    const Terrain t = rough_terrain(s.kind, s.cross, 30, 30, 3, 3);
    const TriangleMesh one = mesh_terrain(t, {.tolerance = 0.1}, {.threads = 1}),
                       two = mesh_terrain(t, {.tolerance = 0.1}, {.threads = 2});
    EXPECT_EQ(one.triangles, two.triangles);
    EXPECT_EQ(one.positions, two.positions);
    EXPECT_EQ(one.normals, two.normals);
    EXPECT_GT(one.triangles.size(), 20000U);
  }
}

TEST(TerrainMesh, BordersOfModelsThatShareAnEdgeMeetVertexToVertex) {
  // Two halves of one terrain, cut along a row of vertices: the cuts along it depend on its own data alone.
  for (const Surface& s : {kSmooth[0], kSmooth[1]}) {
    const Terrain whole = rough_terrain(s.kind, s.cross, 6, 5, 5, 5);
    const auto half = [&](bool south) {
      Tin tin;
      std::vector<Vec2> gradients;
      const std::size_t first = south ? 12 : 0, count = 18;  // rows 2..4, rows 0..2
      for (std::size_t v = first; v < first + count; ++v) {
        tin.points.push_back(whole.tin.points[v]);
        tin.heights.push_back(whole.tin.heights[v]);
        gradients.push_back(whole.gradients[v]);
      }
      for (auto v : whole.tin.triangles) {
        if (std::any_of(v.begin(), v.end(), [&](std::uint32_t k) { return k < first || k >= first + count; })) continue;
        for (std::uint32_t& k : v) k -= static_cast<std::uint32_t>(first);
        tin.triangles.push_back(v);
      }
      build_neighbors(tin);
      Terrain t =
          make_terrain(tin, Georef{}, {.surface = s.kind, .gradients = GradientKind::given, .given = gradients});
      return mesh_terrain(t, {.tolerance = 0.02});
    };
    const TriangleMesh north = half(false), south = half(true);
    const auto border = [&](const TriangleMesh& mesh) {
      std::vector<std::array<double, 3>> points;
      for (const Vec3& p : mesh.positions)
        for (std::size_t c = 12; c + 1 < 18; ++c) {  // on the polyline of row 2
          const Vec2 a = whole.tin.points[c], b = whole.tin.points[c + 1], q{p.x, p.y};
          if (std::abs(cross(b - a, q - a)) < 1e-9 && dot(q - a, b - a) > 0 && dot(q - b, a - b) > 0)
            points.push_back({p.x, p.y, p.z});
        }
      std::sort(points.begin(), points.end());
      return points;
    };
    EXPECT_EQ(border(north), border(south));
    EXPECT_GT(border(north).size(), 20U);
  }
}

TEST(TerrainMesh, TrianglesWhoseCentreIsVoidAreLeftOut) {
  for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
    Terrain t = sample_terrain({.kind = kind, .columns = 9, .rows = 9});
    t.grid.valid = Mask(t.grid.columns, t.grid.rows, true);
    for (int r = 7; r < 16; ++r)
      for (int c = 5; c < 19; ++c) t.grid.valid.set(c, r, false);
    const TriangleMesh mesh = mesh_terrain(t, {.tolerance = 30});
    for (const auto& v : mesh.triangles) {
      const Vec3 centre = (mesh.positions[v[0]] + mesh.positions[v[1]] + mesh.positions[v[2]]) / 3;
      EXPECT_TRUE(t.grid.has_data({centre.x, centre.y}));
    }
    std::vector<bool> used(mesh.positions.size(), false);
    for (const auto& v : mesh.triangles)
      for (const std::uint32_t k : v) used[k] = true;
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0) << "a vertex of no triangle";
    EXPECT_NEAR(area_of(mesh), area_of(t.tin) - 9 * 14, 40)
        << "nine rows of twoteen cells, up to the triangles along their border";
    expect_no_cracks(mesh);
    EXPECT_GT(check_mesh(mesh).boundary_edges, 32U) << "the border and the hole's";
    t.grid.valid = {};
    EXPECT_NEAR(area_of(mesh_terrain(t, {.tolerance = 30})), area_of(t.tin), 1e-9);
  }
}

TEST(TerrainMesh, ToleranceDefaultsToAThousandthOfTheRange) {
  const Terrain t = rough_terrain(SurfaceKind::powell_sabin, CrossDerivative::perpendicular, 4, 4, 1, 2);
  const auto [low, high] = std::minmax_element(t.tin.heights.begin(), t.tin.heights.end());
  EXPECT_DOUBLE_EQ(mesh_tolerance(t, {}), (*high - *low) / 1000);
  EXPECT_EQ(mesh_tolerance(t, {.tolerance = 2}), 2);
  for (const double bad :
       {-1.0, 1e-14, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(mesh_terrain(t, {.tolerance = bad}), UsageError) << bad;
  Terrain flat = t;
  std::fill(flat.tin.heights.begin(), flat.tin.heights.end(), 100.0);
  std::fill(flat.gradients.begin(), flat.gradients.end(), Vec2{});
  EXPECT_EQ(mesh_terrain(flat).triangles.size(), flat.tin.triangle_count() * 6);
}

TEST(TerrainMesh, DegreesHaveNoOffset) {
  Terrain t = sample_terrain({.kind = SurfaceKind::linear});
  t.georef.geographic = true;
  t.georef.scale_x = 80000;
  EXPECT_EQ(mesh_terrain(t).offset, Vec3{});
}

}  // namespace
}  // namespace retalho
