// Lengths, nearest points, curvature, areas: analytic truth, and dense sampling as the slow twin.
#include "retalho/curve/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "curve/support.h"
#include "retalho/curve/bspline.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/intersect.h"

namespace retalho {
namespace {

using test::random_curve;
using test::random_point;

Curve circle() {
  const double w = std::sqrt(0.5);
  Curve c = to_curve(
      BSpline{2,
              2,
              {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4},
              {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}, {1, -1, 0}, {1, 0, 0}},
              {1, w, 1, w, 1, w, 1, w, 1}});
  c.closed = true;
  return c;
}

const Curve kCusp = make_bezier(std::vector<Vec2>{{0, 0}, {1, 1}, {0, 1}, {1, 0}});

TEST(Measure, LengthsThatAreKnown) {
  EXPECT_NEAR(arc_length(circle()), 2 * std::numbers::pi, 1e-13);
  // the parabola (t, t^2) on [0, 1]
  EXPECT_NEAR(arc_length(make_bezier(std::vector<Vec2>{{0, 0}, {0.5, 0}, {1, 1}})),
              std::sqrt(5.0) / 2 + std::asinh(2.0) / 4, 1e-14);
  // slide 6: |Q'|^2 = 9 s^4 + 9 s^2 with s = 2t - 1: the length is 2^1.5 - 1 however the panels lie
  EXPECT_NEAR(arc_length(kCusp), std::pow(2.0, 1.5) - 1, 1e-13);
  for (const double shift : {0.1, 0.3333, 0.77}) {
    const auto [a, b] = split(kCusp, shift);
    EXPECT_NEAR(arc_length(a) + arc_length(b), std::pow(2.0, 1.5) - 1, 1e-13);
  }
}

TEST(Measure, LengthAndParameterAreInverse) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int round = 0; round < 60; ++round) {
    Curve c = round == 0 ? kCusp : random_curve(random, 2 + round % 4, 3, round % 4 == 3);
    if (round > 0) c.append(random_curve(random, 3, 3).points, 2);
    const ArcLength table(c);
    EXPECT_NEAR(table.total(), arc_length(c), 1e-11 * table.total());
    for (int k = 0; k < 10; ++k) {
      const double s = table.total() * unit(random);
      const double u = table.parameter_at(s);
      EXPECT_NEAR(table.length_at(u), s, 1e-11 * table.total());
      EXPECT_NEAR(arc_length(c, c.begin(), u), s, 1e-10 * table.total());
    }
  }
  const auto parts = ArcLength(kCusp).equal_parts(5);
  EXPECT_NEAR(parts[2], 0.5, 1e-6);  // the cusp itself: du/ds is infinite there
}

TEST(Measure, BoundsAreTight) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 300; ++round) {
    const Curve c = random_curve(random, 1 + round % 6, 3, round % 3 == 2);
    const Bounds3 b = exact_bounds(c);
    Vec3 low = c.points.front(), high = low;
    for (int k = 0; k <= 4000; ++k) {
      const Vec3 p = evaluate(c, k / 4000.0);
      EXPECT_GE(p.x, b.low.x - 1e-14);
      EXPECT_LE(p.x, b.high.x + 1e-14);
      low.y = std::min(low.y, p.y), high.z = std::max(high.z, p.z);
    }
    EXPECT_NEAR(low.y, b.low.y, 1e-5);
    EXPECT_NEAR(high.z, b.high.z, 1e-5);
  }
}

TEST(Measure, AreasAndTheirSign) {
  EXPECT_NEAR(signed_area(circle()), std::numbers::pi, 1e-13);
  EXPECT_NEAR(signed_area(reverse(circle())), -std::numbers::pi, 1e-13);
  EXPECT_NEAR(signed_area(transform(circle(), {{{3, 0, 0, 1e3}, {0, 2, 0, -1e3}, {0, 0, 1, 0}}})), 6 * std::numbers::pi,
              1e-11);
  EXPECT_DOUBLE_EQ(signed_area(make_polyline(std::vector<Vec3>{{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}}, 2, true)),
                   6);
  std::mt19937_64 random(3);
  for (int round = 0; round < 100; ++round) {  // against the polygon of many points
    const Curve c = random_curve(random, 2 + round % 5, 2, round % 2 == 1);
    double twice = 0;
    for (int k = 0; k < 4000; ++k) twice += cross(evaluate(c, k / 4000.0), evaluate(c, (k + 1) / 4000.0)).z;
    twice += cross(evaluate(c, 1), evaluate(c, 0)).z;
    EXPECT_NEAR(signed_area(c), twice / 2, 1e-5);
  }
}

TEST(Measure, InflectionsAndCurvatureExtrema) {
  const Curve s = make_bezier(std::vector<Vec2>{{0, 0}, {1, 2}, {2, -2}, {3, 0}});
  const auto bends = inflections(s);
  ASSERT_EQ(bends.size(), 1U);
  EXPECT_NEAR(bends[0].at, 0.5, 1e-14);
  EXPECT_TRUE(inflections(make_bezier(std::vector<Vec2>{{0, 0}, {1, 1}, {2, 2}})).empty());
  EXPECT_TRUE(curvature_extrema(circle()).empty());
  const auto top = curvature_extrema(make_bezier(std::vector<Vec2>{{-1, 1}, {0, -1}, {1, 1}}));  // y = x^2
  ASSERT_EQ(top.size(), 1U);
  EXPECT_NEAR(top[0].at, 0.5, 1e-14);
  EXPECT_NEAR(top[0].value, 2, 1e-13);
  std::mt19937_64 random(4);
  int seen = 0;
  for (int round = 0; round < 200; ++round) {
    const int dimension = 2 + round % 2;
    const Curve c = random_curve(random, 2 + round % 3, dimension, round % 4 == 3);
    const auto found = curvature_extrema(c);
    for (int k = 2; k < 1998; ++k) {  // every sampled extremum of the curvature has one of ours beside it
      const double a = curvature(c, (k - 1) / 2000.0), b = curvature(c, k / 2000.0), d = curvature(c, (k + 1) / 2000.0);
      if ((b - a) * (d - b) >= -1e-9 * b * b) continue;
      double nearest = 1;
      for (const CurvePoint& p : found) nearest = std::min(nearest, std::abs(p.at - k / 2000.0));
      EXPECT_LT(nearest, 2e-3) << round << " at " << k / 2000.0;
      ++seen;
    }
  }
  EXPECT_GT(seen, 100);
}

// Promise of the header: never worse than dense sampling; 100,000 cases, plane and space, polynomial and rational.
TEST(Measure, NearestPointIsNeverWorseThanSampling) {
  std::mt19937_64 random(5);
  int worse = 0, inside = 0;
  constexpr int kSamples = 400;
  for (int round = 0; round < 2000; ++round) {
    const int dimension = 2 + round % 2;
    const Curve c = random_curve(random, 2 + round % 4, dimension, round % 5 == 4);
    std::vector<Vec3> samples;
    for (int k = 0; k <= kSamples; ++k) samples.push_back(evaluate(c, static_cast<double>(k) / kSamples));
    for (int q = 0; q < 50; ++q) {
      const Vec3 p = 1.2 * random_point(random, dimension);
      const CurvePoint best = closest_point(c, p);
      double sampled = 1e300;
      for (const Vec3& s : samples) sampled = std::min(sampled, norm2(s - p));
      worse += best.value > std::sqrt(sampled) + 1e-14;
      inside += best.at > 0 && best.at < 1;
      if (q == 0) {
        const auto minima = closest_points(c, p);
        ASSERT_FALSE(minima.empty());
        EXPECT_NEAR(minima.front().value, best.value, 1e-13);
        // as many local minima as the samples have
        int count = 0;
        for (int k = 0; k <= kSamples; ++k) {
          const double here = norm(samples[static_cast<std::size_t>(k)] - p);
          const bool left = k == 0 || norm(samples[static_cast<std::size_t>(k) - 1] - p) > here,
                     right = k == kSamples || norm(samples[static_cast<std::size_t>(k) + 1] - p) > here;
          count += left && right;
        }
        EXPECT_GE(static_cast<int>(minima.size()), count);
      }
    }
  }
  EXPECT_EQ(worse, 0);
  EXPECT_GT(inside, 40000);
}

TEST(Intersect, AgreesWithTheSamplesSignChanges) {
  std::mt19937_64 random(6);
  int found_all = 0, lost = 0;
  for (int round = 0; round < 300; ++round) {
    const Curve a = random_curve(random, 2 + round % 3, 2, round % 4 == 3), b = random_curve(random, 1 + round % 4, 2);
    const auto found = intersections(a, b);
    for (const Crossing& c : found) EXPECT_LT(norm(evaluate(a, c.first) - evaluate(b, c.second)), 1e-8);
    // twin: all crossings of two fine polylines
    constexpr int kN = 150;
    for (int i = 0; i < kN; ++i)
      for (int j = 0; j < kN; ++j) {
        const Vec3 p = evaluate(a, i / double(kN)), q = evaluate(a, (i + 1) / double(kN)),
                   r = evaluate(b, j / double(kN)), s = evaluate(b, (j + 1) / double(kN));
        const double d = cross(q - p, s - r).z;
        if (d == 0) continue;
        const double t = cross(r - p, s - r).z / d, u = cross(r - p, q - p).z / d;
        if (t < 0 || t > 1 || u < 0 || u > 1) continue;
        double nearest = 1;
        for (const Crossing& c : found)
          nearest = std::min(nearest, std::max(std::abs(c.first - (i + t) / kN), std::abs(c.second - (j + u) / kN)));
        (nearest < 0.03 ? found_all : lost)++;
      }
  }
  EXPECT_GT(found_all, 200);
  EXPECT_LE(lost, 2);  // polylines may cross where curves only pass near each other
}

TEST(Intersect, TangenciesOverlapsAndEnds) {
  const Curve parabola = make_bezier(std::vector<Vec2>{{-1, 1}, {0, -1}, {1, 1}});
  const Curve axis = make_bezier(std::vector<Vec2>{{-2, 0}, {2, 0}});
  const auto touch = intersections(parabola, axis);
  ASSERT_EQ(touch.size(), 1U);
  EXPECT_NEAR(touch[0].first, 0.5, 1e-4);
  EXPECT_EQ(intersections(circle(), axis).size(), 2U + 1U);  // (1, 0) is the circle's start and end
  const Curve cubic = make_bezier(std::vector<Vec2>{{0, 0}, {1, 2}, {3, 2}, {4, 0}});
  const auto both = intersections(cut(cubic, 0, 0.7), cut(cubic, 0.4, 1));
  ASSERT_EQ(both.size(), 2U);
  EXPECT_TRUE(both[0].overlap);
  EXPECT_NEAR(both[0].first, 0.4, 1e-9);
  EXPECT_NEAR(both[1].first, 0.7, 1e-9);
  EXPECT_TRUE(intersections(cubic, make_bezier(std::vector<Vec2>{{0, 3}, {4, 3}})).empty());
}

TEST(Intersect, SelfIntersections) {
  const Curve loop = make_bezier(std::vector<Vec2>{{0, 0}, {3, 2}, {-2, 2}, {1, 0}});
  const auto found = self_intersections(loop);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].first + found[0].second, 1, 1e-9);
  EXPECT_LT(norm(evaluate(loop, found[0].first) - evaluate(loop, found[0].second)), 1e-10);
  EXPECT_TRUE(self_intersections(kCusp).empty());
  EXPECT_TRUE(self_intersections(circle()).empty());
  EXPECT_TRUE(self_intersections(make_bezier(std::vector<Vec2>{{0, 0}, {1, 2}, {2, -2}, {3, 0}})).empty());
  const Curve eight = make_polyline(std::vector<Vec3>{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}}, 2, true);
  ASSERT_EQ(self_intersections(eight).size(), 1U);
  EXPECT_LT(norm(self_intersections(eight)[0].point - Vec3{1, 1, 0}), 1e-12);
}

}  // namespace
}  // namespace retalho
