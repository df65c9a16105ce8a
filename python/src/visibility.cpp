#include "visibility.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.h"
#include "grid.h"
#include "retalho/core/error.h"
#include "retalho/raster/part.h"
#include "retalho/visibility/intervisibility.h"
#include "retalho/visibility/surface_viewshed.h"
#include "retalho/visibility/viewshed.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

Shape shape_of(const Raster& raster) {
  return {raster.rows, raster.columns};
}

std::pair<double, double> pair_of(const py::object& object, const std::string& name) {
  const std::vector<double> both = as_vector(object, name);
  if (both.size() != 2 || !std::isfinite(both[0]) || !std::isfinite(both[1]))
    throw BadInput(fmt::format("{} must be two numbers of degrees", name), {}, name);
  return {both[0], both[1]};
}

/// What each cell gets, as `what` says.
struct Maps {
  std::vector<std::uint32_t> counts;
  std::vector<float> heights;
  Shape shape;
};

Maps on_cells(const Raster& raster, const std::vector<Eye>& eyes, bool heights, const ViewshedOptions& options,
              const Context& context) {
  std::vector<Observer> observers;
  observers.reserve(eyes.size());
  for (const Eye& eye : eyes) observers.push_back(observer_at(raster, eye.crs, eye.height));
  Maps maps{{}, {}, shape_of(raster)};
  if (heights)
    maps.heights = needed_heights(raster, observers, options, context);
  else
    maps.counts = observer_counts(raster, observers, options, context);
  return maps;
}

Maps on_model(const TerrainModel& model, const std::vector<Eye>& eyes, bool heights, const ViewshedOptions& options,
              const Context& context) {
  const TerrainEvaluator& evaluator = model.evaluator(context);
  const std::vector<SurfaceObserver> observers = on_surface(model.terrain().georef, eyes);
  Maps maps{{}, {}, {model.terrain().grid.rows, model.terrain().grid.columns}};
  if (heights)
    maps.heights = surface_needed_heights(evaluator, observers, options, context);
  else
    maps.counts = surface_observer_counts(evaluator, observers, options, context);
  return maps;
}

/// The field of view; throws UsageError, BadInput.
void set_field(ViewshedOptions& options, const py::object& azimuth, const py::object& vertical) {
  if (!(options.radius >= 0))
    throw UsageError(fmt::format("radius must be 0 or more, not {}", options.radius), {}, "radius");
  if (!azimuth.is_none()) {
    std::tie(options.azimuth_from, options.azimuth_to) = pair_of(azimuth, "azimuth");
    if (options.azimuth_to < options.azimuth_from) options.azimuth_to += 360;
  }
  if (!vertical.is_none()) std::tie(options.lowest, options.highest) = pair_of(vertical, "vertical");
}

py::object viewshed_of(const py::object& z, const std::vector<Eye>& eyes, const Placing& placing,
                       const std::string& what, bool exact, const ViewshedOptions& options, const Running& running) {
  if (what != "visible" && what != "count" && what != "height")
    throw UsageError("what must be 'visible', 'count' or 'height', not '" + what + "'", {}, "what");
  const bool heights = what == "height";
  Maps maps;
  if (exact) {
    const auto model = exact_model(z, placing);
    maps = run(running, [&](const Context& context) { return on_model(*model, eyes, heights, options, context); });
  } else {
    const auto raster = raster_of(z, placing, running);
    maps = run(running, [&](const Context& context) { return on_cells(*raster, eyes, heights, options, context); });
  }
  if (heights) return own<float>(std::move(maps.heights), maps.shape);
  if (what == "count") return own<std::uint32_t>(std::move(maps.counts), maps.shape);
  std::vector<std::uint8_t> seen(maps.counts.size());
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = maps.counts[i] > 0 ? 1 : 0;
  return own<bool>(std::move(seen), maps.shape);
}

py::object intervisibility_of(const Raster& raster, std::optional<int> stride, const IntervisibilityOptions& options,
                              const Running& running) {
  if (!stride)
    return own<float>(
        run(running, [&](const Context& context) { return intervisibility_map(raster, options, context); }),
        shape_of(raster));
  Raster map = run(running, [&](const Context& context) {
    Raster counts = raster;
    counts.heights = exact_intervisibility(raster, *stride, options, context);
    return thinned(counts, *stride);
  });
  const Shape shape = shape_of(map);
  return own<float>(std::move(std::get<std::vector<float>>(map.heights)), shape);
}

}  // namespace

VoidRule parse_voids(const std::string& name) {
  if (name == "transparent") return VoidRule::transparent;
  if (name == "blocks") return VoidRule::blocks;
  throw UsageError("voids must be 'transparent' or 'blocks', not '" + name + "'", {}, "voids");
}

std::vector<Eye> eyes_of(const py::object& places, const std::string& name, double height) {
  int dimension = 0;
  const std::vector<Vec3> points = as_points(places, name, dimension);
  if (points.empty()) throw BadInput(fmt::format("there are no {}: the shape is (0, 2)", name), {}, name);
  std::vector<Eye> eyes;
  eyes.reserve(points.size());
  for (const Vec3& p : points) {
    eyes.push_back({{p.x, p.y}, dimension == 3 ? p.z : height});
    if (!std::isfinite(eyes.back().height))
      throw BadInput(fmt::format("an observer's height is {}", eyes.back().height), {}, name);
  }
  return eyes;
}

std::vector<SurfaceObserver> on_surface(const Georef& georef, const std::vector<Eye>& eyes) {
  std::vector<SurfaceObserver> all;
  all.reserve(eyes.size());
  for (const Eye& eye : eyes) all.push_back({georef.to_local(eye.crs), eye.height});
  return all;
}

std::shared_ptr<const TerrainModel> exact_model(const py::object& z, const Placing& placing) {
  if (!py::isinstance<TerrainModel>(z))
    throw UsageError(
        "exact=True asks a Terrain's surface itself, and z is none: fit the grid first (retalho.fit); of a TiledModel "
        "take a part (TiledModel.part)",
        {}, "exact");
  if (!placing.transform.is_none() || !placing.crs.is_none() || !placing.nodata.is_none())
    throw UsageError("z is a Terrain, which says itself where it lies: leave transform, crs and nodata out", {},
                     "transform");
  return py::cast<std::shared_ptr<TerrainModel>>(z);
}

void add_visibility(py::module_& module) {
  module.def(
      "viewshed",
      [](const py::object& z, const py::object& observers, const py::object& transform, const py::object& crs,
         const py::object& nodata, const std::string& what, double observer_height, double target_height, double radius,
         const py::object& azimuth, const py::object& vertical, bool earth_curvature, double refraction,
         const std::string& voids, bool exact, int threads, const py::object& progress) {
        ViewshedOptions options;
        options.target_height = target_height;
        options.radius = radius;
        options.earth_curvature = earth_curvature;
        options.refraction = refraction;
        options.voids = parse_voids(voids);
        set_field(options, azimuth, vertical);
        return viewshed_of(z, eyes_of(observers, "observers", observer_height), {transform, crs, nodata}, what, exact,
                           options, {threads, progress});
      },
      py::arg("z"), py::arg("observers"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("what") = "visible", py::arg("observer_height") = 2.0,
      py::arg("target_height") = 0.0, py::arg("radius") = 0.0, py::arg("azimuth") = py::none(),
      py::arg("vertical") = py::none(), py::arg("earth_curvature") = false, py::arg("refraction") = 0.13,
      py::arg("voids") = "transparent", py::arg("exact") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "What is seen from where, exactly, on a grid or on a Terrain at the cells of its grid.\n\n"
      "observers: (n, 2) or (n, 3), x, y in the CRS and the eye's height above the ground (else observer_height). "
      "what: 'visible', bool (rows, columns), True where any observer sees the cell; 'count', uint32, how many do; "
      "'height', float32, how high above its ground a target must be to be seen (NaN: nothing helps, or no data). "
      "radius: horizontal units, 0: no limit. azimuth: (from, to) degrees clockwise from north; vertical: (low, high) "
      "degrees above the horizontal. exact: z is a Terrain, whose surface itself decides, not its heights at cells; "
      "observers stand where they are said to, not in the middle of a cell. Raises BadInput for an observer outside of "
      "the data.");
  module.def(
      "intervisibility",
      [](const py::object& z, const py::object& transform, const py::object& crs, const py::object& nodata,
         int directions, double observer_height, double target_height, double radius, std::optional<int> stride,
         int threads, const py::object& progress) {
        const Running running{threads, progress};
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        return intervisibility_of(*raster, stride, {directions, observer_height, target_height, radius}, running);
      },
      py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("directions") = 180, py::arg("observer_height") = 2.0,
      py::arg("target_height") = 0.0, py::arg("radius") = 0.0, py::arg("stride") = py::none(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "How many cells each cell sees, float32 (rows, columns), by rays in so many directions; NaN: no data. Within "
      "about 0.06 % of the cells (RMSE) of the exact count at 180 directions. stride: exact counts instead, from the "
      "middle cell of each stride x stride block alone: element (i, j) is of the cell (i stride + stride // 2, "
      "j stride + stride // 2). One sweep of the grid a block: for checks and small grids.");
}

}  // namespace retalho::python
