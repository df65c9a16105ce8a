// Elevation grids between Python and C++: arrays with a transform and a CRS in, Raster out, and the class Grid.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <array>
#include <memory>
#include <string>

#include "retalho/raster/io.h"
#include "retalho/raster/raster.h"
#include "running.h"

namespace retalho::python {

/// (a, b, c, d, e, f) as rasterio's Affine: x = a column + b row + c, y = d column + e row + f at the cells' corners.
using Transform = std::array<double, 6>;

/// From six numbers, or nine as an Affine gives. Throws BadInput where it is not north-up.
Transform as_transform(const pybind11::object& object);
/// The transform of a grid with that first cell centre (local) and cell size.
Transform transform_of(const Georef& georef, Vec2 first, Vec2 cell);
pybind11::tuple to_tuple(const Transform& transform);

/// WKT, "EPSG:32611", a PROJ string, or an object with to_wkt() (pyproj, rasterio) as text; "" for None.
std::string crs_text(const pybind11::object& crs);
/// The WKT, or None.
pybind11::object crs_object(const Georef& georef);
/// "WGS 84 / UTM zone 11N" or "no CRS", for __repr__.
std::string crs_title(const Georef& georef);

struct Grid {
  std::shared_ptr<const Raster> raster;
};

/// How an array lies and what in it is no data.
struct Placing {
  pybind11::object transform = pybind11::none(), crs = pybind11::none(), nodata = pybind11::none();
};

/// What every call takes for `z`: a Grid, a path, a Terrain (its surface at the cells of its grid), a DataArray, or
/// anything that NumPy takes. Throws BadInput (shape, transform, CRS), UsageError for a placing of what has one.
std::shared_ptr<const Raster> raster_of(const pybind11::object& z, const Placing& placing, const Running& running);

/// An empty grid with that transform and shape. Throws BadInput for sides of no cell or over 65,535.
Raster empty_raster(const Transform& transform, const std::string& crs, int columns, int rows);

/// How a raster is written. Throws UsageError for a COG that is not called .tif.
WriteOptions write_options(const std::string& path, bool cog, bool overwrite);

void add_grid(pybind11::module_& module);

}  // namespace retalho::python
