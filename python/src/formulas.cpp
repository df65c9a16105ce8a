#include "formulas.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <memory>
#include <utility>

#include "arrays.h"
#include "curves.h"
#include "retalho/core/error.h"
#include "retalho/level/implicit_graph.h"
#include "running.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

py::array_t<double> line_of(std::vector<Vec2> points) {
  const Shape shape{count_of(points.size()), 2};
  return own<double>(std::move(points), shape);
}

py::list boxes_of(const std::vector<PlaneBox>& boxes) {
  py::list list;
  for (const PlaneBox& b : boxes) list.append(py::make_tuple(b.x0, b.y0, b.x1, b.y1));
  return list;
}

void add_graph(py::module_& module) {
  py::class_<GraphBox, std::shared_ptr<GraphBox>> graph(
      module, "Graph",
      "The curve y = f(x) on an interval, joined only where f is proved to be continuous.\n\n"
      "f: a formula in x, such as '1 / sin(x)' (docs/curves.md). start < stop. Raises BadInput for a formula that "
      "cannot be read, with the place.");
  graph
      .def(py::init([](const std::string& f, double start, double stop, int threads, const py::object& progress) {
             return std::make_shared<GraphBox>(run(Running{threads, progress}, [&](const Context& context) {
               const Expression expression = Expression::parse(f);
               return GraphBox{f, start, stop, trace_explicit(expression, start, stop, {}, context),
                               polynomial_graph(expression, start, stop)};
             }));
           }),
           py::arg("f"), py::arg("start"), py::arg("stop"), py::kw_only(), py::arg("threads") = 0,
           py::arg("progress") = py::none())
      .def_property_readonly(
          "lines",
          [](const GraphBox& g) {
            py::list list;
            for (const auto& line : g.graph.lines) list.append(line_of(line));
            return list;
          },
          "List of (n, 2), ascending in x; every vertex is (x, f(x)).")
      .def_property_readonly(
          "breaks", [](const GraphBox& g) { return py::array(py::cast(g.graph.breaks)); },
          "(n,): the x between the lines: poles, jumps, ends of the domain.")
      .def_property_readonly(
          "curve",
          [](const GraphBox& g) -> std::shared_ptr<CurveBox> {
            return g.exact ? std::make_shared<CurveBox>(CurveBox{*g.exact}) : nullptr;
          },
          "The graph exactly, as a Curve, where f is a polynomial; else None.")
      .def("__repr__", [](const GraphBox& g) {
        return fmt::format("<retalho.Graph of {}, x {:.6g} to {:.6g}: {} lines>", g.formula, g.from, g.to,
                           g.graph.lines.size());
      });
  graph.attr("__module__") = "retalho";
}

}  // namespace

void add_formulas(py::module_& module) {
  add_graph(module);
  py::class_<LevelSetBox, std::shared_ptr<LevelSetBox>> level(
      module, "LevelSet",
      "The curve f(x, y) = 0 in a box: no part is lost, and lines are only where they are proved.\n\n"
      "f: a formula in x and y, such as 'x^2 + y^2 - 1' (docs/curves.md). box: (xmin, ymin, xmax, ymax). depth: "
      "2^depth cells a side, 1 to 14.");
  level
      .def(
          py::init([](const std::string& f, const py::object& box, int depth, int threads, const py::object& progress) {
            const std::vector<double> b = as_vector(box, "box");
            if (b.size() != 4)
              throw BadInput(fmt::format("box must be four numbers (xmin, ymin, xmax, ymax), not {}", b.size()), {},
                             "box");
            return std::make_shared<LevelSetBox>(run(Running{threads, progress}, [&](const Context& context) {
              return LevelSetBox{
                  f, b, trace_implicit(Expression::parse(f), {b[0], b[1], b[2], b[3]}, {.depth = depth}, context)};
            }));
          }),
          py::arg("f"), py::arg("box"), py::kw_only(), py::arg("depth") = 9, py::arg("threads") = 0,
          py::arg("progress") = py::none())
      .def_property_readonly(
          "lines",
          [](const LevelSetBox& s) {
            py::list list;
            for (const ImplicitLine& line : s.level.lines) {
              std::vector<Vec2> points = line.points;
              if (line.closed && !points.empty()) points.push_back(points.front());
              list.append(line_of(std::move(points)));
            }
            return list;
          },
          "List of (n, 2), points on the curve; of a ring the last is the first again.")
      .def_property_readonly(
          "unresolved", [](const LevelSetBox& s) { return boxes_of(s.level.unresolved); },
          "Cells (xmin, ymin, xmax, ymax) that may hold zeros without a proof: singular points, double factors.")
      .def_property_readonly(
          "doubtful", [](const LevelSetBox& s) { return boxes_of(s.level.doubtful); },
          "Cells where f jumps, has a pole or is not defined everywhere.")
      .def("__repr__", [](const LevelSetBox& s) {
        return fmt::format("<retalho.LevelSet of {}: {} lines, {} cells without a proof>", s.formula,
                           s.level.lines.size(), s.level.unresolved.size() + s.level.doubtful.size());
      });
  level.attr("__module__") = "retalho";
}

}  // namespace retalho::python
