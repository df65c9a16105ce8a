#include "visibility.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

#include "arrays.h"
#include "grid.h"
#include "retalho/core/error.h"
#include "retalho/visibility/intervisibility.h"
#include "retalho/visibility/line_of_sight.h"
#include "retalho/visibility/viewshed.h"
#include "tiled_model.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

VoidRule parse_voids(const std::string& name) {
  if (name == "transparent") return VoidRule::transparent;
  if (name == "blocks") return VoidRule::blocks;
  throw UsageError("voids must be 'transparent' or 'blocks', not '" + name + "'", {}, "voids");
}

/// (n, 2) or (n, 3) CRS coordinates; the third is the eye's height above the ground.
std::vector<Observer> observers_of(const CellHeights& cells, const py::object& observers, double height) {
  int dimension = 0;
  const std::vector<Vec3> points = as_points(observers, "observers", dimension);
  if (points.empty()) throw BadInput("there are no observers: the shape is (0, 2)", {}, "observers");
  std::vector<Observer> all;
  for (const Vec3& p : points) {
    const double eye = dimension == 3 ? p.z : height;
    if (!std::isfinite(eye)) throw BadInput(fmt::format("an observer's height is {}", eye), {}, "observers");
    all.push_back(observer_at(cells, {p.x, p.y}, eye));
  }
  return all;
}

Shape shape_of(const Raster& raster) {
  return {raster.rows, raster.columns};
}

std::pair<double, double> pair_of(const py::object& object, const std::string& name) {
  const std::vector<double> both = as_vector(object, name);
  if (both.size() != 2 || !std::isfinite(both[0]) || !std::isfinite(both[1]))
    throw BadInput(fmt::format("{} must be two numbers of degrees", name), {}, name);
  return {both[0], both[1]};
}

py::object viewshed_of(const py::object& z, const py::object& observers, const Placing& placing,
                       const std::string& what, double observer_height, ViewshedOptions options,
                       const py::object& azimuth, const py::object& vertical, const Running& running) {
  if (what != "visible" && what != "count" && what != "height")
    throw UsageError("what must be 'visible', 'count' or 'height', not '" + what + "'", {}, "what");
  if (!(options.radius >= 0))
    throw UsageError(fmt::format("radius must be 0 or more, not {}", options.radius), {}, "radius");
  if (!azimuth.is_none()) {
    std::tie(options.azimuth_from, options.azimuth_to) = pair_of(azimuth, "azimuth");
    if (options.azimuth_to < options.azimuth_from) options.azimuth_to += 360;
  }
  if (!vertical.is_none()) std::tie(options.lowest, options.highest) = pair_of(vertical, "vertical");
  const auto raster = raster_of(z, placing, running);
  const std::vector<Observer> eyes = observers_of(cells_of(*raster), observers, observer_height);
  if (what == "height")
    return own<float>(
        run(running, [&](const Context& context) { return needed_heights(*raster, eyes, options, context); }),
        shape_of(*raster));
  std::vector<std::uint32_t> counts =
      run(running, [&](const Context& context) { return observer_counts(*raster, eyes, options, context); });
  if (what == "count") return own<std::uint32_t>(std::move(counts), shape_of(*raster));
  std::vector<std::uint8_t> seen(counts.size());
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = counts[i] > 0 ? 1 : 0;
  return own<bool>(std::move(seen), shape_of(*raster));
}

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

void add_sight(py::module_& module) {
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
      .def("__repr__", [](const Sight& s) {
        return fmt::format("<retalho.SightLine {} over {:.6g}>", s.line.visible ? "visible" : "blocked",
                           s.line.profile.back().distance);
      });
  sight.attr("__module__") = "retalho";
  module.def(
      "line_of_sight",
      [](const py::object& z, const py::object& observer, const py::object& target, const py::object& transform,
         const py::object& crs, const py::object& nodata, double observer_height, double target_height,
         double frequency, bool earth_curvature, double refraction, const std::string& voids, int threads,
         const py::object& progress) {
        const Running running{threads, progress};
        const SightOptions options{target_height, frequency, earth_curvature, refraction, parse_voids(voids)};
        const auto over = [&](const CellHeights& cells) {
          const Observer from = observers_of(cells, observer, observer_height).front();
          const Observer to = observers_of(cells, target, 0).front();
          return Sight{line_of_sight(cells, from, to.column, to.row, options), cells.georef};
        };
        if (py::isinstance<TiledModel>(z)) {
          if (!transform.is_none() || !crs.is_none() || !nodata.is_none())
            throw UsageError("z is a TiledModel, which says itself where it lies: leave transform, crs and nodata out",
                             {}, "transform");
          return over(cells_of(py::cast<const TiledModel&>(z).reader()));
        }
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        return over(cells_of(*raster));
      },
      py::arg("z"), py::arg("observer"), py::arg("target"), py::kw_only(), py::arg("transform") = py::none(),
      py::arg("crs") = py::none(), py::arg("nodata") = py::none(), py::arg("observer_height") = 2.0,
      py::arg("target_height") = 0.0, py::arg("frequency") = 0.0, py::arg("earth_curvature") = false,
      py::arg("refraction") = 0.13, py::arg("voids") = "transparent", py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "The sight line between the cells at two places (x, y) of the CRS. Heights are above the ground; frequency in "
      "Hz, for the Fresnel zone. Of a TiledModel only the tiles beside the line are read.");
}

}  // namespace

void add_visibility(py::module_& module) {
  module.def(
      "viewshed",
      [](const py::object& z, const py::object& observers, const py::object& transform, const py::object& crs,
         const py::object& nodata, const std::string& what, double observer_height, double target_height, double radius,
         const py::object& azimuth, const py::object& vertical, bool earth_curvature, double refraction,
         const std::string& voids, int threads, const py::object& progress) {
        ViewshedOptions options;
        options.target_height = target_height;
        options.radius = radius;
        options.earth_curvature = earth_curvature;
        options.refraction = refraction;
        options.voids = parse_voids(voids);
        return viewshed_of(z, observers, {transform, crs, nodata}, what, observer_height, options, azimuth, vertical,
                           {threads, progress});
      },
      py::arg("z"), py::arg("observers"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("what") = "visible", py::arg("observer_height") = 2.0,
      py::arg("target_height") = 0.0, py::arg("radius") = 0.0, py::arg("azimuth") = py::none(),
      py::arg("vertical") = py::none(), py::arg("earth_curvature") = false, py::arg("refraction") = 0.13,
      py::arg("voids") = "transparent", py::arg("threads") = 0, py::arg("progress") = py::none(),
      "What is seen from where, exactly, on a grid or on a Terrain at the cells of its grid.\n\n"
      "observers: (n, 2) or (n, 3), x, y in the CRS and the eye's height above the ground (else observer_height). "
      "what: 'visible', bool (rows, columns), True where any observer sees the cell; 'count', uint32, how many do; "
      "'height', float32, how high above its ground a target must be to be seen (NaN: nothing helps, or no data). "
      "radius: horizontal units, 0: no limit. azimuth: (from, to) degrees clockwise from north; vertical: (low, high) "
      "degrees above the horizontal. Raises BadInput for an observer outside of the data.");
  module.def(
      "intervisibility",
      [](const py::object& z, const py::object& transform, const py::object& crs, const py::object& nodata,
         int directions, double observer_height, double target_height, double radius, int threads,
         const py::object& progress) {
        const Running running{threads, progress};
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        const IntervisibilityOptions options{directions, observer_height, target_height, radius};
        return own<float>(
            run(running, [&](const Context& context) { return intervisibility_map(*raster, options, context); }),
            shape_of(*raster));
      },
      py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("directions") = 180, py::arg("observer_height") = 2.0,
      py::arg("target_height") = 0.0, py::arg("radius") = 0.0, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "How many cells each cell sees, float32 (rows, columns), by rays in so many directions; NaN: no data. Within "
      "about 0.06 % of the cells (RMSE) of the exact count at 180 directions.");
  add_sight(module);
}

}  // namespace retalho::python
