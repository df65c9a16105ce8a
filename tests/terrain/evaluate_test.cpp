#include "retalho/terrain/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "brute_force.h"
#include "synthetic.h"

namespace retalho {
namespace {

using namespace test;

struct Choice {
  SurfaceKind kind;
  CrossDerivative rule;
};
const Choice kChoices[] = {{SurfaceKind::linear, CrossDerivative::perpendicular},
                           {SurfaceKind::powell_sabin, CrossDerivative::perpendicular},
                           {SurfaceKind::clough_tocher, CrossDerivative::perpendicular},
                           {SurfaceKind::clough_tocher, CrossDerivative::cubic}};

Terrain make(std::vector<Vec2> points, const Choice& choice) {
  return make_terrain(delaunay(points, franke), Georef{},
                      {.surface = choice.kind, .gradients = GradientKind::quadratic, .cross_derivative = choice.rule});
}

TEST(Evaluator, AgreesWithTheSlowObviousTwin) {
  for (const Choice& choice : kChoices) {
    const Terrain terrain = make(random_points(150, 1), choice);
    const TerrainEvaluator evaluator(terrain);
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> place(-0.05, 1.05);
    int outside = 0;
    for (int k = 0; k < 1500; ++k) {
      const Vec2 p{place(random), place(random)};
      const auto twin = find_piece(terrain, evaluator.edges(), p);
      const double z = evaluator.value(p);
      if (!twin) {
        ++outside;
        EXPECT_TRUE(std::isnan(z));
        EXPECT_FALSE(evaluator.valid(p));
        EXPECT_FALSE(evaluator.jet(p).has_value());
        continue;
      }
      EXPECT_NEAR(z, static_cast<double>(twin->value()), 1e-11);
      EXPECT_NEAR(evaluator.jet(p)->value, z, 1e-12);
    }
    EXPECT_GT(outside, 100);
    EXPECT_LT(outside, 500);
  }
}

TEST(Evaluator, RasterAndPointsAgree) {
  for (const Choice& choice : kChoices) {
    const Terrain terrain = make(random_points(500, 3), choice);
    const TerrainEvaluator evaluator(terrain);
    const Vec2 origin{-0.1, 1.1}, step{0.0123, 0.0097};
    const int columns = 100, rows = 125;
    std::vector<double> z(static_cast<std::size_t>(columns * rows)), again(z.size());
    std::vector<Vec2> gradients(z.size()), points;
    evaluator.grid_values(origin, step, columns, rows, z, gradients, {.threads = 2});
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) points.push_back({origin.x + c * step.x, origin.y - r * step.y});
    evaluator.values(points, again);
    for (std::size_t k = 0; k < z.size(); ++k) {
      const auto jet = evaluator.jet(points[k]);
      ASSERT_EQ(std::isnan(z[k]), !jet.has_value());
      ASSERT_EQ(std::isnan(again[k]), !jet.has_value());
      if (!jet) continue;
      EXPECT_NEAR(z[k], jet->value, 1e-11);
      EXPECT_NEAR(again[k], jet->value, 1e-11);
      EXPECT_LT(norm(gradients[k] - jet->gradient), 1e-8);
    }
  }
}

}  // namespace
}  // namespace retalho
