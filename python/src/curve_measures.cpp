// What curves are asked for besides points and joins: where they bend, enclose, come near, and cross themselves.
#include <vector>

#include "arrays.h"
#include "curves.h"
#include "retalho/curve/intersect.h"
#include "retalho/curve/measure.h"
#include "running.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

/// List of (parameter, point, value).
py::list places(const std::vector<CurvePoint>& points, int dimension) {
  py::list list;
  for (const CurvePoint& p : points) list.append(py::make_tuple(p.at, coordinates(p.point, dimension), p.value));
  return list;
}

template <class Ask>
py::list asked(const CurveBox& box, const Ask& ask) {
  return places(run(Running{}, [&](const Context&) { return ask(box.curve); }), box.curve.dimension);
}

}  // namespace

py::tuple coordinates(Vec3 p, int dimension) {
  return dimension == 3 ? py::make_tuple(p.x, p.y, p.z) : py::make_tuple(p.x, p.y);
}

void add_curve_measures(py::module_& module) {
  auto curve = py::reinterpret_borrow<py::class_<CurveBox, std::shared_ptr<CurveBox>>>(module.attr("Curve"));
  curve
      .def(
          "closest_points",
          [](const CurveBox& box, const py::object& point) {
            int dimension = 0;
            const Vec3 p = as_points(point, "point", dimension).at(0);
            return asked(box, [&](const Curve& c) { return closest_points(c, p); });
          },
          py::arg("point"),
          "All local minima of the distance from a point, the nearest first: list of (parameter, point, distance).")
      .def(
          "inflections", [](const CurveBox& box) { return asked(box, [](const Curve& c) { return inflections(c); }); },
          "Where a plane curve changes its side: list of (parameter, point, curvature). Raises UsageError in space.")
      .def(
          "curvature_extrema",
          [](const CurveBox& box) { return asked(box, [](const Curve& c) { return curvature_extrema(c); }); },
          "Local extrema of the curvature inside of segments: list of (parameter, point, curvature).")
      .def(
          "self_intersections",
          [](const CurveBox& box) {
            const auto found = run(Running{}, [&](const Context&) { return self_intersections(box.curve); });
            py::list list;
            for (const Crossing& c : found)
              list.append(py::make_tuple(c.first, c.second, coordinates(c.point, box.curve.dimension)));
            return list;
          },
          "Where the curve meets itself: list of (parameter, parameter, point). Joins do not count.")
      .def_property_readonly(
          "area", [](const CurveBox& box) { return signed_area(box.curve); },
          "Of a plane curve, positive where it runs counter-clockwise; an open one is closed by its chord.");
}

}  // namespace retalho::python
