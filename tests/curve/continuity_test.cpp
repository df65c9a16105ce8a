// Joins: all the slides' cases and counter-examples, and random reparametrised joins over six decades of scale.
#include "retalho/curve/continuity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "curve/support.h"
#include "retalho/curve/convert.h"
#include "retalho/curve/edit.h"

namespace retalho {
namespace {

using test::random_point;

Curve pair(std::vector<Vec3> a, std::vector<Vec3> b, double length_b = 1, int dimension = 2) {
  Curve c;
  c.dimension = dimension;
  c.append(a);
  c.append(b, length_b);
  return c;
}

Join join_of(const Curve& c) {
  return analyse_join(c.segment(0), c.segment(1), c.dimension);
}

TEST(Continuity, Slide6IsSmoothByTheParameterAndACusp) {
  const Curve curve = make_bezier(std::vector<Vec2>{{0, 0}, {1, 1}, {0, 1}, {1, 0}});
  const auto joins = analyse_joins(curve);
  ASSERT_EQ(joins.size(), 1U);
  EXPECT_NEAR(joins[0].at, 0.5, 1e-15);
  EXPECT_EQ(joins[0].c, 2);
  EXPECT_EQ(joins[0].g, 0);
  EXPECT_EQ(joins[0].kind, JoinKind::cusp);
  EXPECT_NEAR(joins[0].angle, std::numbers::pi, 1e-12);
}

TEST(Continuity, AStopIsNoCusp) {  // (t^3, t^3) on [-1, 1]
  const Curve curve = from_power(std::vector<Vec3>{{-1, -1, 0}, {3, 3, 0}, {-3, -3, 0}, {1, 1, 0}}, -1, 1, 2);
  const auto joins = analyse_joins(curve);
  ASSERT_EQ(joins.size(), 1U);
  EXPECT_EQ(joins[0].kind, JoinKind::stop);
  EXPECT_EQ(joins[0].g, 0);  // strictly not G1: the speed is zero
  EXPECT_NEAR(joins[0].angle, 0, 1e-12);
}

TEST(Continuity, Slide9IsC1NotC2AndG2) {
  const Curve first = from_power(std::vector<Vec3>{{0, 0, 0}, {0, 2, 0}, {2, -1, 0}}, 0, 1, 2);
  const Curve second = from_power(std::vector<Vec3>{{2, 1, 0}, {4, 0, 0}, {-2, -1, 0}}, 1, 2, 2);
  Curve both = first;
  both.append(second.points, 1);
  const Join j = join_of(both);
  EXPECT_EQ(j.c, 1);
  EXPECT_EQ(j.g, 2);
  EXPECT_NEAR(j.curvature_left, -0.125, 1e-14);
  EXPECT_NEAR(j.curvature_right, -0.125, 1e-14);
  EXPECT_EQ(j.kind, JoinKind::regular);
}

TEST(Continuity, SpeedTimesThreeIsG2NotC1) {
  // Q(t) and Q(3t): same points, three times the speed, matching second derivative.
  const Curve q = from_power(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0.2, 0.7, 0}, {0.1, 0.3, 0}}, -1, 1, 2);
  const auto [left, right] = split(q, 0);
  const Curve c = pair({left.points.begin(), left.points.end()}, {right.points.begin(), right.points.end()}, 1.0 / 3);
  const Join j = join_of(c);
  EXPECT_EQ(j.c, 0);
  EXPECT_EQ(j.g, 2);
  EXPECT_NEAR(j.speed_ratio, 3, 1e-12);
}

TEST(Continuity, SecondDerivativeDoubledIsC1NotG2) {
  const Curve left = from_power(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 0.5, 0}}, -1, 0, 2);
  const Curve l = from_power(std::vector<Vec3>{{-1, 0.5, 0}, {1, -1, 0}, {0, 0.5, 0}}, -1, 0, 2);
  const Curve r = from_power(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0, 1, 2);
  const Join j = join_of(pair({l.points.begin(), l.points.end()}, {r.points.begin(), r.points.end()}));
  EXPECT_EQ(j.c, 1);
  EXPECT_EQ(j.g, 1);
  EXPECT_EQ(left.segment_count(), 1U);
}

TEST(Continuity, Slide8CornerAndG1WithoutC1) {
  Join j = join_of(pair({{0, 0, 0}, {1, 1, 0}}, {{1, 1, 0}, {2, 0, 0}}));
  EXPECT_EQ(j.c, 0);
  EXPECT_EQ(j.g, 0);
  EXPECT_NEAR(j.angle, std::numbers::pi / 2, 1e-15);
  j = join_of(pair({{0, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{1, 1, 0}, {4, 1, 0}, {5, 0, 0}}));
  EXPECT_EQ(j.c, 0);
  EXPECT_EQ(j.g, 1);
  j = join_of(pair({{0, 0, 0}, {1, 1, 0}}, {{1, 1.001, 0}, {2, 0, 0}}));
  EXPECT_EQ(j.c, -1);
  EXPECT_EQ(j.g, -1);
  EXPECT_NEAR(j.gap, 0.001, 1e-15);
  // the slides' k > 0: turning straight back is no G1
  j = join_of(pair({{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {0, 0, 0}}));
  EXPECT_EQ(j.g, 0);
  EXPECT_NEAR(j.angle, std::numbers::pi, 1e-15);
}

TEST(Continuity, StraightLinesAreSmoothAtAnyScale) {
  for (const double s : {1e-6, 1.0, 1e6}) {
    const Join j = join_of(pair({{0, 0, 0}, {0.1 * s, 0.3 * s, 0}, {0.2 * s, 0.6 * s, 0}},
                                {{0.2 * s, 0.6 * s, 0}, {0.3 * s, 0.9 * s, 0}, {0.4 * s, 1.2 * s, 0}}));
    EXPECT_EQ(j.c, 2) << s;
    EXPECT_EQ(j.g, 2) << s;
  }
}

TEST(Continuity, ClosedCurvesHaveTheirClosingJoin) {
  Curve c = make_polyline(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 2, true);
  const auto joins = analyse_joins(c);
  ASSERT_EQ(joins.size(), 3U);
  EXPECT_EQ(joins[2].right, 0U);
  EXPECT_EQ(joins[2].at, 3);
}

// Q'+ = b1 Q'-, Q''+ = b1^2 Q''- + b2 Q'-: G2 by construction, of any speed ratio, size and place; then one condition
// after the other is broken by a share that is far above rounding.
TEST(Continuity, TenThousandRandomReparametrisedJoins) {
  std::mt19937_64 random(20260729);
  std::uniform_real_distribution<double> unit(0, 1);
  int wrong = 0, strong = 0;
  for (int round = 0; round < 10000; ++round) {
    const int dimension = 2 + round % 2;
    const double scale = std::pow(10.0, -3 + 6 * unit(random)), b1 = std::pow(10.0, -1 + 2 * unit(random)),
                 b2 = 4 * unit(random) - 2;
    const Vec3 place = scale * random_point(random, dimension), p = place;
    Vec3 d = scale * random_point(random, dimension);
    while (norm(d) < 0.1 * scale) d = scale * random_point(random, dimension);
    const Vec3 s = scale * random_point(random, dimension), far_left = scale * random_point(random, dimension),
               far_right = scale * random_point(random, dimension);
    // cubic ends with given derivatives: b3 = p, b2 = p - d/3, b1 = p - 2d/3 + s/6; and b0 = p, b1 = p + d'/3, b2 = p +
    // 2d'/3 + s'/6
    Vec3 e = b1 * d, t = b1 * b1 * s + b2 * d;
    const int kind = round % 5;
    Vec3 q = p;
    const Vec3 across = normalized(cross(d, Vec3{0.3, 0.5, 1}));
    const Vec3 side = dimension == 2 ? normalized(Vec3{-d.y, d.x, 0}) : across;
    int want_c = -2, want_g = 2;
    if (kind == 1) t = t + 0.01 * norm2(e) / scale * side, want_g = 1;     // curvature off by a hundredth of 1 / scale
    if (kind == 2) e = e + 1e-5 * norm(e) * side, want_g = 0;              // tangent off by 1e-5 rad
    if (kind == 3) q = q + 1e-5 * scale * side, want_g = -1, want_c = -1;  // a gap of 1e-5 of the size
    if (kind == 4) e = d, t = s, want_c = 2;                               // C2
    const Curve curve = pair({far_left, p - 2 * d / 3 + s / 6, p - d / 3, p},
                             {q, q + e / 3, q + 2 * e / 3 + t / 6, far_right}, 1, dimension);
    const Join j = join_of(curve);
    if (want_c == -2) want_c = j.c;  // C follows from b1, b2: checked below
    const bool c_right = kind == 4   ? j.c == 2
                         : kind == 3 ? j.c == -1
                                     : (j.c >= 1) == (norm(e - d) <= 1e-9 * 3 * std::max(norm(d), norm(e)));
    if (j.g != want_g || !c_right || j.kind != JoinKind::regular) {
      ++wrong;
      ADD_FAILURE() << "round " << round << " kind " << kind << " scale " << scale << " b1 " << b1 << " got G" << j.g
                    << " C" << j.c << " angle " << j.angle << " curvature gap " << j.curvature_gap;
      if (wrong > 10) return;
    }
    strong += norm(cross(d, s)) > 0.1 * norm(d) * norm(s);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(strong, 7000);  // most cases have a curvature worth the name
}

}  // namespace
}  // namespace retalho
