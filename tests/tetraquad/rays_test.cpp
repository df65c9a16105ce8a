// Rays: roots of cubics against the slow way, hits of a sphere, no ray out of a closed surface.
#include "retalho/tetraquad/rays.h"

#include <gtest/gtest.h>

#include <cmath>

#include "retalho/bernstein/segment.h"
#include "retalho/tetraquad/fit.h"
#include "support/sample_tetraquad.h"
#include "support/support.h"
#include "tetraquad/shapes.h"

namespace retalho {
namespace {

Vec3 on_sphere(test::Random& random) {
  while (true) {
    const Vec3 d = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(d) < 1 && norm(d) > 0.1) return normalized(d);
  }
}

TEST(FirstRoot, IsTheSmallestOneThatSubdivisionFinds) {
  test::Random random(41);
  int found = 0;
  for (int n = 0; n < 20000; ++n) {
    std::array<double, 4> b;
    for (double& c : b) c = random.uniform(-1, 1);
    const double s = first_root(b);
    std::vector<BernsteinRoot> slow = roots(b);
    if (slow.empty()) {
      EXPECT_EQ(s, -1);
      continue;
    }
    if (!slow.front().simple) continue;
    ASSERT_GE(s, 0);
    EXPECT_NEAR(s, slow.front().t, 1e-9);
    ++found;
  }
  EXPECT_GT(found, 10000);
  EXPECT_EQ(first_root({1, 1, 1, 1}), -1);
  EXPECT_EQ(first_root({0, 0, 0, 0}), -1);
  EXPECT_NEAR(first_root({-1, -1.0 / 3, 1.0 / 3, 1}), 0.5, 1e-15);
}

TEST(FirstRoot, OfAGrazingRayToo) {
  // (s - m)^2 = d^2: two roots that lie ever closer together.
  double worst = 0;
  test::Random random(42);
  for (int n = 0; n < 20000; ++n) {
    const double m = random.uniform(0.3, 0.7), d = std::pow(10.0, random.uniform(-5, -1));
    const double a = m * m - d * d, b = a - m, c = a - 2 * m + 1;  // as a quadratic; then raised to degree 3
    const double s = first_root({a, (a + 2 * b) / 3, (2 * b + c) / 3, c});
    if (s < 0) continue;  // the dip is below the test's resolution
    worst = std::max(worst, std::abs(s - (m - d)));
  }
  EXPECT_LT(worst, 1e-9);
}

class RaysOnSplits : public testing::TestWithParam<TetSplit> {};
INSTANTIATE_TEST_SUITE_P(Both, RaysOnSplits, testing::Values(TetSplit::five, TetSplit::kuhn));

TEST_P(RaysOnSplits, HitASphereWhereItIs) {
  const TetraQuad surface = test::sample_tetraquad(GetParam(), 3);
  const TetraQuadField field(surface);
  test::Random random(42);
  for (const int halvings : {0, 6}) {
    const TetraQuadRays rays(field, halvings);
    for (int n = 0; n < 20000; ++n) {
      const Vec3 origin = 3 * on_sphere(random),
                 direction = random.uniform(0.1, 10) * (0.8 * on_sphere(random) - origin);
      const Vec3 m = origin - Vec3{0.1, 0, 0};
      const double a = norm2(direction), h = dot(m, direction), c = norm2(m) - 0.64, root2 = h * h - a * c;
      const auto hit = rays.first(origin, direction);
      if (root2 < 1e-9 * a) continue;  // grazing
      if (root2 < 0) {
        EXPECT_FALSE(hit);
        continue;
      }
      const double t = (-h - std::sqrt(root2)) / a;
      ASSERT_TRUE(hit.has_value());
      EXPECT_NEAR(hit->t, t, 1e-9);
      const Vec3 normal = normalized(field.gradient(hit->tet, hit->b).gradient);
      EXPECT_LT(norm(normal - (origin + t * direction - Vec3{0.1, 0, 0}) / 0.8), 1e-9);
      // Behind the hit: the far side.
      const auto next = rays.first(origin, direction, hit->t + 1e-6);
      ASSERT_TRUE(next.has_value());
      EXPECT_NEAR(next->t, (-h + std::sqrt(root2)) / a, 1e-9);
      EXPECT_FALSE(rays.first(origin, direction, 0, hit->t - 1e-6));
    }
  }
}

TEST_P(RaysOnSplits, NoneLeavesAClosedSurface) {
  const TetraQuad surface =
      fit_tetraquad(test::sphere_points(4000, {1, 2, 3}, 0.5), {.resolution = 8, .split = GetParam(), .bending = 0});
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  test::Random random(43);
  double worst = 0;
  for (int n = 0; n < 200000 * test::soak(); ++n) {
    const Vec3 origin = Vec3{1, 2, 3} + 0.3 * random.uniform() * on_sphere(random);
    Vec3 direction = on_sphere(random);
    if (n % 3 == 0) direction = {std::round(2 * direction.x), std::round(2 * direction.y), std::round(2 * direction.z)};
    if (norm2(direction) == 0) continue;
    const auto hit = rays.first(origin, direction);
    ASSERT_TRUE(hit.has_value()) << n;
    worst = std::max(worst, std::abs(norm(origin + hit->t * direction - Vec3{1, 2, 3}) - 0.5));
  }
  EXPECT_LT(worst, 1e-6);
}

TEST(Rays, FromFarAwayAndOnesThatHitNothing) {
  const TetraQuad surface = test::sample_tetraquad(TetSplit::five, 2);
  const TetraQuadField field(surface);
  const TetraQuadRays rays(field);
  const auto hit = rays.first({1e7, 0.01, 0.02}, {-1, 0, 0});
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(1e7 - hit->t, 0.1 + std::sqrt(0.64 - 0.0005), 1e-6);
  EXPECT_FALSE(rays.first({1e7, 0.01, 0.02}, {1, 0, 0}));
  EXPECT_FALSE(rays.first({0, 0, 0}, {0, 0, 0}));
  EXPECT_FALSE(rays.first({NAN, 0, 0}, {1, 0, 0}));
  EXPECT_FALSE(rays.first({5, 5, 5}, {1, 0, 0}));
}

}  // namespace
}  // namespace retalho
