// Implicit curves: nothing is lost (double factors, tiny ovals, isolated points, cusps), little is looked at, lines are
// on the curve and closed where the curve is.
#include "retalho/level/implicit_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace retalho {
namespace {

ImplicitCurve trace(const std::string& f, PlaneBox box = {-2, -2, 2, 2}, ImplicitOptions options = {}) {
  return trace_implicit(Expression::parse(f), box, options);
}

/// Distance of p from what was found: lines or cells.
double distance_to(const ImplicitCurve& c, Vec2 p) {
  double best = 1e300;
  for (const ImplicitLine& line : c.lines)
    for (std::size_t i = 0; i + (line.closed ? 0 : 1) < line.points.size(); ++i) {
      const Vec2 a = line.points[i], b = line.points[(i + 1) % line.points.size()], d = b - a;
      const double t = norm2(d) > 0 ? std::clamp(dot(p - a, d) / norm2(d), 0.0, 1.0) : 0;
      best = std::min(best, norm(p - a - t * d));
    }
  for (const auto* cells : {&c.unresolved, &c.doubtful})
    for (const PlaneBox& b : *cells)
      best =
          std::min(best, std::hypot(std::max({b.x0 - p.x, 0.0, p.x - b.x1}), std::max({b.y0 - p.y, 0.0, p.y - b.y1})));
  return best;
}

double largest_residual(const ImplicitCurve& c, const Expression& f) {
  double worst = 0;
  for (const ImplicitLine& line : c.lines)
    for (const Vec2 p : line.points) worst = std::max(worst, std::abs(f(p.x, p.y)));
  return worst;
}

TEST(Implicit, ACircleIsOneClosedLine) {
  const ImplicitCurve c = trace("x^2+y^2-1");
  EXPECT_TRUE(c.polynomial);
  ASSERT_EQ(c.lines.size(), 1U);
  EXPECT_TRUE(c.lines[0].closed);
  EXPECT_TRUE(c.unresolved.empty());
  EXPECT_TRUE(c.doubtful.empty());
  for (const Vec2 p : c.lines[0].points) EXPECT_NEAR(norm(p), 1, 1e-15);
  double length = 0;
  const auto& q = c.lines[0].points;
  for (std::size_t i = 0; i < q.size(); ++i) length += norm(q[(i + 1) % q.size()] - q[i]);
  EXPECT_NEAR(length, 2 * M_PI, 1e-4);
  EXPECT_LE(static_cast<double>(c.visited), 0.05 * static_cast<double>(c.grid_cells));
}

// The sheet's table: kept and visited cells at depth 9.
TEST(Implicit, FewCellsAreVisited) {
  const struct {
    const char* f;
    std::size_t most_visited;
  } cases[] = {{"x^2+y^2-1", 5500},
               {"(x^2+y^2-1)^2", 5500},
               {"x^2+y^2-1e-6", 1500},
               {"y^2-x^2*(x-1)", 3500},
               {"((x^2+y^2)^2-2*(x^2-y^2))*(x^2+y^2-1)", 11000},
               {"x^3+y^3-3*x*y", 13107},
               {"y^2-x^3", 13107}};
  for (const auto& one : cases) {
    const ImplicitCurve c = trace(one.f);
    EXPECT_LE(c.visited, one.most_visited) << one.f;
    EXPECT_LE(static_cast<double>(c.visited), 0.05 * static_cast<double>(c.grid_cells)) << one.f;
  }
}

TEST(Implicit, ADoubleFactorStaysAsCells) {
  const ImplicitCurve c = trace("(x^2+y^2-1)^2");
  for (int k = 0; k < 1000; ++k) EXPECT_LT(distance_to(c, {std::cos(k * 0.00628), std::sin(k * 0.00628)}), 1e-15);
  EXPECT_GT(c.unresolved.size(), 1000U);
  for (const PlaneBox& b : c.unresolved) EXPECT_NEAR(std::hypot(b.x0, b.y0), 1, 0.02);
}

TEST(Implicit, ATinyOvalIsFoundAndClosed) {
  for (const double r : {1e-2, 1e-3, 3e-4}) {
    const ImplicitCurve c = trace("(x-0.1234)^2+(y+0.321)^2-" + std::to_string(r) + "^2");
    double reach = 0;
    for (int k = 0; k < 100; ++k)
      reach = std::max(reach, distance_to(c, {0.1234 + r * std::cos(k), -0.321 + r * std::sin(k)}));
    EXPECT_LT(reach, r) << r;
    std::size_t closed = 0;
    for (const ImplicitLine& line : c.lines) closed += line.closed;
    EXPECT_EQ(closed, 1U) << r;
  }
  // smaller than the finest cell: still there, as a cell
  const ImplicitCurve c = trace("(x-0.1234)^2+(y+0.321)^2-1e-14");
  EXPECT_LT(distance_to(c, {0.1234, -0.321}), 1e-7);
  EXPECT_GE(c.unresolved.size(), 1U);
}

TEST(Implicit, AnIsolatedPointIsFound) {
  const ImplicitCurve c = trace("y^2-x^2*(x-1)");  // acnodal: the origin belongs to the curve
  EXPECT_EQ(distance_to(c, {0, 0}), 0);
  EXPECT_LE(c.unresolved.size(), 4U);
  ASSERT_EQ(c.lines.size(), 1U);
  const ImplicitCurve moved = trace("(y-0.3)^2-(x-0.2)^2*(x-1.2)");
  EXPECT_LT(distance_to(moved, {0.2, 0.3}), 1e-12);
}

TEST(Implicit, CuspsNodesAndTangencies) {
  const ImplicitCurve cusp = trace("y^2-x^3");
  EXPECT_LT(distance_to(cusp, {0, 0}), 1e-12);
  for (int k = 0; k <= 100; ++k)
    for (const double s : {-1.0, 1.0}) {
      const double t = s * 1.2 * k / 100;
      EXPECT_LT(distance_to(cusp, {t * t, t * t * t}), 1e-4) << t;
    }
  const ImplicitCurve eight = trace("(x^2+y^2)^2-2*(x^2-y^2)");
  EXPECT_LT(distance_to(eight, {0, 0}), 1e-12);
  EXPECT_LE(eight.unresolved.size(), 16U);
  for (int k = 0; k < 628; ++k) {
    const double t = k * 0.01, d = 1 + std::sin(t) * std::sin(t);
    EXPECT_LT(distance_to(eight, {std::sqrt(2.0) * std::cos(t) / d, std::sqrt(2.0) * std::sin(t) * std::cos(t) / d}),
              1e-4)
        << t;
  }
  const ImplicitCurve touching = trace("(x^2+y^2-1)*((x-1.5)^2+y^2-0.25)");
  EXPECT_LT(distance_to(touching, {1, 0}), 1e-12);
}

TEST(Implicit, LinesAlongTheGridAndThroughItsCorners) {
  for (const char* f :
       {"y", "x", "x-y", "x*y", "x*(x-1)*(x+1)", "y-1", "x+2", "(x-y)*(x+y)", "x-0.5", "y*(x^2+y^2-1)"}) {
    const Expression e = Expression::parse(f);
    const ImplicitCurve c = trace_implicit(e, {-2, -2, 2, 2});
    for (int k = 0; k <= 400; ++k) {
      const double s = -2 + k * 0.01;
      for (const Vec2 p : {Vec2{s, 0}, Vec2{0, s}, Vec2{s, s}, Vec2{s, -s}, Vec2{1, s}, Vec2{-1, s}, Vec2{s, 1},
                           Vec2{-2, s}, Vec2{0.5, s}})
        if (e(p.x, p.y) == 0) {
          EXPECT_LT(distance_to(c, p), 1e-12) << f << " at " << p.x << ", " << p.y;
        }
    }
  }
  EXPECT_EQ(trace("y").lines.size(), 1U);
  EXPECT_EQ(trace("x-y").lines.size(), 1U);
}

TEST(Implicit, NothingWhereNothingIs) {
  for (const char* f : {"x^2+y^2+1e-9", "x^2+y^2+1", "exp(x*y)", "2+sin(x)+cos(y)", "sqrt(x-5)", "log(-1-x^2)"}) {
    const ImplicitCurve c = trace(f);
    EXPECT_TRUE(c.lines.empty()) << f;
    EXPECT_TRUE(c.doubtful.empty()) << f;
    EXPECT_TRUE(c.unresolved.empty()) << f;
  }
}

TEST(Implicit, TranscendentCurvesByIntervals) {
  const struct {
    const char* f;
    std::size_t lines;
  } cases[] = {
      {"sin(x)-y", 1}, {"exp(x)-y-1", 1}, {"cos(x)*cos(y)-0.5", 1}, {"y-atan(3*x)", 1}, {"sqrt(x^2+y^2)-1", 1}};
  for (const auto& one : cases) {
    const Expression f = Expression::parse(one.f);
    const ImplicitCurve c = trace_implicit(f, {-2, -2, 2, 2});
    EXPECT_FALSE(c.polynomial);
    EXPECT_EQ(c.lines.size(), one.lines) << one.f;
    EXPECT_TRUE(c.unresolved.empty()) << one.f;
    EXPECT_LT(largest_residual(c, f), 1e-14) << one.f;
    EXPECT_LE(static_cast<double>(c.visited), 0.05 * static_cast<double>(c.grid_cells)) << one.f;
  }
  const ImplicitCurve diamond = trace("abs(x)+abs(y)-1");
  for (int k = 0; k <= 100; ++k) EXPECT_LT(distance_to(diamond, {k / 100.0, 1 - k / 100.0}), 1e-3);
}

TEST(Implicit, IntervalsAgreeWithBernstein) {
  // The same curve, once recognisable as a polynomial and once hidden behind exp(0 * x).
  for (const char* f : {"x^2+y^2-1", "x^3-x-y^2", "(x^2+y^2)^2-2*(x^2-y^2)-0.1"}) {
    const ImplicitCurve p = trace(f), q = trace(std::string("exp(0*x)*(") + f + ")");
    ASSERT_TRUE(p.polynomial);
    ASSERT_FALSE(q.polynomial);
    EXPECT_EQ(p.lines.size(), q.lines.size()) << f;
    for (const ImplicitLine& line : p.lines)
      for (const Vec2 at : line.points) EXPECT_LT(distance_to(q, at), 1e-4) << f;
  }
}

TEST(Implicit, PolesAreNotDrawn) {
  const ImplicitCurve c = trace("1/x-y");
  EXPECT_EQ(c.lines.size(), 2U);
  for (const ImplicitLine& line : c.lines)
    for (const Vec2 p : line.points) EXPECT_NEAR(p.x * p.y, 1, 1e-12);
  EXPECT_TRUE(c.unresolved.empty());
  // where f has no value at all nothing can be decided, and the cells say so
  const ImplicitCurve wild = trace("sin(1/x)-y");
  EXPECT_FALSE(wild.doubtful.empty());
  for (const PlaneBox& b : wild.doubtful) EXPECT_LE(b.x0 * b.x1, 0);
}

// Random products of random conics: every sampled point of every factor is found; brute force finds no sign change
// in a discarded cell.
TEST(Implicit, RandomProductsLoseNothing) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t points = 0;
  for (int round = 0; round < 60; ++round) {
    std::string f;
    std::vector<std::array<double, 4>> ellipses;
    for (int k = 0; k < 1 + round % 3; ++k) {
      const double a = unit(random), b = unit(random), r = std::pow(10.0, -1.2 + 1.2 * unit(random)),
                   q = 1 + 0.8 * unit(random);
      ellipses.push_back({a, b, r, q});
      char text[200];
      std::snprintf(text, sizeof text, "%s((x-(%.17g))^2+%.17g*(y-(%.17g))^2-%.17g)%s", f.empty() ? "" : "*", a, q, b,
                    r * r, round % 5 == 4 ? "^2" : "");
      f += text;
    }
    const ImplicitCurve c = trace(f, {-2, -2, 2, 2}, {.depth = 8});
    for (const auto& [a, b, r, q] : ellipses)
      for (int k = 0; k < 200; ++k) {
        const Vec2 p = {a + r * std::cos(k * 0.0314), b + r / std::sqrt(q) * std::sin(k * 0.0314)};
        if (std::max(std::abs(p.x), std::abs(p.y)) > 2) continue;
        ++points;
        EXPECT_LT(distance_to(c, p), 4.0 / 256 * 0.05) << f;
      }
  }
  EXPECT_GT(points, 10000U);
}

TEST(Implicit, PolynomialCoefficientsAndTheirErrors) {
  const Expression f = Expression::parse("(x^2+y^2)^2 - 2*(x^2-y^2)/3 + sqrt(2)*x*y^3 - 1e-3");
  const PlaneBox box{-1.5, 0.25, 2, 3};
  const auto p = polynomial_on_box(f, box);
  ASSERT_TRUE(p);
  EXPECT_EQ(p->degree_x, 4);
  EXPECT_EQ(p->degree_y, 4);
  EXPECT_LT(p->error, 1e-11);
  for (int i = 0; i <= 10; ++i)
    for (int j = 0; j <= 10; ++j)
      EXPECT_NEAR(evaluate(*p, i / 10.0, j / 10.0),
                  f(box.x0 + (box.x1 - box.x0) * i / 10, box.y0 + (box.y1 - box.y0) * j / 10), 1e-12);
  EXPECT_FALSE(polynomial_on_box(Expression::parse("sin(x)"), box));
  EXPECT_FALSE(polynomial_on_box(Expression::parse("x^40"), box));
  EXPECT_FALSE(polynomial_on_box(Expression::parse("x/y"), box));
}

TEST(Intervals, EncloseWhatPointsGive) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0, 1);
  const char* formulas[] = {"sin(x)*cos(y)", "tan(x)",    "exp(x-y)/x",    "x^3-y^2*x",         "sqrt(x)*y",
                            "log(x)+y",      "cbrt(x*y)", "abs(x)-abs(y)", "atan(x*y)",         "sinh(x)-cosh(y)",
                            "tanh(x+y)",     "asin(x/4)", "acos(y/4)",     "min(x,y)*max(x,y)", "floor(x)+y",
                            "sign(x)*y",     "x^y",       "x^-2",          "log10(x^2+1)",      "x^0.5",
                            "e^x",           "pi*x"};
  int inside = 0;
  for (const char* text : formulas) {
    const Expression f = Expression::parse(text);
    for (int round = 0; round < 2000; ++round) {
      const double x0 = -3 + 6 * unit(random), y0 = -3 + 6 * unit(random), wx = std::pow(10.0, -6 * unit(random)),
                   wy = std::pow(10.0, -6 * unit(random));
      const IntervalJet jet = f.enclose({x0, x0 + wx}, {y0, y0 + wy});
      for (int k = 0; k < 5; ++k) {
        const double x = x0 + wx * unit(random), y = y0 + wy * unit(random), v = f(x, y);
        if (std::isnan(v)) {
          EXPECT_FALSE(jet.defined) << text << " " << x << " " << y;
          continue;
        }
        ++inside;
        EXPECT_TRUE(jet.possible);
        EXPECT_LE(jet.value.low, v) << text << " " << x << " " << y;
        EXPECT_GE(jet.value.high, v) << text << " " << x << " " << y;
        if (!jet.smooth || !jet.defined) continue;
        const double h = 1e-6;
        const double dx = (f(x + h, y) - f(x - h, y)) / (2 * h);
        if (std::isfinite(dx) && jet.dx.high - jet.dx.low < 1e6) {
          const double slack = 1e-4 * (1 + std::abs(dx)) + 1e-2 * (jet.dx.high - jet.dx.low);
          EXPECT_LE(jet.dx.low, dx + slack) << text << " " << x << " " << y;
          EXPECT_GE(jet.dx.high, dx - slack) << text << " " << x << " " << y;
        }
      }
    }
  }
  EXPECT_GT(inside, 150000);
}

}  // namespace
}  // namespace retalho
