#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/render/profile_picture.h"
#include "retalho/visibility/line_of_sight.h"
#include "running.h"
#include "tiled_model.h"
#include "visibility.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

struct Sight {
  SightLine line;
  Georef georef;
};

py::array profile_of(const Sight& sight) {
  std::vector<double> rows;
  for (const ProfilePoint& p : sight.line.profile) {
    const Vec2 at = sight.georef.to_crs(p.at);
    rows.insert(rows.end(), {p.distance, at.x, at.y, p.ground, p.sight, p.fresnel});
  }
  return own<double>(std::move(rows), {count_of(sight.line.profile.size()), 6});
}

void add_class(py::module_& module) {
  py::class_<Sight> sight(module, "SightLine", "The straight line between an observer and a target.");
  sight.def_property_readonly("visible", [](const Sight& s) { return s.line.visible; })
      .def_property_readonly(
          "clearance", [](const Sight& s) { return s.line.clearance; },
          "Smallest height over the ground between the ends; negative: blocked.")
      .def_property_readonly(
          "fresnel_clear", [](const Sight& s) { return s.line.fresnel_clear; },
          "Smallest clearance over the first Fresnel zone's radius; NaN without a frequency.")
      .def_property_readonly(
          "blocked_at", [](const Sight& s) { return s.line.blocked_at; },
          "Distance of the first blocking crossing, horizontal units; NaN when visible.")
      .def_property_readonly("profile", &profile_of,
                             "(n, 6): distance, x, y, ground, sight, Fresnel radius, from the observer to the target.")
      .def(
          "write",
          [](const Sight& s, const py::object& path, bool overwrite) {
            const std::string name = path_text(path);
            run(Running{},
                [&](const Context&) { write_picture(profile_picture(s.line, s.georef.unit), name, overwrite); });
          },
          py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
          "The profile as a picture, .svg, .pdf or .png: the ground, the line, the Fresnel zone, where it is blocked. "
          "Raises CannotWrite.")
      .def("__repr__", [](const Sight& s) {
        return fmt::format("<retalho.SightLine {} over {:.6g}>", s.line.visible ? "visible" : "blocked",
                           s.line.profile.back().distance);
      });
  sight.attr("__module__") = "retalho";
}

Sight over_cells(const CellHeights& cells, const Eye& from, const Eye& to, const SightOptions& options) {
  const Observer observer = observer_at(cells, from.crs, from.height), target = observer_at(cells, to.crs, 0);
  return {line_of_sight(cells, observer, target.column, target.row, options), cells.georef};
}

Sight sight_of(const py::object& z, const Eye& from, const Eye& to, const Placing& placing, bool exact,
               const SightOptions& options, const Running& running) {
  if (exact) {
    const auto model = exact_model(z, placing);
    return run(running, [&](const Context& context) {
      const Georef& georef = model->terrain().georef;
      return Sight{surface_line_of_sight(model->evaluator(context), on_surface(georef, {from}).front(),
                                         georef.to_local(to.crs), options),
                   georef};
    });
  }
  if (py::isinstance<TiledModel>(z)) {
    if (!placing.transform.is_none() || !placing.crs.is_none() || !placing.nodata.is_none())
      throw UsageError("z is a TiledModel, which says itself where it lies: leave transform, crs and nodata out", {},
                       "transform");
    const auto& tiles = py::cast<const TiledModel&>(z);
    return run(running, [&](const Context& context) {
      CellHeights cells = cells_of(tiles.reader());
      cells.at = [&, at = std::move(cells.at)](int column, int row) {
        context.check();
        return at(column, row);
      };
      return over_cells(cells, from, to, options);
    });
  }
  const auto raster = raster_of(z, placing, running);
  return run(running, [&](const Context&) { return over_cells(cells_of(*raster), from, to, options); });
}

}  // namespace

void add_sight(py::module_& module) {
  add_class(module);
  module.def(
      "line_of_sight",
      [](const py::object& z, const py::object& observer, const py::object& target, const py::object& transform,
         const py::object& crs, const py::object& nodata, double observer_height, double target_height,
         double frequency, bool earth_curvature, double refraction, const std::string& voids, bool exact, int threads,
         const py::object& progress) {
        const SightOptions options{target_height, frequency, earth_curvature, refraction, parse_voids(voids)};
        return sight_of(z, eyes_of(observer, "observer", observer_height).front(), eyes_of(target, "target", 0).front(),
                        {transform, crs, nodata}, exact, options, {threads, progress});
      },
      py::arg("z"), py::arg("observer"), py::arg("target"), py::kw_only(), py::arg("transform") = py::none(),
      py::arg("crs") = py::none(), py::arg("nodata") = py::none(), py::arg("observer_height") = 2.0,
      py::arg("target_height") = 0.0, py::arg("frequency") = 0.0, py::arg("earth_curvature") = false,
      py::arg("refraction") = 0.13, py::arg("voids") = "transparent", py::arg("exact") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "The sight line between the cells at two places (x, y) of the CRS. Heights are above the ground; frequency in "
      "Hz, for the Fresnel zone. exact: z is a Terrain, and the line runs between the places themselves over its "
      "surface. Of a TiledModel only the tiles beside the line are read.");
}

}  // namespace retalho::python
