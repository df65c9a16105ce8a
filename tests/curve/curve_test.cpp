// The hub and its exact conversions.
#include "retalho/curve/curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <random>

#include "curve/support.h"
#include "retalho/curve/bspline.h"
#include "retalho/curve/convert.h"
#include "retalho/curve/edit.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::random_curve;
using test::random_point;

TEST(Curve, JetMatchesDifferences) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 500; ++round) {
    const Curve curve = random_curve(random, 1 + round % 7, 3, round % 2 == 1);
    const double t = 0.1 + 0.8 * (round % 100) / 100.0, h = 1e-4;
    const CurveSegment s = curve.segment(0);
    const CurveJet jet = evaluate_jet(s, t), before = evaluate_jet(s, t - h), after = evaluate_jet(s, t + h);
    EXPECT_LT(norm(jet.point - evaluate(s, t)), 1e-13);
    EXPECT_LT(norm(jet.first - (after.point - before.point) / (2 * h)), 1e-4 * (1 + norm(jet.third)));
    EXPECT_LT(norm(jet.second - (after.first - before.first) / (2 * h)), 1e-3 * (1 + norm(jet.third)) * 10);
    EXPECT_LT(norm(jet.third - (after.second - before.second) / (2 * h)), 2e-2 * (1 + norm(jet.third)) * 10);
  }
}

TEST(Curve, SplitElevateReverseAndTransformKeepEveryPoint) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0.05, 0.95);
  for (int round = 0; round < 500; ++round) {
    Curve curve = random_curve(random, 1 + round % 6, 3, round % 3 == 0);
    const Curve more = random_curve(random, 1 + round % 4, 3, round % 3 == 0);
    curve.append(more.points, 0.5, more.weights);
    const double u = curve.begin() + unit(random) * (curve.end() - curve.begin());
    const auto [head, tail] = split(curve, u);
    const Curve high = elevate(curve, 8), back = reverse(curve), parts = refine(curve, std::array{u, 0.3});
    const Curve moved = transform(curve, {{{0, -2, 0, 1}, {1, 0, 0.5, 2}, {0, 0, 3, -1}}});
    EXPECT_EQ(head.end(), u);
    for (int k = 0; k <= 20; ++k) {
      const double v = curve.begin() + (curve.end() - curve.begin()) * k / 20;
      const Vec3 p = evaluate(curve, v);
      EXPECT_LT(norm(evaluate(v < u ? head : tail, v) - p), 1e-12);
      EXPECT_LT(norm(evaluate(high, v) - p), 1e-12);
      EXPECT_LT(norm(evaluate(parts, v) - p), 1e-12);
      EXPECT_LT(norm(evaluate(back, curve.begin() + curve.end() - v, Side::left) - p), 1e-12);
      EXPECT_LT(norm(evaluate(moved, v) - Vec3{-2 * p.y + 1, p.x + 0.5 * p.z + 2, 3 * p.z - 1}), 1e-12);
      EXPECT_LT(norm(evaluate(hodograph(curve), v) - evaluate_jet(curve, v).first),
                1e-10 * (1 + norm(evaluate_jet(curve, v).first)));
    }
  }
}

TEST(Curve, ReductionStaysWithinItsError) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 300; ++round) {
    const Curve curve = random_curve(random, 3 + round % 5, 2);
    const Reduction low = reduce(curve, 2 + round % 2);
    double worst = 0;
    for (int k = 0; k <= 200; ++k)
      worst = std::max(worst, norm(evaluate(low.curve, k / 200.0) - evaluate(curve, k / 200.0)));
    EXPECT_LE(worst, low.error * (1 + 1e-9) + 1e-14);
    EXPECT_EQ(low.curve.points.front(), curve.points.front());
    EXPECT_EQ(low.curve.points.back(), curve.points.back());
    const Reduction exact = reduce(elevate(curve, curve.degree() + 2), curve.degree());
    EXPECT_LT(exact.error, 1e-12);
  }
}

TEST(Curve, HermiteAndPowerRoundTrips) {
  std::mt19937_64 random(4);
  for (int round = 0; round < 300; ++round) {
    const std::vector<Vec3> points = {random_point(random), random_point(random), random_point(random)};
    const std::vector<Vec3> tangents = {random_point(random), random_point(random), random_point(random)};
    const std::vector<Vec3> seconds = {random_point(random), random_point(random), random_point(random)};
    const std::vector<double> breaks = {1, 1.5, 4};
    for (const Curve& curve :
         {from_hermite(points, tangents, 3, breaks), from_hermite_quintic(points, tangents, seconds, 3, breaks)}) {
      const HermiteData data = to_hermite(curve);
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t j = (i + 1) / 2;
        EXPECT_LT(norm(data.points[i] - points[j]), 1e-14);
        EXPECT_LT(norm(data.tangents[i] - tangents[j]), 1e-13);
        if (curve.degree() == 5) {
          EXPECT_LT(norm(data.seconds[i] - seconds[j]), 1e-11);
        }
      }
    }
    const std::vector<Vec3> power = {random_point(random), random_point(random), random_point(random),
                                     random_point(random)};
    const Curve curve = from_power(power, -1, 2, 3);
    const std::vector<Vec3> back = to_power(curve.segment(0));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(norm(back[i] - power[i]), 1e-12);
    const double v = 0.7;
    EXPECT_LT(norm(evaluate(curve, v) - (power[0] + (v + 1) * (power[1] + (v + 1) * (power[2] + (v + 1) * power[3])))),
              1e-12);
  }
}

/// The slides' basis functions, slide 15, with the printed slip of slide 14 (row 2 of M_H) mended.
TEST(Curve, HermiteBasisOfSlide15) {
  const std::vector<Vec3> p = {{0, 0, 0}, {3, 1, 0}}, r = {{1, 4, 0}, {2, -3, 0}};
  const Curve curve = from_hermite(p, r, 2);
  for (int k = 0; k <= 10; ++k) {
    const double t = k / 10.0, t2 = t * t, t3 = t2 * t;
    const Vec3 q =
        (2 * t3 - 3 * t2 + 1) * p[0] + (-2 * t3 + 3 * t2) * p[1] + (t3 - 2 * t2 + t) * r[0] + (t3 - t2) * r[1];
    EXPECT_LT(norm(evaluate(curve, t) - q), 1e-15);
  }
}

TEST(Curve, CatmullRomPassesThroughItsPoints) {
  std::mt19937_64 random(5);
  std::vector<Vec3> points;
  points.reserve(7);
  for (int i = 0; i < 7; ++i) points.push_back(random_point(random));
  for (const double power : {0.0, 0.5, 1.0})
    for (const bool closed : {false, true}) {
      const Curve curve = catmull_rom(points, 3, closed, power);
      EXPECT_EQ(curve.segment_count(), closed ? 7U : 6U);
      for (std::size_t i = 0; i < curve.segment_count(); ++i) EXPECT_EQ(curve.segment(i).points.front(), points[i]);
    }
}

BSpline random_bspline(std::mt19937_64& random, int degree, std::size_t n, bool rational) {
  std::uniform_real_distribution<double> unit(0, 1);
  BSpline s;
  s.degree = degree;
  s.dimension = 3;
  const auto p = static_cast<std::size_t>(degree);
  std::vector<double> inner;
  for (std::size_t i = 0; i + p + 1 < n; ++i) inner.push_back(unit(random));
  std::sort(inner.begin(), inner.end());
  if (inner.size() > 3) inner[1] = inner[2];  // a double knot
  s.knots.assign(p + 1, 0);
  s.knots.insert(s.knots.end(), inner.begin(), inner.end());
  s.knots.insert(s.knots.end(), p + 1, 1);
  for (std::size_t i = 0; i < n; ++i) s.points.push_back(random_point(random));
  if (rational)
    for (std::size_t i = 0; i < n; ++i) s.weights.push_back(0.3 + unit(random));
  std::sort(s.knots.begin(), s.knots.end());
  return s;
}

TEST(BSplines, BezierFormInsertionAndRemovalAreExact) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0.02, 0.98);
  int removed = 0;
  for (int round = 0; round < 400; ++round) {
    const BSpline s = random_bspline(random, 2 + round % 4, 8 + static_cast<std::size_t>(round % 3), round % 3 == 0);
    const Curve curve = to_curve(s);
    const double u = unit(random);
    const BSpline with = insert_knot(s, u);
    const KnotRemoval without = remove_knot(with, u, 1e-8);
    EXPECT_TRUE(without.removed);
    EXPECT_LT(without.error, 1e-10);
    removed += without.removed;
    for (int k = 0; k <= 50; ++k) {
      const double v = k / 50.0;
      const Vec3 p = evaluate(s, v);
      EXPECT_LT(norm(evaluate(curve, v, k == 50 ? Side::left : Side::right) - p), 1e-12);
      EXPECT_LT(norm(evaluate(with, v) - p), 1e-12);
      if (without.removed) {
        EXPECT_LT(norm(evaluate(without.spline, v) - p), 1e-7);
      }
    }
    // back from the chain: the same knots come off again
    const BSpline back = to_bspline(curve, 1e-9);
    EXPECT_EQ(back.points.size(), s.points.size());
    for (int k = 0; k <= 50; ++k) EXPECT_LT(norm(evaluate(back, k / 50.0) - evaluate(s, k / 50.0)), 1e-7);
    // a knot that is needed stays
    EXPECT_FALSE(remove_knot(s, s.knots[s.points.size() - 1], 1e-9).removed);
  }
  EXPECT_EQ(removed, 400);
}

TEST(BSplines, UnclampedAndClosed) {
  std::mt19937_64 random(7);
  std::vector<Vec3> points;
  points.reserve(6);
  for (int i = 0; i < 6; ++i) points.push_back(random_point(random));
  const BSpline s = closed_bspline(points, 3, 3);
  const Curve curve = to_curve(s);
  EXPECT_TRUE(curve.closed);
  EXPECT_EQ(curve.segment_count(), 6U);
  for (int k = 0; k <= 60; ++k) {
    const double v = s.begin() + (s.end() - s.begin()) * k / 60;
    EXPECT_LT(norm(evaluate(curve, v, Side::left) - evaluate(s, v)), 1e-12);
  }
}

TEST(BSplines, AFullCircleIsExact) {
  const double w = std::sqrt(0.5);
  const BSpline circle{
      2,
      2,
      {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4},
      {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}, {1, -1, 0}, {1, 0, 0}},
      {1, w, 1, w, 1, w, 1, w, 1}};
  const Curve curve = to_curve(circle);
  for (int k = 0; k <= 400; ++k) EXPECT_NEAR(norm(evaluate(curve, k / 100.0)), 1, 1e-15);
}

/// A spline with knots that may be repeated, clamped or not, rational or not.
BSpline random_spline(test::Random& random) {
  BSpline s;
  s.degree = static_cast<int>(1 + random.index(5));
  s.dimension = 3;
  const std::size_t p = static_cast<std::size_t>(s.degree), n = p + 1 + random.index(9);
  const bool clamped = random.chance(0.5), rational = random.chance(0.5);
  for (std::size_t i = 0; i < n; ++i) {
    s.points.push_back(test::random_point(random.engine()));
    if (rational) s.weights.push_back(random.uniform(0.2, 2));
  }
  double u = 0;
  std::size_t same = 0;
  while (s.knots.size() < n + p + 1) {
    const std::size_t k = s.knots.size();
    const bool again = k > 0 && (clamped && (k <= p || k > n) ? true : k != n && same < p && random.chance(0.3));
    if (!again) u += random.uniform(0.1, 1);
    same = again ? same + 1 : 1;
    s.knots.push_back(u);
  }
  return s;
}

// The chain of a B-spline is what knots put in one by one make of it, to the bit, and evaluates to the same points.
TEST(BSplines, TheChainIsThatOfKnotsInsertedOneByOne) {
  test::Random random;
  std::size_t cases = 0;
  while (cases < 10'000U * static_cast<std::size_t>(test::soak())) {
    const BSpline s = random_spline(random);
    if (!(s.begin() < s.end())) continue;
    ++cases;
    const Curve chain = to_curve(s);
    BSpline full = s;
    const auto p = static_cast<std::ptrdiff_t>(s.degree);
    for (const double u : s.knots)
      if (u > s.begin() && u < s.end())
        while (std::count(full.knots.begin(), full.knots.end(), u) < p) full = insert_knot(full, u);
    const Curve twin = to_curve(full);
    ASSERT_EQ(chain.breaks, twin.breaks);
    ASSERT_EQ(chain.points.size(), twin.points.size());
    for (std::size_t k = 0; k < chain.points.size(); ++k) ASSERT_LE(norm(chain.points[k] - twin.points[k]), 1e-13) << k;
    for (int k = 0; k <= 8; ++k) {
      const double u = s.begin() + (s.end() - s.begin()) * k / 8;
      if (std::count(s.knots.begin(), s.knots.end(), u) > p) continue;  // a gap: either side's
      ASSERT_LE(norm(evaluate(chain, u) - evaluate(s, u)), 1e-11) << u;
    }
  }
}

// It takes time by the number of points, not by its square.
TEST(BSplines, LongOnesBecomeChainsInNoTime) {
  BSpline s;
  for (int k = 0; k < 300'000; ++k) s.points.push_back({k * 1.0, std::sin(k * 0.37), 0});
  s.knots = clamped_knots(s.points.size(), s.degree);
  const std::clock_t started = std::clock();
  const Curve chain = to_curve(s);
  EXPECT_EQ(chain.segment_count(), s.points.size() - 3);
  EXPECT_LT(static_cast<double>(std::clock() - started) / CLOCKS_PER_SEC, 20) << "0.1 s; an hour by the square";
}

}  // namespace
}  // namespace retalho
