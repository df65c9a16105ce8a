#include "curves.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "retalho/core/error.h"
#include "retalho/curve/bspline.h"
#include "retalho/curve/continuity.h"
#include "retalho/curve/convert.h"
#include "retalho/curve/edit.h"
#include "retalho/curve/flatten.h"
#include "retalho/curve/interpolate.h"
#include "retalho/curve/intersect.h"
#include "retalho/curve/measure.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

using Box = CurveBox;
using Holder = std::shared_ptr<Box>;
using Class = py::class_<Box, Holder>;

Holder box(Curve curve) {
  return std::make_shared<Box>(Box{std::move(curve)});
}

std::vector<double> optional_vector(const py::object& object, const std::string& name) {
  return object.is_none() ? std::vector<double>{} : as_vector(object, name);
}

/// A value of `width` numbers for each parameter, of shape u.shape + (width,), or u.shape for width 0 (one number).
template <class Body>
py::object at_parameters(const py::object& u, int width, const Body& body) {
  const Doubles parameters = as_doubles(u, "u");
  std::vector<double> out;
  const auto n = static_cast<std::size_t>(parameters.size());
  out.reserve(n * static_cast<std::size_t>(std::max(width, 1)));
  for (std::size_t i = 0; i < n; ++i) body(parameters.data()[i], out);
  Shape shape(parameters.shape(), parameters.shape() + parameters.ndim());
  if (width > 0) shape.push_back(width);
  return shaped(std::move(out), shape);
}

void push(std::vector<double>& out, Vec3 p, int dimension) {
  out.insert(out.end(), {p.x, p.y});
  if (dimension == 3) out.push_back(p.z);
}

py::object derivative(const Curve& curve, const py::object& u, int order) {
  if (order < 0 || order > 3) throw UsageError(fmt::format("order must be 0 to 3, not {}", order), {}, "order");
  return at_parameters(u, curve.dimension, [&](double at, std::vector<double>& out) {
    const CurveJet jet = evaluate_jet(curve, at);
    const std::array<Vec3, 4> all{jet.point, jet.first, jet.second, jet.third};
    push(out, all[static_cast<std::size_t>(order)], curve.dimension);
  });
}

py::list joins_of(const Curve& curve) {
  py::list list;
  for (const Join& join : analyse_joins(curve)) {
    py::dict d;
    d["at"] = join.at;
    d["point"] = coordinates(join.point, curve.dimension);
    d["C"] = join.c;
    d["G"] = join.g;
    d["kind"] = join_kind_name(join.kind);
    d["gap"] = join.gap;
    d["angle"] = join.angle;
    d["curvature_gap"] = join.curvature_gap;
    d["speed_ratio"] = join.speed_ratio;
    list.append(d);
  }
  return list;
}

template <class Kind>
Kind named(const std::string& option, const std::string& word, std::initializer_list<Kind> kinds,
           const char* (*name)(Kind)) {
  std::string list;
  for (const Kind kind : kinds) {
    if (word == name(kind)) return kind;
    list += (list.empty() ? "'" : ", '") + std::string(name(kind)) + "'";
  }
  throw UsageError(fmt::format("{} must be one of {}, not '{}'", option, list, word), {}, option);
}

Parameters parse_parameters(const std::string& word) {
  return named("parameters", word, {Parameters::uniform, Parameters::centripetal, Parameters::chord, Parameters::x},
               &parameters_name);
}

void add_makers(Class& curve) {
  curve.def_static(
      "bezier",
      [](const py::object& points, std::optional<int> degree, const py::object& weights) {
        int dimension = 0;
        const std::vector<Vec3> p = as_points(points, "points", dimension);
        const std::vector<double> w = optional_vector(weights, "weights");
        return box(make_bezier(p, degree.value_or(static_cast<int>(p.size()) - 1), dimension, w));
      },
      py::arg("points"), py::kw_only(), py::arg("degree") = py::none(), py::arg("weights") = py::none(),
      "degree * k + 1 control points, (n, 2) or (n, 3), make k segments; degree None: one segment. weights (n,): "
      "rational.");
  curve.def_static(
      "bspline",
      [](const py::object& points, const py::object& knots, int degree, const py::object& weights) {
        BSpline spline;
        spline.degree = degree;
        spline.points = as_points(points, "points", spline.dimension);
        spline.knots = knots.is_none() ? clamped_knots(spline.points.size(), degree) : as_vector(knots, "knots");
        spline.weights = optional_vector(weights, "weights");
        validate(spline);
        return box(to_curve(spline));
      },
      py::arg("points"), py::arg("knots") = py::none(), py::kw_only(), py::arg("degree") = 3,
      py::arg("weights") = py::none(),
      "A B-spline of n control points and n + degree + 1 knots (None: clamped and uniform); weights: NURBS. Exact.");
  curve.def_static(
      "hermite",
      [](const py::object& points, const py::object& tangents, const py::object& breaks, bool closed) {
        int dimension = 0, other = 0;
        const std::vector<Vec3> p = as_points(points, "points", dimension), t = as_points(tangents, "tangents", other);
        if (dimension != other)
          throw BadInput(fmt::format("points have {} coordinates and tangents {}", dimension, other), {}, "tangents");
        return box(from_hermite(p, t, dimension, optional_vector(breaks, "breaks"), closed));
      },
      py::arg("points"), py::arg("tangents"), py::kw_only(), py::arg("breaks") = py::none(), py::arg("closed") = false,
      "Cubic segments from points and derivatives by the parameter; breaks: the parameters (None: 0, 1, 2, ...).");
  curve.def_static(
      "interpolate",
      [](const py::object& points, const std::string& ends, const std::string& parameters, bool closed,
         const py::object& first_tangent, const py::object& last_tangent) {
        int dimension = 0, other = 0;
        const std::vector<Vec3> p = as_points(points, "points", dimension);
        PointSplineOptions options;
        options.ends = named("ends", ends,
                             {retalho::SplineEnds::not_a_knot, retalho::SplineEnds::natural,
                              retalho::SplineEnds::clamped, retalho::SplineEnds::periodic},
                             &spline_ends_name);
        options.parameters = parse_parameters(parameters);
        options.closed = closed;
        if (!first_tangent.is_none()) options.first_tangent = as_points(first_tangent, "first_tangent", other).at(0);
        if (!last_tangent.is_none()) options.last_tangent = as_points(last_tangent, "last_tangent", other).at(0);
        return box(interpolate_points(p, dimension, options));
      },
      py::arg("points"), py::kw_only(), py::arg("ends") = "not-a-knot", py::arg("parameters") = "centripetal",
      py::arg("closed") = false, py::arg("first_tangent") = py::none(), py::arg("last_tangent") = py::none(),
      "The C2 cubic spline through points. ends: not-a-knot, natural, clamped (with the tangents dQ/du) or periodic; "
      "parameters: uniform, centripetal, chord or x.");
  curve.def_static(
      "catmull_rom",
      [](const py::object& points, bool closed, double power) {
        int dimension = 0;
        const std::vector<Vec3> p = as_points(points, "points", dimension);
        return box(catmull_rom(p, dimension, closed, power));
      },
      py::arg("points"), py::kw_only(), py::arg("closed") = false, py::arg("power") = 0.5,
      "Cubics through points, tangents by the neighbours; power 0 uniform, 0.5 centripetal, 1 chord length.");
  curve.def_static(
      "lagrange",
      [](const py::object& points, const std::string& parameters) {
        int dimension = 0;
        const std::vector<Vec3> p = as_points(points, "points", dimension);
        return box(lagrange_curve(p, dimension, parse_parameters(parameters)));
      },
      py::arg("points"), py::kw_only(), py::arg("parameters") = "uniform",
      "The polynomial through all points: for few of them, it oscillates.");
  curve.def_static(
      "polyline",
      [](const py::object& points, bool closed) {
        int dimension = 0;
        const std::vector<Vec3> p = as_points(points, "points", dimension);
        return box(make_polyline(p, dimension, closed));
      },
      py::arg("points"), py::kw_only(), py::arg("closed") = false, "Straight segments.");
}

void add_questions(Class& curve) {
  curve.def(
      "__call__", [](const Box& b, const py::object& u) { return derivative(b.curve, u, 0); }, py::arg("u"),
      "Points at parameters u (clamped), shape u.shape + (2,) or (3,).");
  curve.def(
      "derivative", [](const Box& b, const py::object& u, int order) { return derivative(b.curve, u, order); },
      py::arg("u"), py::kw_only(), py::arg("order") = 1,
      "The derivative by u of order 0 to 3; at a join, the right one.");
  curve.def(
      "curvature",
      [](const Box& b, const py::object& u) {
        return at_parameters(u, 0, [&](double at, std::vector<double>& out) { out.push_back(curvature(b.curve, at)); });
      },
      py::arg("u"), "1 / length; signed in the plane (positive to the left); 0 where the speed is zero.");
  curve.def(
      "joins", [](const Box& b) { return joins_of(b.curve); },
      "One dict a join and a singular point: at, point, C and G (highest continuity to 2; -1: a gap), kind, gap, "
      "angle (radians), curvature_gap, speed_ratio.");
  curve.def(
      "flatten",
      [](const Box& b, double tolerance) {
        const FlatCurve flat = flatten(b.curve, tolerance);
        py::list lines;
        for (std::size_t k = 0; k < flat.starts.size(); ++k) {
          const auto from = flat.points.begin() + flat.starts[k];
          const auto to = k + 1 < flat.starts.size() ? flat.points.begin() + flat.starts[k + 1] : flat.points.end();
          lines.append(coordinates(std::vector<Vec3>(from, to), b.curve.dimension));
        }
        return lines;
      },
      py::kw_only(), py::arg("tolerance"), "Polylines, list of (n, 2) or (n, 3), nowhere farther away (proved).");
  curve.def(
      "closest",
      [](const Box& b, const py::object& point) {
        int dimension = 0;
        const CurvePoint c = closest_point(b.curve, as_points(point, "point", dimension).at(0));
        return py::make_tuple(c.at, coordinates(c.point, b.curve.dimension), c.value);
      },
      py::arg("point"), "(parameter, point, distance) of the nearest point of the curve.");
  curve.def(
      "intersections",
      [](const Box& a, const Box& b) {
        py::list list;
        for (const Crossing& c : intersections(a.curve, b.curve))
          list.append(py::make_tuple(c.first, c.second, coordinates(c.point, a.curve.dimension)));
        return list;
      },
      py::arg("other"), "List of (parameter, parameter on the other, point).");
  curve.def_property_readonly(
      "length", [](const Box& b) { return arc_length(b.curve); }, "Arc length, to 1e-12 of itself.");
  curve.def_property_readonly(
      "bounds",
      [](const Box& b) {
        const Bounds3 box = exact_bounds(b.curve);
        return py::make_tuple(coordinates(box.low, b.curve.dimension), coordinates(box.high, b.curve.dimension));
      },
      "(low, high): the exact box.");
}

void add_changes(Class& curve) {
  curve.def(
      "split",
      [](const Box& b, double u) {
        auto [left, right] = split(b.curve, u);
        return py::make_tuple(box(std::move(left)), box(std::move(right)));
      },
      py::arg("u"), "The curves before and after a parameter.");
  curve.def(
      "cut", [](const Box& b, double u0, double u1) { return box(cut(b.curve, u0, u1)); }, py::arg("u0"), py::arg("u1"),
      "The part between two parameters.");
  curve.def(
      "reversed", [](const Box& b) { return box(reverse(b.curve)); }, "The curve run backwards.");
  curve.def(
      "elevated", [](const Box& b, int degree) { return box(elevate(b.curve, degree)); }, py::arg("degree"),
      "The same curve with segments of at least that degree.");
  curve.def(
      "reduced",
      [](const Box& b, int degree) {
        Reduction r = reduce(b.curve, degree);
        return py::make_tuple(box(std::move(r.curve)), r.error);
      },
      py::arg("degree"), "(curve, bound of the error): segments of at most that degree.");
  curve.def(
      "to_bspline",
      [](const Box& b, double tolerance) {
        const BSpline s = to_bspline(b.curve, tolerance);
        py::dict d;
        d["degree"] = s.degree;
        d["knots"] = py::array(py::cast(s.knots));
        d["points"] = coordinates(s.points, s.dimension);
        d["weights"] = s.weights.empty() ? py::object(py::none()) : py::object(py::array(py::cast(s.weights)));
        return d;
      },
      py::kw_only(), py::arg("tolerance") = 1e-10, "degree, knots, points, weights of the same curve as one B-spline.");
}

std::string repr(const Box& b) {
  return fmt::format("<retalho.Curve in {}: {} segments of degree {}{}{}, u {:.6g} to {:.6g}>",
                     b.curve.dimension == 2 ? "the plane" : "space", b.curve.segment_count(), b.curve.degree(),
                     b.curve.rational() ? ", rational" : "", b.curve.closed ? ", closed" : "", b.curve.begin(),
                     b.curve.end());
}

}  // namespace

void add_curves(py::module_& module) {
  Class curve(module, "Curve",
              "A chain of Bezier segments, polynomial or rational, in the plane or in space. Immutable.");
  add_makers(curve);
  add_questions(curve);
  add_changes(curve);
  curve.def_property_readonly(
      "control_points",
      [](const py::object& self) {  // in the plane z is 0 and left out by the view's stride
        const Curve& c = py::cast<const Box&>(self).curve;
        py::array_t<double> all = view<double>(c.points.data(), {count_of(c.points.size()), 3}, self);
        const py::slice every(std::nullopt, std::nullopt, std::nullopt);
        return all.attr("__getitem__")(py::make_tuple(every, py::slice(0, c.dimension, 1)));
      },
      "(n, 2) or (n, 3) of all segments, one segment after the other. A read-only view.");
  curve.def_property_readonly(
      "breaks",
      [](const py::object& self) {
        const Curve& c = py::cast<const Box&>(self).curve;
        return view<double>(c.breaks.data(), {count_of(c.breaks.size())}, self);
      },
      "(segments + 1,): the parameters of ends and joins. A read-only view.");
  curve.def_property_readonly("dimension", [](const Box& b) { return b.curve.dimension; })
      .def_property_readonly("degree", [](const Box& b) { return b.curve.degree(); })
      .def_property_readonly("closed", [](const Box& b) { return b.curve.closed; })
      .def("__len__", [](const Box& b) { return b.curve.segment_count(); })
      .def("__repr__", &repr);
  curve.attr("__module__") = "retalho";
}

}  // namespace retalho::python
