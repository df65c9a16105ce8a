// Bernstein polynomials on a segment: identities against the power basis and a sum over the basis; roots against
// polynomials whose roots are known, double ones among them.
#include "retalho/bernstein/segment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace retalho {
namespace {

double basis_sum(const Bernstein& b, double t) {
  const int n = static_cast<int>(b.size()) - 1;
  double v = 0;
  for (int i = 0; i <= n; ++i)
    v += b[static_cast<std::size_t>(i)] * binomial(n, i) * std::pow(t, i) * std::pow(1 - t, n - i);
  return v;
}

Bernstein random_polynomial(std::mt19937_64& random, int degree) {
  std::normal_distribution<double> normal;
  Bernstein b(static_cast<std::size_t>(degree) + 1);
  for (double& v : b) v = normal(random);
  return b;
}

/// The polynomial with the given roots, in Bernstein form.
Bernstein with_roots(const std::vector<double>& where) {
  Bernstein b = {1};
  for (const double r : where) b = product(b, Bernstein{-r, 1 - r});
  return b;
}

TEST(Segment, EvaluatesHalvesDerivesElevatesAndMultiplies) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 2000; ++round) {
    const Bernstein a = random_polynomial(random, 1 + round % 9), b = random_polynomial(random, 1 + round % 5);
    const double t = unit(random), s = unit(random);
    EXPECT_NEAR(evaluate(a, t), basis_sum(a, t), 1e-13);
    Bernstein left(a.size()), right(a.size());
    subdivide(a, s, left, right);
    EXPECT_NEAR(evaluate(left, t), evaluate(a, s * t), 1e-13);
    EXPECT_NEAR(evaluate(right, t), evaluate(a, s + (1 - s) * t), 1e-13);
    EXPECT_NEAR(evaluate(elevate(a), t), evaluate(a, t), 1e-13);
    EXPECT_NEAR(evaluate(product(a, b), t), evaluate(a, t) * evaluate(b, t), 1e-12);
    EXPECT_NEAR(evaluate(sum(a, b, -2), t), evaluate(a, t) - 2 * evaluate(b, t), 1e-12);
    const double h = 1e-5;
    EXPECT_NEAR(evaluate(derivative(a), t), (evaluate(a, t + h) - evaluate(a, t - h)) / (2 * h), 1e-6);
    const auto [low, high] = bounds(a);
    EXPECT_LE(low, evaluate(a, t) + 1e-14);
    EXPECT_GE(high, evaluate(a, t) - 1e-14);
    const std::vector<double> power = bernstein_to_power(a);
    const Bernstein back = power_to_bernstein(power);
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(back[i], a[i], 1e-10);
  }
}

TEST(Segment, IntegralIsTheMean) {
  EXPECT_DOUBLE_EQ(integral(power_to_bernstein(std::vector<double>{0, 0, 3})), 1.0);
}

TEST(Segment, FindsRandomSimpleRoots) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  int checked = 0;
  for (int round = 0; round < 5000; ++round) {
    std::vector<double> want;
    want.reserve(5);
    for (int i = 0; i < 1 + round % 5; ++i) want.push_back(unit(random));
    std::sort(want.begin(), want.end());
    bool apart = true;
    for (std::size_t i = 1; i < want.size(); ++i) apart = apart && want[i] - want[i - 1] > 0.02;
    if (!apart) continue;
    ++checked;
    const auto found = roots(with_roots(want));
    ASSERT_EQ(found.size(), want.size());
    for (std::size_t i = 0; i < want.size(); ++i) {
      EXPECT_NEAR(found[i].t, want[i], 1e-9);
      EXPECT_TRUE(found[i].simple || found[i].t == 0 || found[i].t == 1);
    }
  }
  EXPECT_GT(checked, 3000);
}

TEST(Segment, LosesNoDoubleRoot) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.01, 0.99);
  for (int round = 0; round < 3000; ++round) {
    const double r = unit(random);
    const auto found = roots(with_roots(round % 2 ? std::vector<double>{r, r} : std::vector<double>{r, r, 1.7, -0.3}));
    ASSERT_FALSE(found.empty()) << r;
    double nearest = 1;
    for (const BernsteinRoot& root : found) nearest = std::min(nearest, std::abs(root.t - r));
    EXPECT_LT(nearest, 1e-6);
    EXPECT_LE(found.size(), 3U);
  }
}

TEST(Segment, EndsAndTheZeroPolynomial) {
  EXPECT_EQ(roots(Bernstein{0, 1, 2}).size(), 1U);
  EXPECT_EQ(roots(Bernstein{0, 1, 2})[0].t, 0);
  EXPECT_EQ(roots(Bernstein{2, 1, 0})[0].t, 1);
  EXPECT_EQ(roots(Bernstein{1, 1, 1}).size(), 0U);
  EXPECT_EQ(roots(Bernstein{0, 0, 0})[0].radius, 0.5);
  EXPECT_EQ(roots(Bernstein{-1, 1})[0].t, 0.5);
}

TEST(Segment, NothingIsReportedWithoutARootNearby) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 3000; ++round) {
    const Bernstein b = random_polynomial(random, 2 + round % 7);
    for (const BernsteinRoot& root : roots(b)) EXPECT_LT(std::abs(evaluate(b, root.t)), 1e-12);
    // and between the reported ones no change of sign
    int changes = 0;
    double previous = 0;
    for (int i = 0; i <= 400; ++i) {
      const double v = evaluate(b, i / 400.0);
      if (previous * v < 0) ++changes;
      previous = v;
    }
    EXPECT_GE(static_cast<int>(roots(b).size()), changes);
  }
}

}  // namespace
}  // namespace retalho
