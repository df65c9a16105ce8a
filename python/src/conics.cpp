// Terrain.conics: level lines of Powell-Sabin surfaces as what they are.
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "contours.h"
#include "curves.h"
#include "retalho/level/conics.h"
#include "running.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

py::list conics(const TerrainModel& model, const AskedLines& asked, const Running& running) {
  ConicSet set = run(running, [&](const Context& context) {
    const Terrain& terrain = model.terrain();
    const auto [low, high] = std::minmax_element(terrain.tin.heights.begin(), terrain.tin.heights.end());
    ConicSet lines = trace_conics(terrain, levels_of(asked, *low, *high), context);
    move_to_crs(lines, terrain.georef);
    return lines;
  });
  py::list list;
  for (ConicLine& line : set.lines)
    list.append(py::make_tuple(set.levels[static_cast<std::size_t>(line.level)],
                               std::make_shared<CurveBox>(CurveBox{std::move(line.curve)})));
  return list;
}

}  // namespace

void add_conics(py::module_& module) {
  auto terrain =
      py::reinterpret_borrow<py::class_<TerrainModel, std::shared_ptr<TerrainModel>>>(module.attr("Terrain"));
  terrain.def(
      "conics",
      [](const TerrainModel& model, const py::object& levels, std::optional<double> interval, double base, int threads,
         const py::object& progress) {
        return conics(model, parse_lines(levels, interval, base, {}, false, false), {threads, progress});
      },
      py::arg("levels") = py::none(), py::kw_only(), py::arg("interval") = py::none(), py::arg("base") = 0.0,
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The level lines of a Powell-Sabin surface exactly: rational quadratic Curves in the CRS, high ground on their "
      "left, as a list of (level, Curve), by level. levels, interval and base as contours has them. Raises BadInput "
      "for a Clough-Tocher surface, whose lines are cubics.");
}

}  // namespace retalho::python
