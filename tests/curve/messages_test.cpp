// What the calls of the room refuse, in its own words: those that no file and no command line can ask for.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/curve/batch.h"
#include "retalho/curve/bspline.h"
#include "retalho/curve/convert.h"
#include "retalho/curve/curve.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/explicit.h"
#include "retalho/curve/interpolate.h"
#include "retalho/curve/measure.h"
#include "retalho/curve/vector_file.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho::test {
namespace {

const std::vector<Vec3> kArch{{0, 0, 0}, {1, 2, 0}, {3, 2, 0}, {4, 0, 0}};
const std::vector<double> kWeights{1, 2, 2, 1};

Curve arch() {
  return make_bezier(kArch, 3, 2);
}
Curve rational() {
  return make_bezier(kArch, 3, 2, kWeights);
}
Curve in_space() {
  return make_bezier(kArch, 3, 3);
}
BSpline spline() {
  return to_bspline(arch());
}

/// The spline with one thing changed is refused.
void refused(const std::function<void(BSpline&)>& change) {
  BSpline s = spline();
  change(s);
  validate(s);
}

struct Row {
  const char* words;
  std::function<void()> call;
};

TEST(CurveMessages, BadValuesAreNamed) {
  const std::vector<Vec3> one{{0, 0, 0}}, many(70, Vec3{1, 1, 0}), two{{0, 0, 0}, {1, 0, 0}};
  const std::vector<double> x{0, 2, 1}, y{0, 1, 2}, up{0, 1, 2};
  const Row rows[] = {
      {"degree 0: 1 to 63 is possible", [] { refused([](BSpline& s) { s.degree = 0; }); }},
      {"not a finite number",
       [] { refused([](BSpline& s) { s.knots[1] = std::numeric_limits<double>::infinity(); }); }},
      {"the curve's knot interval is empty", [] { refused([](BSpline& s) { s.knots.assign(s.knots.size(), 1.0); }); }},
      {"an empty curve has no B-spline", [] { to_bspline({}); }},
      {"point: at least 2 are needed", [&] { from_hermite(one, one, 2); }},
      {"the interval [1, 0] is empty", [&] { from_power(two, 1, 0, 2); }},
      {"a curve segment of degree 69: at most 63 is possible; split it or fit a spline",
       [&] { Curve().append(many, 1); }},
      {"degree 0: at least 1 is needed", [&] { make_bezier(kArch, 0, 2); }},
      {"degree 64: at most 63 is possible", [] { elevate(arch(), 64); }},
      {"1 values for 3 nodes: one a node is needed",
       [&] {
         Lagrange({0, 1, 2}, {1});
       }},
      {"node 1 is given twice",
       [&] {
         Lagrange({0, 1, 1}, {1, 2, 3});
       }},
      {"1 after 2: nodes must ascend", [&] { spline_slopes(x, y); }},
      {"a periodic spline's last value 2 must equal the first, 0",
       [&] { spline_slopes(up, y, {.ends = SplineEnds::periodic}); }},
      {"1 point: at least 2 are needed", [&] { lagrange_curve(one, 2); }},
      {"an empty curve has no bounds", [] { exact_bounds({}); }},
      {"an empty curve has no nearest point", [] { closest_points({}, {}); }},
      {"an empty curve has no nearest point", [] { closest_point({}, {}); }},
  };
  for (const Row& row : rows) EXPECT_TRUE(holds(words_of<BadInput>(row.call), row.words));
}

TEST(CurveMessages, CallsThatAskForNothingAreNamed) {
  const std::vector<double> t{0, 1};
  std::vector<double> out(2), shorter(1);
  const Row rows[] = {
      {"0 points at equal distances: at least 2 are needed", [] { ArcLength(arch()).equal_parts(0); }},
      {"evaluate_cubic: all arrays must have one length",
       [&] {
         evaluate_cubic({kArch[0], kArch[1], kArch[2], kArch[3]}, t, out, out, shorter);
       }},
      {"CubicEvaluator: a polynomial curve of degree 3 or less is needed", [] { CubicEvaluator{rational()}; }},
      {"CubicEvaluator: all arrays must have one length", [&] { CubicEvaluator{arch()}(t, out, out, shorter); }},
      {"knot 7 is not between 0 and 1", [] { insert_knot(spline(), 7); }},
      {"knot 0.5 already has multiplicity 3",
       [] {
         BSpline s = spline();
         for (int k = 0; k < 4; ++k) s = insert_knot(s, 0.5);
       }},
      {"0.5 is not an inner knot", [] { remove_knot(spline(), 0.5, 1); }},
      {"a rational segment has no power basis form", [] { to_power(rational().segment(0)); }},
      {"cannot split at 1: it is not between 0 and 1", [] { split(arch(), 1); }},
      {"degree 0: at least 1 is needed", [] { reduce(arch(), 0); }},
      {"the degree of a rational curve cannot be reduced: flatten or fit it instead", [] { reduce(rational(), 2); }},
      {"the interval from 1 to 0 is empty", [] { trace_explicit(Expression::parse("x"), 1, 0); }},
      {"inflections are asked of plane curves only", [] { inflections(in_space()); }},
      {"the area under a curve in space is not defined: project it first", [] { signed_area(in_space()); }},
      {"a vector file's name must end in .gpkg, .geojson, .shp or .dxf", [] { write_vector_lines({}, "lines.txt"); }},
      {"there is no line to write", [] { write_vector_lines({}, "lines.gpkg"); }},
  };
  for (const Row& row : rows) EXPECT_TRUE(holds(words_of<UsageError>(row.call), row.words));
}

}  // namespace
}  // namespace retalho::test
