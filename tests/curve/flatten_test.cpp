// Flattening: never above the tolerance in 100,000 random curves, few segments, vertices where they must be.
#include "retalho/curve/flatten.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "curve/support.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

TEST(Flatten, NeverAboveTheToleranceIn100000RandomCurves) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  std::size_t rough = 0;
  for (int round = 0; round < 100000; ++round) {
    const int dimension = 2 + round % 2;
    Curve c = test::random_curve(random, 2 + round % 5, dimension, round % 7 == 6);
    const double tolerance = std::pow(10.0, -3 + 2 * unit(random)), scale = std::pow(10.0, -3 + 6 * unit(random));
    for (Vec3& p : c.points) p = scale * p;
    const FlatCurve flat = flatten(c, tolerance * scale);
    EXPECT_LE(flat.bound, tolerance * scale);
    rough += flat.points.size() > 2;
    for (std::size_t i = 0; i + 1 < flat.points.size(); ++i)
      for (const double t : {0.21, 0.5, 0.79}) {
        const double u = flat.parameters[i] + t * (flat.parameters[i + 1] - flat.parameters[i]);
        worst = std::max(
            worst, test::segment_distance(evaluate(c, u), flat.points[i], flat.points[i + 1]) / (tolerance * scale));
      }
  }
  EXPECT_LE(worst, 1);
  EXPECT_GT(worst, 0.7);  // the bound is used, not wasted
  EXPECT_GT(rough, 90000U);
}

TEST(Flatten, SevenTenthsOfWangsSegments) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> ratio;
  for (int round = 0; round < 3000; ++round) {
    Curve c = test::random_curve(random, 2 + round % 5, 2);
    for (Vec3& p : c.points) p = 10.0 * p;
    const double tolerance = std::pow(10.0, -4 + 3 * unit(random));
    ratio.push_back(static_cast<double>(flatten(c, tolerance).points.size() - 1) /
                    static_cast<double>(wang_steps(c.segment(0), tolerance)));
  }
  std::sort(ratio.begin(), ratio.end());
  EXPECT_LE(ratio[ratio.size() / 2], 0.7);
  RecordProperty("median", std::to_string(ratio[ratio.size() / 2]));
}

TEST(Flatten, WangsBoundHolds) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 500; ++round) {
    const Curve c = test::random_curve(random, 2 + round % 5, 2);
    const std::size_t n = wang_steps(c.segment(0), 1e-2);
    for (std::size_t i = 0; i < n; ++i)
      for (const double t : {0.25, 0.5, 0.75}) {
        const double h = 1 / static_cast<double>(n), a = h * static_cast<double>(i);
        EXPECT_LE(test::segment_distance(evaluate(c, a + t * h), evaluate(c, a), evaluate(c, a + h)),
                  1e-2 * (1 + 1e-9));
      }
  }
}

TEST(Flatten, JoinsCuspsAndGapsAreVertices) {
  const FlatCurve cusp = flatten(make_bezier(std::vector<Vec2>{{0, 0}, {1, 1}, {0, 1}, {1, 0}}), 10);
  ASSERT_EQ(cusp.points.size(), 3U);
  EXPECT_NEAR(cusp.parameters[1], 0.5, 1e-12);
  Curve gap = make_bezier(std::vector<Vec2>{{0, 0}, {1, 0}});
  gap.append(std::vector<Vec3>{{2, 0, 0}, {3, 0, 0}});
  const FlatCurve two = flatten(gap, 1);
  EXPECT_EQ(two.starts, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_EQ(two.points.size(), 4U);
  EXPECT_THROW(flatten(gap, 0), UsageError);
  EXPECT_THROW(flatten(gap, std::nan("")), UsageError);
}

TEST(Flatten, HearsThatItIsToStop) {
  const Curve arch = make_bezier(std::vector<Vec2>{{0, 0}, {1, 2}, {3, 2}, {4, 0}});
  std::atomic<bool> stop = true;
  EXPECT_THROW(flatten(arch, 1e-14, {.cancel = &stop}), Interrupted);
}

}  // namespace
}  // namespace retalho
