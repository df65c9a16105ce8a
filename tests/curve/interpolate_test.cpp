// Interpolation: scipy's splines (tests/data/spline_reference.json, made by make_spline_reference.py), Runge's table,
// orders of convergence.
#include "retalho/curve/interpolate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "curve/support.h"
#include "retalho/core/error.h"
#include "retalho/curve/continuity.h"
#include "retalho/curve/convert.h"
#include "support/paths.h"

namespace retalho {
namespace {

nlohmann::json reference() {
  std::ifstream in(test::source_folder() + "/tests/data/spline_reference.json");
  return nlohmann::json::parse(in);
}

SplineEnds ends_of(const std::string& name) {
  for (const SplineEnds e : {SplineEnds::natural, SplineEnds::clamped, SplineEnds::not_a_knot, SplineEnds::periodic})
    if (name == spline_ends_name(e)) return e;
  throw std::runtime_error(name);
}

TEST(Interpolate, SplinesEqualScipys) {
  double worst = 0;
  int cases = 0;
  const auto all = reference();
  for (const auto& one : all["splines"]) {
    const std::vector<double> x = one["x"], y = one["y"], slopes = one["slopes"], at = one["at"],
                              values = one["values"];
    const SplineOptions options{ends_of(one["ends"]), 0.3, -0.7};
    const std::vector<double> m = spline_slopes(x, y, options);
    double scale = 1;
    for (const double v : slopes) scale = std::max(scale, std::abs(v));
    for (std::size_t i = 0; i < m.size(); ++i) worst = std::max(worst, std::abs(m[i] - slopes[i]) / scale);
    const Curve graph = spline_graph(x, y, options);
    double size = 1;
    for (const double v : values) size = std::max(size, std::abs(v));
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Vec3 p = evaluate(graph, at[i]);
      EXPECT_NEAR(p.x, at[i], 1e-14);
      worst = std::max(worst, std::abs(p.y - values[i]) / size);
    }
    ++cases;
  }
  EXPECT_EQ(cases, 23);
  EXPECT_LE(worst, 1e-12);
  RecordProperty("worst", std::to_string(worst));
}

TEST(Interpolate, LagrangeAndHermiteEqualScipys) {
  const auto all = reference();
  const auto& l = all["lagrange"];
  const Lagrange p(l["x"], l["y"]);
  const std::vector<double> at = l["at"], values = l["values"];
  const std::vector<double> b = p.bernstein(-1, 1);
  const std::vector<double> nodes = l["x"];
  for (std::size_t i = 0; i < at.size(); ++i)
    if (at[i] >= nodes.front() && at[i] <= nodes.back()) {
      EXPECT_NEAR(p(at[i]), values[i], 1e-12 * (1 + std::abs(values[i])));
    }
  const auto& h = all["hermite"];
  const std::vector<double> x = h["x"], y = h["y"], m = h["slopes"], where = h["at"], want = h["values"];
  std::vector<Vec3> points, tangents;
  for (std::size_t i = 0; i < x.size(); ++i) points.push_back({x[i], y[i], 0}), tangents.push_back({1, m[i], 0});
  const Curve curve = from_hermite(points, tangents, 2, x);
  for (std::size_t i = 0; i < where.size(); ++i) EXPECT_NEAR(evaluate(curve, where[i]).y, want[i], 1e-12);
  EXPECT_EQ(b.size(), 12U);
}

double runge(double x) {
  return 1 / (1 + 25 * x * x);
}

double lagrange_error(const std::vector<double>& nodes) {
  std::vector<double> y;
  y.reserve(nodes.size());
  for (const double x : nodes) y.push_back(runge(x));
  const Lagrange p(nodes, y);
  double worst = 0;
  for (int i = 0; i <= 4000; ++i) worst = std::max(worst, std::abs(p(-1 + i / 2000.0) - runge(-1 + i / 2000.0)));
  return worst;
}

// The sheet's table (slide 4): equispaced nodes diverge, Chebyshev nodes and splines converge.
TEST(Interpolate, RungesTable) {
  const struct {
    std::size_t n;
    double uniform, chebyshev, natural, not_a_knot;
  } rows[] = {{11, 1.92, 0.13, 0.022, 0.022}, {21, 59.8, 0.018, 0.0032, 0.0032}, {41, 1.05e5, 3.4e-4, 2.8e-4, 2.8e-4}};
  for (const auto& row : rows) {
    EXPECT_NEAR(lagrange_error(uniform_nodes(row.n, -1, 1)), row.uniform, 0.03 * row.uniform);
    EXPECT_NEAR(lagrange_error(chebyshev_nodes(row.n, -1, 1)), row.chebyshev, 0.2 * row.chebyshev);
    const std::vector<double> x = uniform_nodes(row.n, -1, 1);
    std::vector<double> y;
    y.reserve(x.size());
    for (const double v : x) y.push_back(runge(v));
    for (const auto& [ends, want] :
         {std::pair{SplineEnds::natural, row.natural}, std::pair{SplineEnds::not_a_knot, row.not_a_knot}}) {
      const Curve s = spline_graph(x, y, {.ends = ends});
      double worst = 0;
      for (int i = 0; i <= 4000; ++i)
        worst = std::max(worst, std::abs(evaluate(s, -1 + i / 2000.0).y - runge(-1 + i / 2000.0)));
      EXPECT_NEAR(worst, want, 0.1 * want);
    }
  }
}

TEST(Interpolate, OrdersOfConvergence) {
  const auto g = [](double x) { return std::exp(std::sin(2 * x)); };
  const auto slope = [&](double x) { return 2 * std::cos(2 * x) * g(x); };
  const auto error = [&](SplineEnds ends, std::size_t n) {
    const std::vector<double> x = uniform_nodes(n, 0, M_PI);
    std::vector<double> y;
    y.reserve(x.size());
    for (const double v : x) y.push_back(g(v));
    y.back() = y.front();
    const Curve s = spline_graph(x, y, {ends, slope(0), slope(M_PI)});
    double worst = 0;
    for (int i = 0; i <= 20000; ++i)
      worst = std::max(worst, std::abs(evaluate(s, M_PI * i / 20000).y - g(M_PI * i / 20000)));
    return worst;
  };
  for (const auto& [ends, order] : {std::pair{SplineEnds::natural, 2.0}, std::pair{SplineEnds::clamped, 4.0},
                                    std::pair{SplineEnds::not_a_knot, 4.0}, std::pair{SplineEnds::periodic, 4.0}})
    EXPECT_NEAR(std::log2(error(ends, 65) / error(ends, 129)), order, 0.4) << spline_ends_name(ends);
}

TEST(Interpolate, CurvesPassThroughTheirPointsAndAreC2) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 200; ++round) {
    std::vector<Vec3> points;
    points.reserve(9);
    for (int i = 0; i < 4 + round % 6; ++i) points.push_back(test::random_point(random));
    for (const bool closed : {false, true})
      for (const Parameters kind : {Parameters::uniform, Parameters::centripetal, Parameters::chord}) {
        const Curve c = interpolate_points(points, 3, {.parameters = kind, .closed = closed});
        for (std::size_t i = 0; i + 1 < points.size(); ++i) EXPECT_EQ(c.segment(i).points.front(), points[i]);
        for (const Join& j : analyse_joins(c)) EXPECT_EQ(j.c, 2);
      }
  }
}

TEST(Interpolate, FewPointsAndBadOnes) {
  const std::vector<double> two = {0, 1}, y2 = {1, 3};
  EXPECT_EQ(spline_slopes(two, y2), (std::vector<double>{2, 2}));
  const std::vector<double> three = {0, 1, 3}, y3 = {0, 1, 9};  // y = x^2
  const auto m = spline_slopes(three, y3);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(m[i], 2 * three[i], 1e-14);
  EXPECT_THROW(spline_slopes(std::vector<double>{0, 0, 1}, y3), BadInput);
  EXPECT_THROW(spline_slopes(three, y3, {.ends = SplineEnds::periodic}), BadInput);
  const std::vector<Vec3> repeated = {{0, 0, 0}, {1, 1, 0}, {1, 1, 0}, {2, 0, 0}};
  try {
    interpolate_points(repeated, 2);
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_EQ(error.where(), "points[2]");
  }
  EXPECT_THROW(Lagrange({1, 1}, {0, 0}), BadInput);
}

TEST(Interpolate, LagrangeCurveIsTheGraph) {
  std::vector<Vec3> points;
  for (const double x : chebyshev_nodes(9, -1, 1)) points.push_back({x, runge(x), 0});
  const Curve c = lagrange_curve(points, 2, Parameters::x);
  for (const Vec3& p : points) EXPECT_LT(norm(evaluate(c, p.x) - p), 1e-12);
  for (int i = 0; i <= 10; ++i) EXPECT_NEAR(evaluate(c, -1 + 0.2 * i).x, -1 + 0.2 * i, 1e-12);
}

}  // namespace
}  // namespace retalho
