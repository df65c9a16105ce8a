// JSON, SVG and vector files: exact round trips, errors with their places. Formulas: graphs without false joins.
#include <gtest/gtest.h>

#include <cmath>

#include "curve/support.h"
#include "retalho/core/error.h"
#include "retalho/curve/document.h"
#include "retalho/curve/explicit.h"
#include "retalho/curve/plane_path.h"
#include "retalho/curve/vector_file.h"
#include "support/support.h"

namespace retalho {
namespace {

std::string place_of(const std::string& json) {
  try {
    const CurveDocument d = parse_curves(json);
    for (std::size_t i = 0; i < d.curves.size(); ++i) to_curve(d.curves[i], "curves[" + std::to_string(i) + "]");
  } catch (const BadInput& error) {
    return error.what();
  }
  return "no error";
}

TEST(Json, ErrorsNameThePlace) {
  const auto in = [](const std::string& curve) { return "{\"curves\": [" + curve + "]}"; };
  const std::string good = R"({"kind":"polyline","points":[[0,0],[1,1]]})";
  EXPECT_EQ(place_of(in(good + "," + good +
                        R"(,{"kind":"bezier","points":[[0,0,0],[1,1,1],[1,1,1],[1,1,1],[1,1,1],[1,1]]})")),
            "curves[2].points[5]: expected 3 numbers, got 2");
  EXPECT_EQ(place_of(in(R"({"kind":"polyline","points":[[0,0],[1,"a"]]})")),
            "curves[0].points[1][1]: expected a number, got string");
  EXPECT_EQ(place_of(in(R"({"kind":"polyline","points":[[0],[1,2]]})")),
            "curves[0].points[0]: expected 2 or 3 numbers, got 1");
  EXPECT_EQ(place_of(in(R"({"kind":"polyline"})")),
            "curves[0]: \"points\" is missing; a curve of kind \"polyline\" has points, closed");
  EXPECT_EQ(place_of(in(R"({"kind":"polyline","pionts":[]})")),
            "curves[0].pionts: a curve of kind \"polyline\" has no such key; it has points, closed");
  EXPECT_EQ(place_of(in(R"({"kind":"bezier","degree":3,"points":[[0,0],[1,1],[2,2]]})")),
            "curves[0]: 3 points do not make a chain of degree 3: 3 n + 1 points are needed");
  EXPECT_EQ(place_of(in(R"({"kind":"bspline","degree":2,"knots":[0,0,0,1,1],"points":[[0,0],[1,1],[2,0]]})")),
            "curves[0].knots: 5 knots: 3 points of degree 2 need 6");
  EXPECT_EQ(place_of(in(R"({"kind":"bspline","degree":2,"knots":[0,0,0,1,0.5,1],"points":[[0,0],[1,1],[2,0]]})")),
            "curves[0].knots[4]: 0.5 after 1: knots must not descend");
  EXPECT_EQ(
      place_of(
          in(R"({"kind":"bspline","degree":2,"knots":[0,0,0,1,1,1],"points":[[0,0],[1,1],[2,0]],"weights":[1,0,1]})")),
      "curves[0].weights[1]: 0: weights must be positive");
  EXPECT_EQ(place_of(in(R"({"kind":"spline","points":[[0,0],[1,1],[1,1],[2,0]]})")),
            "curves[0].points[2]: repeats the point before it: merge them, or use uniform parameters");
  EXPECT_EQ(place_of(in(R"({"kind":"spline","ends":"naturel","points":[[0,0],[1,1]]})")),
            "curves[0].ends: \"naturel\" is none of \"not-a-knot\", \"natural\", \"clamped\", \"periodic\"");
  EXPECT_EQ(place_of("{\"curves\": [\n  {\"kind\": }\n]}"), "not JSON (line 2, column 12)");
  EXPECT_EQ(place_of("[]"), "expected an object with the key \"curves\", an array");
  EXPECT_NE(place_of(in(R"({"kind":"circle","points":[]})")).find("curves[0].kind: \"circle\" is none of"),
            std::string::npos);
}

TEST(Json, RoundTripsAreExact) {
  std::mt19937_64 random(1);
  CurveDocument d;
  for (int k = 0; k < 50; ++k) {
    Curve c = test::random_curve(random, 1 + k % 5, 2 + k % 2, k % 3 == 0);
    if (k % 4 == 0) c.append(test::random_curve(random, 2, 2 + k % 2).points, 1.0 / 3);
    CurveSpec spec = to_spec(c);
    spec.name = "curve " + std::to_string(k);
    d.curves.push_back(spec);
  }
  CurveSpec formula;
  formula.kind = CurveKind::implicit_form;
  formula.f = "x^2+y^2-1";
  formula.box = {-1.1, -2, 1.0 / 3, 2};
  d.curves.push_back(formula);
  const std::string text = to_json(d);
  const CurveDocument back = parse_curves(text);
  EXPECT_EQ(to_json(back), text);
  for (std::size_t i = 0; i < 50; ++i) {
    const Curve a = to_curve(d.curves[i]), b = to_curve(back.curves[i]);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.weights, b.weights);
    EXPECT_EQ(a.breaks, b.breaks);
    EXPECT_EQ(a.first, b.first);
  }
}

TEST(Svg, PathsRoundTripExactly) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 200; ++round) {
    Curve c;
    Vec3 at = test::random_point(random, 2);
    for (int k = 0; k < 5; ++k) {
      Curve s = test::random_curve(random, 1 + (round + k) % 3, 2);
      s.points.front() = at;
      at = s.points.back();
      c.append(s.points);
    }
    const auto back = parse_svg_path(to_svg(to_path(c, 1)));
    ASSERT_EQ(back.size(), 1U);
    EXPECT_EQ(back[0].points, c.points);
    EXPECT_EQ(back[0].first, c.first);
  }
}

TEST(Svg, AllCommandsAndTheirErrors) {
  const auto curves = parse_svg_path("m1,2 3 0h1v-1H2V5l1 1z M0 0C1 1 2 1 3 0S5-1 6 0Q7 1 8 0t2 0");
  ASSERT_EQ(curves.size(), 2U);
  EXPECT_TRUE(curves[0].closed);
  EXPECT_EQ(curves[0].points.back(), (Vec3{1, 2, 0}));
  EXPECT_EQ(curves[1].segment(1).points[1], (Vec3{4, -1, 0}));
  EXPECT_EQ(curves[1].segment(3).points[1], (Vec3{9, -1, 0}));
  // arcs are exact: all points on the circle of radius 5 about the origin
  const auto arc = parse_svg_path("M5 0A5 5 0 1 1 0 -5");
  for (int k = 0; k <= 100; ++k) EXPECT_NEAR(norm(evaluate(arc[0], arc[0].end() * k / 100)), 5, 1e-13);
  EXPECT_EQ(arc[0].points.back(), (Vec3{0, -5, 0}));
  const auto ellipse = parse_svg_path("M 3 0 A 3 2 0 0 1 0 2");
  for (int k = 0; k <= 20; ++k) {
    const Vec3 p = evaluate(ellipse[0], k / 20.0);
    EXPECT_NEAR(p.x * p.x / 9 + p.y * p.y / 4, 1, 1e-13);
  }
  for (const char* bad : {"L 1 1", "M 1", "M 1 1 X 2", "M 1 1 L a 2", "M 0 0 A 1 1 0 2 0 1 1", "M0 0 1e999 0"})
    EXPECT_THROW(parse_svg_path(bad), BadInput) << bad;
}

TEST(Svg, FilesOfOthers) {
  test::ScratchFolder folder;
  const std::string file = folder.put("a.svg",
                                      "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\"><g "
                                      "transform=\"translate(1 2)\"><path d=\"M0 0L1 1\"/></g>"
                                      "<polygon points=\"0,0 1,0 1,1\"/><defs><path d=\"M9 9L8 8\"/></defs><path "
                                      "class=\"decoration\" d=\"M5 5L6 6\"/></svg>");
  int transforms = 0;
  const auto curves = read_svg(file, &transforms);
  EXPECT_EQ(curves.size(), 2U);
  EXPECT_EQ(transforms, 1);
  EXPECT_TRUE(curves[1].closed);
  EXPECT_THROW(read_svg(folder.put("b.svg", "<svg><path")), Error);
  EXPECT_THROW(read_svg(folder.put("c.svg", "<svg></svg>")), BadInput);
  try {
    read_svg(folder.put("d.svg", "<svg><path id=\"p\" d=\"M0 0L1\"/></svg>"));
    FAIL();
  } catch (const BadInput& error) {
    EXPECT_EQ(error.where(), "element \"p\", character 7");
  }
}

TEST(VectorFiles, LinesRoundTripExactly) {
  std::mt19937_64 random(3);
  std::vector<VectorLine> lines;
  for (int k = 0; k < 20; ++k) {
    VectorLine l{"line " + std::to_string(k), {}, 2, k % 3 == 0};
    for (int i = 0; i < 5; ++i) l.points.push_back(1e3 * test::random_point(random, 2));
    lines.push_back(l);
  }
  test::ScratchFolder folder;
  for (const char* name : {"a.gpkg", "a.geojson", "a.shp"}) {
    write_vector_lines(lines, folder / name);
    const auto back = read_vector_lines(folder / name);
    ASSERT_EQ(back.size(), lines.size()) << name;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_EQ(back[i].points, lines[i].points) << name;
      EXPECT_EQ(back[i].closed, lines[i].closed) << name;
      EXPECT_EQ(back[i].name, lines[i].name) << name;
    }
    EXPECT_THROW(write_vector_lines(lines, folder / name), CannotWrite);
  }
  write_vector_lines(lines, folder / "a.dxf");
  EXPECT_EQ(read_vector_lines(folder / "a.dxf").size(), lines.size());
  EXPECT_THROW(read_vector_lines(folder / "none.gpkg"), CannotRead);
  EXPECT_THROW(write_vector_lines(lines, folder / "a.xyz"), UsageError);
}

TEST(Explicit, NoFalseJoins) {
  const struct {
    const char* f;
    double from, to;
    std::size_t lines;
    std::vector<double> jumps;
  } cases[] = {{"1/x", -1, 1, 2, {0}},
               {"tan(x)", -6, 6, 5, {-4.71238898038469, -1.5707963267948966, 1.5707963267948966, 4.71238898038469}},
               {"floor(x)", -2.5, 2.5, 6, {-2, -1, 0, 1, 2}},
               {"sqrt(x)", -3, 3, 1, {}},
               {"sign(x)*x^2+sign(x)", -1, 1.5, 2, {0}},
               {"sin(x)/x", -9, 8, 2, {0}},
               {"1/(x^2-2)", -3, 3, 3, {-1.4142135623730951, 1.4142135623730951}},
               {"x^2", -1, 1, 1, {}},
               {"abs(x)", -1, 1, 1, {}},
               {"log(x^2)", -1, 1, 2, {0}}};
  for (const auto& one : cases) {
    const Expression f = Expression::parse(one.f);
    const ExplicitCurve c = trace_explicit(f, one.from, one.to);
    EXPECT_EQ(c.lines.size(), one.lines) << one.f;
    EXPECT_LT(c.evaluations, 40000U) << one.f;
    ASSERT_EQ(c.breaks.size(), one.jumps.size()) << one.f;
    for (std::size_t i = 0; i < one.jumps.size(); ++i) EXPECT_NEAR(c.breaks[i], one.jumps[i], 1e-8) << one.f;
    for (const auto& line : c.lines)
      for (const Vec2 p : line) EXPECT_EQ(p.y, f(p.x)) << one.f;
    for (const auto& line : c.lines)
      for (const double j : one.jumps) EXPECT_FALSE(line.front().x < j && j < line.back().x) << one.f;
  }
  EXPECT_THROW(trace_explicit(Expression::parse("sqrt(x)"), -3, -1), BadInput);
  EXPECT_THROW(trace_explicit(Expression::parse("x+y"), 0, 1), BadInput);
  // A second line would have been the whole formula.
  EXPECT_THROW(Expression::parse("x-y\n+1"), BadInput);
  EXPECT_THROW(Expression::parse(std::string("x#a\0b\n+1", 9)), BadInput);
  EXPECT_THROW(trace_explicit(Expression::parse("x"), 1, 0), UsageError);
}

TEST(Formulas, AreReadAsMathematicsHasThem) {
  const struct {
    const char* f;
    double x, y, v;
  } cases[] = {{"-x^2", 3, 0, -9},         {"2^3^2", 0, 0, 512},   {"x-y-1", 5, 2, 2},
               {"2*x^2-1/4", 3, 0, 17.75}, {"-2^-2", 0, 0, -0.25}, {"max(x, y)-min(x,y)", 2, 7, 5},
               {"cos(pi)", 0, 0, -1},      {"1.5e2+x", 1, 0, 151}, {"ln(e)", 0, 0, 1},
               {"x*-y", 2, 3, -6}};
  for (const auto& one : cases) EXPECT_NEAR(Expression::parse(one.f)(one.x, one.y), one.v, 1e-13) << one.f;
  for (const char* bad : {"", "x+", "2x", "foo(x)", "(x", "x)", "z", "sin()", "sin(x,y)", "x,y", "x=3", "\"a\"", "@1"})
    EXPECT_THROW(Expression::parse(bad), BadInput) << bad;
}

}  // namespace
}  // namespace retalho
