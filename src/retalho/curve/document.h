// The JSON form of curves (docs/curve.schema.json): what the user wrote, kept as written, so that reading and writing
// give the same document; and the way from there to the hub.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retalho/curve/bspline.h"
#include "retalho/curve/curve.h"
#include "retalho/curve/interpolate.h"

namespace retalho {

enum class CurveKind {
  bezier,
  chain,
  hermite,
  power,
  bspline,
  spline,
  catmull_rom,
  lagrange,
  polyline,
  implicit_form,
  explicit_form
};
const char* curve_kind_name(CurveKind kind);

/// One entry of "curves". Which members count depends on `kind`; the others stay empty.
struct CurveSpec {
  CurveKind kind = CurveKind::polyline;
  std::string name;
  int dimension = 2;
  bool closed = false;
  int degree = 0;  ///< bezier (0: one segment through all points), bspline
  std::vector<Vec3> points;
  std::vector<Vec3> tangents, seconds;       ///< hermite
  std::vector<double> weights, knots;        ///< bezier, bspline
  std::vector<double> breaks;                ///< bezier, chain, hermite: parameters of the joins; power: from and to
  Curve chain;                               ///< chain: segments of any degree
  SplineEnds ends = SplineEnds::not_a_knot;  ///< spline
  std::optional<Parameters> parameters;      ///< spline, catmull-rom (default centripetal), lagrange (uniform)
  std::string f;                             ///< implicit, explicit
  std::vector<double> box;                   ///< implicit: xmin, ymin, xmax, ymax
  double from = 0, to = 1;                   ///< explicit
};

struct CurveDocument {
  std::vector<CurveSpec> curves;
};

/// Throws BadInput with the place, as in "curves[2].points[5]: expected 3 numbers, got 2"; for text that is not JSON
/// with line and column. `file` is put into the error.
CurveDocument parse_curves(std::string_view json, const std::string& file = {});
CurveDocument read_curves(const std::string& path);
/// Shortest decimal numbers that read back to the same doubles.
std::string to_json(const CurveDocument& document);

/// The hub form of a parametric kind. Throws BadInput with the place below `where` ("curves[2]"). Implicit and explicit
/// forms have no exact one: level/implicit_curve.h and curve/explicit.h trace them.
Curve to_curve(const CurveSpec& spec, const std::string& where = {});
/// The other way: one exact entry (kind bezier where all segments have one degree and share their ends, else chain).
CurveSpec to_spec(const Curve& curve);

}  // namespace retalho
