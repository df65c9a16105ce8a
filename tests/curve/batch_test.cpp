// Batches: the same points as one at a time.
#include "retalho/curve/batch.h"

#include <gtest/gtest.h>

#include "curve/support.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

TEST(Batch, AgreesWithOneAtATime) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const std::size_t n : {1U, 7U, 64U, 3000U}) {
    std::vector<double> t(n), x(n), y(n), z(n);
    for (double& v : t) v = unit(random);
    t[0] = 1;
    const Curve c = test::random_curve(random, 3, 3);
    evaluate_cubic({c.points[0], c.points[1], c.points[2], c.points[3]}, t, x, y, z);
    for (std::size_t i = 0; i < n; ++i) EXPECT_LT(norm(evaluate(c, t[i]) - Vec3{x[i], y[i], z[i]}), 1e-14);
    BSpline s;
    s.dimension = 3;
    double knot = 0;
    for (int i = 0; i < 64; ++i) s.points.push_back(test::random_point(random));
    s.knots.assign(4, 0);
    for (int i = 0; i < 60; ++i) s.knots.push_back(knot += 0.001 + unit(random) * (i % 5 == 0 ? 10 : 0.1));
    s.knots.insert(s.knots.end(), 3, 0);
    s.knots.resize(68);
    for (std::size_t i = 64; i < 68; ++i) s.knots[i] = s.knots[63] + 1;
    const CubicEvaluator many(to_curve(s));
    std::vector<double> u(n);
    for (std::size_t i = 0; i < n; ++i)
      u[i] = i % 10 == 0 ? s.knots[3 + i % 61] : s.begin() + t[i] * (s.end() - s.begin());
    many(u, x, y, z);
    for (std::size_t i = 0; i < n; ++i) EXPECT_LT(norm(evaluate(s, u[i]) - Vec3{x[i], y[i], z[i]}), 1e-12);
    std::vector<double> short_one(n + 1);
    EXPECT_THROW(many(u, short_one, y, z), UsageError);
  }
  EXPECT_THROW(CubicEvaluator(test::random_curve(random, 5, 2)), UsageError);
}

}  // namespace
}  // namespace retalho
