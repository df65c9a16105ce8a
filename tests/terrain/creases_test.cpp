// Surfaces with creases, in the words of terrain/creases.h.
#include "retalho/terrain/creases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/tin/breaklines.h"
#include "support/errors.h"
#include "support/support.h"
#include "synthetic.h"

namespace retalho {
namespace {

using test::jet_of;

using Line = std::vector<Vec3>;

struct Variant {
  SurfaceKind kind;
  CrossDerivative rule;
};
constexpr Variant kSmooth[] = {{SurfaceKind::powell_sabin, CrossDerivative::perpendicular},
                               {SurfaceKind::clough_tocher, CrossDerivative::perpendicular},
                               {SurfaceKind::clough_tocher, CrossDerivative::cubic}};

/// Two quadratics that meet along x = 0 with different slopes across it.
double folded(Vec2 p) {
  const double common = 3 + 0.5 * p.y - 0.25 * p.y * p.y;
  return p.x < 0 ? common + 2 * p.x + p.x * p.x - p.x * p.y : common - 3 * p.x + 0.5 * p.x * p.x;
}
Vec2 folded_gradient(Vec2 p) {
  const double y = 0.5 - 0.5 * p.y;
  return p.x < 0 ? Vec2{2 + 2 * p.x - p.y, y - p.x} : Vec2{-3 + p.x, y};
}

template <class Height>
Terrain surveyed(const Height& height, const std::vector<Vec2>& line, const Variant& variant, GradientKind gradients,
                 std::size_t count = 300) {
  test::Random random;
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 p{random.uniform(-1, 1), random.uniform(-1, 1)};
    points.push_back({p.x, p.y, height(p)});
  }
  Line breakline;
  for (const Vec2 p : line) breakline.push_back({p.x, p.y, height(p)});
  ConstrainedTin made = triangulate_points(points, std::vector<Line>{breakline});
  return make_terrain(std::move(made.tin), Georef{},
                      {.surface = variant.kind,
                       .gradients = gradients,
                       .cross_derivative = variant.rule,
                       .creases = std::move(made.edges)});
}

std::vector<Vec2> straight() {
  std::vector<Vec2> line;
  for (int k = -10; k <= 10; ++k) line.push_back({0, 0.12 * k});
  return line;
}
std::vector<Vec2> bent() {
  std::vector<Vec2> line;
  for (int k = -8; k <= 8; ++k) line.push_back({0.4 * std::sin(k), 0.1 * k});
  return line;
}

TEST(Creases, BothSidesAreReproducedExactly) {
  test::Random random;
  for (const Variant& variant : kSmooth) {
    const Terrain terrain = surveyed(folded, straight(), variant, GradientKind::quadratic);
    ASSERT_GT(terrain.creases.size(), 10U);
    EXPECT_GT(terrain.gradients.size(), terrain.tin.vertex_count() + 10);
    const TerrainEvaluator evaluator(terrain);
    int seen = 0;
    for (int k = 0; k < 4000; ++k) {
      const Vec2 p{random.uniform(-0.95, 0.95), random.uniform(-0.95, 0.95)};
      const std::optional<Jet> jet = evaluator.jet(p);
      if (!jet) continue;
      EXPECT_NEAR(jet->value, folded(p), 1e-9) << surface_name(variant.kind) << ' ' << p.x << ' ' << p.y;
      EXPECT_LT(norm(jet->gradient - folded_gradient(p)), 1e-7);
      ++seen;
    }
    EXPECT_GT(seen, 3000);
  }
}

TEST(Creases, WithoutThemTheFoldIsRounded) {
  // The test above can fail: the same points and edges as a smooth surface are off beside the fold.
  const Terrain creased = surveyed(folded, straight(), kSmooth[1], GradientKind::quadratic);
  const Terrain smooth = make_terrain(creased.tin, Georef{}, {.gradients = GradientKind::quadratic});
  const TerrainEvaluator with(creased), without(smooth);
  double worst_with = 0, worst_without = 0;
  for (double y = -0.9; y < 0.9; y += 0.01)
    for (const double x : {-0.02, 0.02}) {
      worst_with = std::max(worst_with, std::abs(with.value({x, y}) - folded({x, y})));
      worst_without = std::max(worst_without, std::abs(without.value({x, y}) - folded({x, y})));
    }
  EXPECT_LT(worst_with, 1e-9);
  EXPECT_GT(worst_without, 0.005);
}

/// The piece of a triangle that has most of the edge point `p` in it.
Jet jet_at(const Terrain& terrain, const EdgeTable& edges, std::uint32_t t, Vec2 p) {
  std::array<TerrainPatch, 6> patches;
  const int n = triangle_patches(terrain, edges, t, patches);
  int best = 0;
  double least = -1e300;
  for (int k = 0; k < n; ++k) {
    const auto& c = patches[static_cast<std::size_t>(k)].corners;
    const Barycentric u = TriangleFrame(c[0], c[1], c[2]).barycentric(p);
    const double smallest = std::min({u.r, u.s, u.t});
    if (smallest > least) least = smallest, best = k;
  }
  return jet_of(patches[static_cast<std::size_t>(best)], p);
}

TEST(Creases, HeightsAreContinuousEverywhereAndGradientsAwayFromBends) {
  test::Random random;
  const auto rough = [&](Vec2) { return random.uniform(0, 1); };
  for (const Variant& variant : kSmooth)
    for (int round = 0; round < 6; ++round) {
      const Terrain terrain = surveyed(rough, bent(), variant, GradientKind::normals, 120);
      ASSERT_FALSE(terrain.creases.empty());
      const EdgeTable edges = build_edges(terrain.tin);
      const std::set<std::uint32_t> creases(terrain.creases.begin(), terrain.creases.end());
      std::vector<char> touched(terrain.tin.vertex_count(), 0);
      for (const std::uint32_t e : creases)
        for (const std::uint32_t v : edges.vertices[e]) touched[v] = 1;
      int folds = 0;
      for (std::uint32_t e = 0; e < edges.vertices.size(); ++e) {
        const auto [t, o] = edges.triangles[e];
        if (o == kNone) continue;
        const auto [a, b] = edges.vertices[e];
        for (const double s : {0.1, 0.37, 0.8}) {
          const Vec2 p = terrain.tin.points[a] + s * (terrain.tin.points[b] - terrain.tin.points[a]);
          const Jet one = jet_at(terrain, edges, t, p), other = jet_at(terrain, edges, o, p);
          EXPECT_NEAR(one.value, other.value, 1e-10);
          const double jump = norm(one.gradient - other.gradient);
          if (creases.contains(e)) {
            folds += jump > 1e-3;
          } else if (!touched[a] && !touched[b]) {
            EXPECT_LT(jump, 1e-6 * (1 + norm(one.gradient)));
          }
        }
      }
      EXPECT_GT(folds, 10);
    }
}

TEST(Creases, OrdinatesOnSharedEdgesAreTheSameBits) {
  test::Random random;
  const auto rough = [&](Vec2) { return random.uniform(0, 1); };
  for (const Variant& variant : kSmooth) {
    const Terrain terrain = surveyed(rough, bent(), variant, GradientKind::normals, 200);
    const EdgeTable edges = build_edges(terrain.tin);
    const int per_edge = variant.kind == SurfaceKind::powell_sabin ? 2 : 1;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<double>> seen;
    std::array<TerrainPatch, 6> patches;
    int compared = 0;
    for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
      triangle_patches(terrain, edges, t, patches);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = terrain.tin.triangles[t][(k + 1) % 3], b = terrain.tin.triangles[t][(k + 2) % 3];
        std::vector<double> along;
        if (per_edge == 1) {
          const auto& o = patches[k].ordinates;  // corner i, corner j, centre: the side i-j
          along = {o[0], o[1], o[3], o[6]};
        } else {
          const auto &o = patches[2 * k].ordinates, &q = patches[2 * k + 1].ordinates;  // centre, i, split
          along = {o[3], o[4], o[5], q[3], q[4], q[5]};
        }
        if (a > b) std::reverse(along.begin(), along.end());
        const auto [it, fresh] = seen.try_emplace({std::min(a, b), std::max(a, b)}, along);
        if (fresh) continue;
        EXPECT_EQ(it->second, along);
        ++compared;
      }
    }
    EXPECT_GT(compared, 200);
  }
}

TEST(Creases, SectorsHaveTheirGradientsAndEndsHaveOne) {
  const Terrain terrain = surveyed(folded, {{0, -0.5}, {0, 0}, {0, 0.5}}, kSmooth[1], GradientKind::quadratic, 60);
  const std::vector<std::uint32_t> vertex =
      sector_vertices(terrain.tin, terrain.corner_gradients, terrain.gradients.size());
  const EdgeTable edges = build_edges(terrain.tin);
  std::vector<int> at(terrain.tin.vertex_count(), 0);
  for (const std::uint32_t e : terrain.creases)
    for (const std::uint32_t v : edges.vertices[e]) ++at[v];
  std::vector<int> sectors(terrain.tin.vertex_count(), 0);
  for (const std::uint32_t v : vertex) ++sectors[v];
  for (std::size_t v = 0; v < at.size(); ++v) EXPECT_EQ(sectors[v], std::max(1, at[v])) << v;
  EXPECT_EQ(coefficient_count(terrain), terrain.tin.vertex_count() + 2 * terrain.gradients.size());
}

TEST(Creases, ModelFilesKeepThem) {
  for (const Variant& variant : kSmooth) {
    const Terrain terrain = surveyed(folded, bent(), variant, GradientKind::quadratic, 80);
    const std::string bytes = encode_model(terrain);
    const Terrain back = std::get<Terrain>(decode_model(bytes));
    EXPECT_EQ(back.creases, terrain.creases);
    EXPECT_EQ(back.corner_gradients, terrain.corner_gradients);
    EXPECT_TRUE(back.gradients == terrain.gradients);
    EXPECT_EQ(encode_model(back), bytes);
    Terrain broken = terrain;
    broken.gradients.pop_back();
    EXPECT_TRUE(test::holds(test::words_of<BadInput>([&] { encode_model(broken); }), "gradients where the creases"));
    broken = terrain;
    std::swap(broken.creases[0], broken.creases[1]);
    EXPECT_TRUE(test::holds(test::words_of<BadInput>([&] { encode_model(broken); }), "not ascending"));
  }
}

TEST(Creases, RefusesEdgesThatAreNone) {
  Tin tin = surveyed(folded, straight(), kSmooth[1], GradientKind::normals, 20).tin;
  EXPECT_TRUE(test::holds(test::words_of<UsageError>([&] { make_terrain(tin, Georef{}, {.creases = {123456}}); }),
                          "crease 123456"));
}

}  // namespace
}  // namespace retalho
