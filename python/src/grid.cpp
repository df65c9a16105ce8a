#include "grid.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "arrays.h"
#include "data_array.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/raster/gdal.h"
#include "retalho/raster/height_sink.h"
#include "retalho/raster/io.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Heights out of an array of numbers, row by row, as read_raster would keep them.
template <class Number>
std::variant<std::vector<float>, std::vector<double>> heights_of(const Number* from, const bool* mask,
                                                                 std::size_t cells, double nodata,
                                                                 const Context& context) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  HeightSink sink(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    if (i % kBlock == 0) context.check();
    const auto height = static_cast<double>(from[i]);
    sink.add((mask != nullptr && mask[i]) || !std::isfinite(height) || height == nodata ? kNan : height);
  }
  return sink.take();
}

template <class Number>
std::variant<std::vector<float>, std::vector<double>> take_heights(const py::array& array, const py::object& mask,
                                                                   double nodata, const Running& running) {
  const auto values = py::cast<py::array_t<Number, py::array::c_style | py::array::forcecast>>(array);
  py::array_t<bool, py::array::c_style | py::array::forcecast> masked;
  if (!mask.is_none()) masked = py::cast<decltype(masked)>(mask);
  const bool* bits = mask.is_none() ? nullptr : masked.data();
  const Number* from = values.data();
  const auto cells = static_cast<std::size_t>(values.size());
  return run(running, [=](const Context& context) { return heights_of(from, bits, cells, nodata, context); });
}

Raster from_array(const py::object& z, const Placing& placing, const Running& running) {
  py::object mask;
  const py::array array = as_array(z, "z", mask);
  if (array.ndim() != 2 || array.size() == 0)
    throw BadInput(fmt::format("z must have the shape (rows, columns), not {}{}", shape_text(array),
                               array.ndim() == 3 ? ": take one band, z[0]" : ""),
                   {}, "z");
  const double nodata = placing.nodata.is_none() ? kNan : py::cast<double>(placing.nodata);
  Raster raster;
  if (array.shape(0) > 65535 || array.shape(1) > 65535)
    throw BadInput(fmt::format("z has the shape {}: a side may have at most 65,535 cells", shape_text(array)), {}, "z");
  const int rows = static_cast<int>(array.shape(0)), columns = static_cast<int>(array.shape(1));
  if (placing.transform.is_none()) {
    if (!placing.crs.is_none())
      throw UsageError("crs without transform: where the cells lie in it is not known", {}, "transform");
    raster.rows = rows;
    raster.columns = columns;
  } else {
    raster = empty_raster(as_transform(placing.transform), crs_text(placing.crs), columns, rows);
  }
  const bool single = array.itemsize() <= 4 && array.dtype().kind() == 'f';
  raster.heights =
      single ? take_heights<float>(array, mask, nodata, running) : take_heights<double>(array, mask, nodata, running);
  return raster;
}

py::array heights_view(const Raster& raster, const py::object& owner) {
  const Shape shape{raster.rows, raster.columns};
  return std::visit(
      [&](const auto& h) -> py::array {
        return view<typename std::decay_t<decltype(h)>::value_type>(h.data(), shape, owner);
      },
      raster.heights);
}

Transform own_transform(const Raster& raster) {
  return transform_of(raster.georef, {0, 0}, {raster.cell_width, raster.cell_height});
}

std::string repr(const Grid& grid) {
  const Raster& r = *grid.raster;
  return fmt::format("<retalho.Grid {} x {} cells of {:.6g} x {:.6g} {}, {}>", r.rows, r.columns, r.cell_width,
                     r.cell_height, r.georef.unit, crs_title(r.georef));
}

}  // namespace

Transform as_transform(const py::object& object) {
  const Doubles numbers = as_doubles(object, "transform");
  if (numbers.ndim() != 1 || (numbers.size() != 6 && numbers.size() != 9))
    throw BadInput(
        fmt::format("transform must be six numbers (a, b, c, d, e, f), x = a column + b row + c and y = d column + e "
                    "row + f, as rasterio's Affine; its shape is {}",
                    shape_text(numbers)),
        {}, "transform");
  Transform t{};
  std::copy_n(numbers.data(), 6, t.begin());
  for (const double v : t)
    if (!std::isfinite(v)) throw BadInput("transform holds a number that is not finite", {}, "transform");
  const std::string text = fmt::format("({}, {}, {}, {}, {}, {})", t[0], t[1], t[2], t[3], t[4], t[5]);
  if (t[1] != 0 || t[3] != 0)
    throw BadInput("transform " + text + " is rotated or sheared: warp the grid north-up first", {}, "transform");
  if (t[0] <= 0 || t[4] >= 0)
    throw BadInput("transform " + text +
                       " does not go from north-west: rows run from north to south (e < 0) and columns from west to "
                       "east (a > 0). Flip the array, z[::-1], and give the transform of the flipped one (GDAL's own "
                       "order is another one: use rasterio's)",
                   {}, "transform");
  return t;
}

Transform transform_of(const Georef& georef, Vec2 first, Vec2 cell) {
  const Vec2 centre = georef.to_crs(first);
  const double a = cell.x / georef.scale_x, e = -cell.y / georef.scale_y;
  return {a, 0, centre.x - a / 2, 0, e, centre.y - e / 2};
}

py::tuple to_tuple(const Transform& t) {
  return py::make_tuple(t[0], t[1], t[2], t[3], t[4], t[5]);
}

std::string crs_text(const py::object& crs) {
  if (crs.is_none()) return {};
  if (py::hasattr(crs, "to_wkt")) return py::cast<std::string>(crs.attr("to_wkt")());
  if (py::isinstance<py::str>(crs)) return py::cast<std::string>(crs);
  throw py::type_error("crs must be a str (\"EPSG:32611\", WKT) or have to_wkt(), not " +
                       py::cast<std::string>(py::str(py::type::of(crs))));
}

py::object crs_object(const Georef& georef) {
  if (georef.crs_wkt.empty()) return py::none();
  return py::str(georef.crs_wkt);
}

std::string crs_title(const Georef& georef) {
  const std::size_t from = georef.crs_wkt.find('"');
  const std::size_t to = from == std::string::npos ? from : georef.crs_wkt.find('"', from + 1);
  return to == std::string::npos ? "no CRS" : georef.crs_wkt.substr(from + 1, to - from - 1);
}

WriteOptions write_options(const std::string& path, bool cog, bool overwrite) {
  if (cog && !path.ends_with(".tif") && !path.ends_with(".tiff"))
    throw UsageError("'" + path + "' must end in .tif or .tiff: a Cloud-Optimised GeoTIFF is one", path, "path");
  return {.driver = cog ? "COG" : "", .overwrite = overwrite};
}

Raster empty_raster(const Transform& t, const std::string& crs, int columns, int rows) {
  if (columns < 1 || rows < 1 || columns > 65535 || rows > 65535)
    throw BadInput(fmt::format("the shape ({}, {}) must have sides of 1 to 65,535 cells", rows, columns), {}, "shape");
  Raster raster;
  raster.columns = columns;
  raster.rows = rows;
  raster.georef.origin_x = t[2] + t[0] / 2;
  raster.georef.origin_y = t[5] + t[4] / 2;
  std::vector<std::string> remarks;
  if (!crs.empty()) describe_crs_text(crs, t[5] + 0.5 * rows * t[4], raster.georef, remarks);
  raster.cell_width = t[0] * raster.georef.scale_x;
  raster.cell_height = -t[4] * raster.georef.scale_y;
  return raster;
}

std::shared_ptr<const Raster> raster_of(const py::object& z, const Placing& placing, const Running& running) {
  const bool placed = !placing.transform.is_none() || !placing.crs.is_none();
  const auto refuse_placing = [&](const char* what) {
    if (placed || !placing.nodata.is_none())
      throw UsageError(
          fmt::format("z is {}, which says itself where it lies: leave transform, crs and nodata out", what), {},
          "transform");
  };
  if (py::isinstance<Grid>(z)) {
    refuse_placing("a Grid");
    return py::cast<const Grid&>(z).raster;
  }
  if (py::isinstance<TerrainModel>(z)) {
    refuse_placing("a Terrain");
    return model_raster(py::cast<const TerrainModel&>(z), running);
  }
  if (py::isinstance<py::str>(z) || py::hasattr(z, "__fspath__")) {
    if (placed) throw UsageError("z is a file, which says itself where it lies: leave transform and crs out", {}, "z");
    const auto path = py::cast<std::string>(py::module_::import("os").attr("fsdecode")(z));
    ReadOptions options;
    if (!placing.nodata.is_none()) options.nodata = py::cast<double>(placing.nodata);
    return run(running, [&](const Context& context) {
      return std::make_shared<const Raster>(read_raster(path, options, nullptr, context));
    });
  }
  if (is_data_array(z)) {
    Placing own = placing;
    const py::object values = read_data_array(z, own);
    return std::make_shared<const Raster>(from_array(values, own, running));
  }
  return std::make_shared<const Raster>(from_array(z, placing, running));
}

void add_grid(py::module_& module) {
  py::class_<Grid> grid(module, "Grid",
                        "An elevation grid: heights of shape (rows, columns), rows from north, with its place.\n\n"
                        "z: array-like, masked array, xarray.DataArray, path or Terrain. NaN, infinite and masked "
                        "cells, and cells equal to `nodata`, hold no data. transform: (a, b, c, d, e, f) at the cells' "
                        "corners, as rasterio's; None: cells of 1 unit, the first one's centre at (0, 0). crs: "
                        "\"EPSG:32611\", WKT, or an object with to_wkt().");
  grid.def(py::init([](const py::object& z, const py::object& transform, const py::object& crs,
                       const py::object& nodata, int threads, const py::object& progress) {
             return Grid{raster_of(z, {transform, crs, nodata}, {threads, progress})};
           }),
           py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
           py::arg("nodata") = py::none(), py::arg("threads") = 0, py::arg("progress") = py::none());
  grid.def_property_readonly(
      "heights", [](const py::object& self) { return heights_view(*py::cast<const Grid&>(self).raster, self); },
      "Heights, (rows, columns), float32 where that is exact, else float64; NaN: no data. A read-only view.");
  grid.def(
      "__array__",
      [](const py::object& self, const py::object& dtype) -> py::object {
        const py::array heights = heights_view(*py::cast<const Grid&>(self).raster, self);
        if (dtype.is_none()) return heights;
        return heights.attr("astype")(dtype);
      },
      py::arg("dtype") = py::none());
  grid.def_property_readonly(
      "transform", [](const Grid& g) { return to_tuple(own_transform(*g.raster)); },
      "(a, b, c, d, e, f) at the cells' corners: rasterio's Affine(*transform).");
  grid.def_property_readonly(
      "crs", [](const Grid& g) { return crs_object(g.raster->georef); }, "The CRS as WKT, or None.");
  grid.def_property_readonly(
      "unit", [](const Grid& g) { return g.raster->georef.unit; },
      "Of horizontal distances: \"metre\" (where the CRS is geographic too), \"unit\" where none is known.");
  grid.def_property_readonly(
      "shape", [](const Grid& g) { return py::make_tuple(g.raster->rows, g.raster->columns); }, "(rows, columns)");
  grid.def(
      "write",
      [](const Grid& g, const py::object& path, bool cog, bool overwrite, int threads, const py::object& progress) {
        const std::string name = path_text(path);
        const WriteOptions how = write_options(name, cog, overwrite);
        run(Running{threads, progress}, [&](const Context& context) { write_raster(*g.raster, name, how, context); });
      },
      py::arg("path"), py::kw_only(), py::arg("cog") = false, py::arg("overwrite") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Writes one band with CRS, transform and no-data, by the path's ending (.tif, .asc, ...); complete or absent. "
      "cog: a Cloud-Optimised GeoTIFF (.tif), with overviews. Raises CannotWrite.");
  grid.def("__repr__", &repr);
  grid.attr("__module__") = "retalho";
  module.def(
      "read_grid",
      [](const py::object& path, int band, const py::object& nodata, int threads, const py::object& progress) {
        const auto name = py::cast<std::string>(py::module_::import("os").attr("fsdecode")(path));
        ReadOptions options;
        options.band = band;
        if (!nodata.is_none()) options.nodata = py::cast<double>(nodata);
        return Grid{run(Running{threads, progress}, [&](const Context& context) {
          return std::make_shared<const Raster>(read_raster(name, options, nullptr, context));
        })};
      },
      py::arg("path"), py::kw_only(), py::arg("band") = 1, py::arg("nodata") = py::none(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "One band (from 1) of anything that GDAL opens, and ASCII PGM, as a Grid. Raises CannotRead, BadInput.");
}

}  // namespace retalho::python
