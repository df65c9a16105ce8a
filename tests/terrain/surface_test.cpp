// The properties of the surfaces, in the words of their headers.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "retalho/terrain/evaluate.h"
#include "synthetic.h"

namespace retalho {
namespace {

using namespace test;

struct Variant {
  SurfaceKind kind;
  CrossDerivative rule;
  const char* name;
};
constexpr Variant kPowellSabin{SurfaceKind::powell_sabin, CrossDerivative::perpendicular, "powell-sabin"};
constexpr Variant kPerpendicular{SurfaceKind::clough_tocher, CrossDerivative::perpendicular,
                                 "clough-tocher perpendicular"};
constexpr Variant kCubic{SurfaceKind::clough_tocher, CrossDerivative::cubic, "clough-tocher cubic"};
constexpr Variant kSmooth[] = {kPowellSabin, kPerpendicular, kCubic};

Terrain with_gradients(Tin tin, const Variant& variant, std::vector<Vec2> gradients) {
  return make_terrain(std::move(tin), Georef{},
                      {.surface = variant.kind,
                       .gradients = GradientKind::given,
                       .cross_derivative = variant.rule,
                       .given = std::move(gradients)});
}

std::vector<Vec2> random_gradients(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> slope(-5, 5);
  std::vector<Vec2> g(n);
  for (Vec2& v : g) v = {slope(random), slope(random)};
  return g;
}

/// Random heights in [0, 1] and gradients of size 5: far rougher than any terrain.
Terrain rough(std::vector<Vec2> points, const Variant& variant, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Tin tin = delaunay(points, [&](Vec2) { return unit(random); });
  const std::size_t n = tin.vertex_count();
  return with_gradients(std::move(tin), variant, random_gradients(n, seed + 1));
}

TEST(Surfaces, VertexHeightsAndGradientsAreReproduced) {
  for (const Variant& variant : kSmooth) {
    const Terrain terrain = rough(jittered_points(15, 1), variant, 2);
    const EdgeTable edges = build_edges(terrain.tin);
    std::array<TerrainPatch, 6> patches;
    int corners = 0;
    for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
      const int n = triangle_patches(terrain, edges, t, patches);
      for (const std::uint32_t v : terrain.tin.triangles[t])
        for (int k = 0; k < n; ++k)
          for (const Vec2 corner : patches[static_cast<std::size_t>(k)].corners)
            if (corner == terrain.tin.points[v]) {
              const Jet jet = jet_of(patches[static_cast<std::size_t>(k)], corner);
              EXPECT_NEAR(jet.value, terrain.tin.heights[v], 1e-13) << variant.name;
              EXPECT_LT(norm(jet.gradient - terrain.gradients[v]), 1e-10) << variant.name;
              ++corners;
            }
    }
    EXPECT_EQ(corners, static_cast<int>(6 * terrain.tin.triangle_count())) << variant.name;
  }
}

/// C0 and C1 across every inner and outer edge, sub-edges included.
void expect_smooth(const Terrain& terrain, const char* name, double range) {
  const EdgeTable edges = build_edges(terrain.tin);
  struct Side {
    TerrainPatch patch;
    double height;  // of the whole triangle: its smallest
  };
  std::map<std::array<double, 4>, std::vector<Side>> sides;  // by the two ends' coordinates, bit for bit
  std::array<TerrainPatch, 6> patches;
  for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
    const auto& v = terrain.tin.triangles[t];
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      longest = std::max(longest, norm(terrain.tin.points[v[k]] - terrain.tin.points[v[(k + 1) % 3]]));
    const double area2 =
        cross(terrain.tin.points[v[1]] - terrain.tin.points[v[0]], terrain.tin.points[v[2]] - terrain.tin.points[v[0]]);
    const int n = triangle_patches(terrain, edges, t, patches);
    for (int k = 0; k < n; ++k) {
      const TerrainPatch& patch = patches[static_cast<std::size_t>(k)];
      for (std::size_t c = 0; c < 3; ++c) {
        Vec2 a = patch.corners[c], b = patch.corners[(c + 1) % 3];
        if (std::pair(b.x, b.y) < std::pair(a.x, a.y)) std::swap(a, b);
        sides[{a.x, a.y, b.x, b.y}].push_back({patch, area2 / longest});
      }
    }
  }
  std::size_t shared = 0;
  double worst_gap = 0, worst_jump = 0;
  for (const auto& [ends, both] : sides) {
    ASSERT_LE(both.size(), 2U);
    if (both.size() != 2) continue;
    ++shared;
    for (const double f : {0.0, 0.13, 0.5, 0.77, 1.0}) {
      const Vec2 p = Vec2{ends[0], ends[1]} + f * Vec2{ends[2] - ends[0], ends[3] - ends[1]};
      const Jet one = jet_of(both[0].patch, p), other = jet_of(both[1].patch, p);
      worst_gap = std::max(worst_gap, std::abs(one.value - other.value));
      worst_jump = std::max(worst_jump, norm(one.gradient - other.gradient) * std::min(both[0].height, both[1].height));
    }
  }
  const std::size_t border = [&] {
    std::size_t count = 0;
    for (const auto& t : edges.triangles) count += t[1] == kNone;
    return count;
  }();
  const std::size_t pieces =
      terrain.tin.triangle_count() * static_cast<std::size_t>(patches_per_triangle(terrain.kind));
  const std::size_t border_pieces = border * (terrain.kind == SurfaceKind::powell_sabin ? 2 : 1);
  EXPECT_EQ(shared, (3 * pieces - border_pieces) / 2) << name;  // no edge was missed
  EXPECT_LE(worst_gap, 1e-10 * range) << name;
  EXPECT_LE(worst_jump, 1e-10 * range) << name;
}

TEST(Surfaces, ValueAndGradientAgreeAcrossEveryEdge) {
  for (const Variant& variant : kSmooth) {
    expect_smooth(rough(jittered_points(21, 3), variant, 4), variant.name, 1);
    expect_smooth(rough(random_points(400, 5), variant, 6), variant.name, 1);  // with slivers
  }
}

TEST(Surfaces, NeighboursHaveTheSameOrdinatesOnASharedEdgeToTheLastBit) {
  for (const Variant& variant : kSmooth) {
    const Terrain terrain = rough(random_points(300, 7), variant, 8);
    const EdgeTable edges = build_edges(terrain.tin);
    // Ordinates and corners along each whole edge, from the lower vertex, as each side writes them.
    std::map<std::uint32_t, std::vector<double>> seen;
    std::array<TerrainPatch, 6> patches;
    std::size_t compared = 0;
    for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
      triangle_patches(terrain, edges, t, patches);
      for (std::size_t k = 0; k < 3; ++k) {
        std::vector<double> along;
        if (variant.kind == SurfaceKind::powell_sabin) {
          const auto &first = patches[2 * k], &second = patches[2 * k + 1];
          ASSERT_EQ(first.corners[2], second.corners[1]);
          along = {first.ordinates[3], first.ordinates[4], first.ordinates[5], second.ordinates[4],
                   second.ordinates[5]};
          along.insert(along.begin() + 2, {first.corners[2].x, first.corners[2].y});
          if (terrain.tin.triangles[t][(k + 1) % 3] > terrain.tin.triangles[t][(k + 2) % 3]) {
            std::swap(along[0], along[6]);
            std::swap(along[1], along[5]);
          }
        } else {
          const auto& o = patches[k].ordinates;
          along = {o[0], o[1], o[3], o[6]};
          if (terrain.tin.triangles[t][(k + 1) % 3] > terrain.tin.triangles[t][(k + 2) % 3])
            std::reverse(along.begin(), along.end());
        }
        const auto [place, fresh] = seen.emplace(edges.of_triangle[t][k], along);
        if (fresh) continue;
        EXPECT_EQ(place->second, along) << variant.name;
        ++compared;
      }
    }
    EXPECT_GT(compared, 500U);
  }
}

double largest_error(const Terrain& terrain, const HeightFunction& f) {
  const TerrainEvaluator evaluator(terrain);
  double worst = 0;
  int inside = 0;
  for (int j = 0; j <= 60; ++j)
    for (int i = 0; i <= 60; ++i) {
      const Vec2 p{i / 60.0, j / 60.0};
      const double z = evaluator.value(p);
      if (std::isnan(z)) continue;
      ++inside;
      worst = std::max(worst, std::abs(z - f(p)));
    }
  EXPECT_EQ(inside, 61 * 61);
  return worst;
}

TEST(Surfaces, QuadraticsAreExact) {
  const HeightFunction f = [](Vec2 p) { return 1 + 2 * p.x - 3 * p.y + 4 * p.x * p.x - 5 * p.x * p.y + 6 * p.y * p.y; };
  const auto gradient = [](Vec2 p) { return Vec2{2 + 8 * p.x - 5 * p.y, -3 - 5 * p.x + 12 * p.y}; };
  for (const Variant& variant : kSmooth) {
    Tin tin = delaunay(random_points(400, 9), f);
    std::vector<Vec2> g;
    for (const Vec2 p : tin.points) g.push_back(gradient(p));
    EXPECT_LT(largest_error(with_gradients(tin, variant, g), f), 1e-12) << variant.name;
    // With the gradients that the two-ring quadratic finds by itself.
    const Terrain fitted =
        make_terrain(tin, Georef{},
                     {.surface = variant.kind, .gradients = GradientKind::quadratic, .cross_derivative = variant.rule});
    EXPECT_LT(largest_error(fitted, f), 1e-10) << variant.name;
  }
}

TEST(Surfaces, CubicsAreExactForTheCubicVariantOnly) {
  const HeightFunction f = [](Vec2 p) {
    return p.x * p.x * p.x - 2 * p.x * p.x * p.y + 3 * p.x * p.y * p.y + p.y * p.y * p.y - p.x * p.y;
  };
  const auto gradient = [](Vec2 p) {
    return Vec2{3 * p.x * p.x - 4 * p.x * p.y + 3 * p.y * p.y - p.y,
                -2 * p.x * p.x + 6 * p.x * p.y + 3 * p.y * p.y - p.x};
  };
  Tin tin = delaunay(jittered_points(20, 10), f);
  std::vector<Vec2> g;
  for (const Vec2 p : tin.points) g.push_back(gradient(p));
  const Terrain cubic = with_gradients(tin, kCubic, g);
  EXPECT_EQ(std::count(cubic.edge_fallback.begin(), cubic.edge_fallback.end(), 1),
            0);  // else the rule is not the cubic one
  EXPECT_LT(largest_error(cubic, f), 1e-12);
  EXPECT_GT(largest_error(with_gradients(tin, kPerpendicular, g), f), 1e-6);
}

TEST(Surfaces, PlanesAreExactWithEveryEstimate) {
  const HeightFunction f = [](Vec2 p) { return 3 - 2 * p.x + 7 * p.y; };
  for (const Variant& variant : kSmooth)
    for (const GradientKind kind : {GradientKind::normals, GradientKind::quadratic, GradientKind::network}) {
      const Terrain terrain =
          make_terrain(delaunay(random_points(200, 11), f), Georef{},
                       {.surface = variant.kind, .gradients = kind, .cross_derivative = variant.rule});
      EXPECT_LT(largest_error(terrain, f), 1e-11) << variant.name << " " << gradient_name(kind);
    }
}

TEST(Surfaces, FrankeAtTenThousandPoints) {
  Tin tin = delaunay(random_points_with_border(10000, 12), franke);
  const std::map<std::string, double> most{
      {kPowellSabin.name, 2.5e-5}, {kPerpendicular.name, 1.6e-5}, {kCubic.name, 1.6e-5}};
  for (const Variant& variant : kSmooth) {
    const Terrain terrain =
        make_terrain(tin, Georef{},
                     {.surface = variant.kind, .gradients = GradientKind::quadratic, .cross_derivative = variant.rule});
    const TerrainEvaluator evaluator(terrain);
    const int n = 1000;
    std::vector<double> z(static_cast<std::size_t>(n * n));
    evaluator.grid_values({0.0005, 0.9995}, {0.001, 0.001}, n, n, z);
    double sum = 0;
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c) {
        const double e = z[static_cast<std::size_t>(r * n + c)] - franke({0.0005 + c * 0.001, 0.9995 - r * 0.001});
        ASSERT_FALSE(std::isnan(e));
        sum += e * e;
      }
    const double rmse = std::sqrt(sum / (n * n));
    EXPECT_LE(rmse, most.at(variant.name)) << variant.name;
    std::printf("Franke, 10,000 points, quadratic gradients, %s: RMSE %.3g\n", variant.name, rmse);
  }
}

}  // namespace
}  // namespace retalho
