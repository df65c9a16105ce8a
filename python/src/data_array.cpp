#include "data_array.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "arrays.h"
#include "retalho/core/error.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

/// Centres that run evenly: where they begin and by how much they go on.
struct Axis {
  double first = 0, step = 1;
};

std::optional<Axis> axis_of(const py::object& array, const py::object& name) {
  const py::object coords = array.attr("coords");
  if (!py::cast<bool>(coords.attr("__contains__")(name))) return std::nullopt;
  const auto label = py::cast<std::string>(py::str(name));
  const std::vector<double> centres = as_vector(coords.attr("__getitem__")(name).attr("values"), label);
  if (centres.size() < 2) return std::nullopt;
  const auto n = static_cast<double>(centres.size() - 1);
  const Axis axis{centres.front(), (centres.back() - centres.front()) / n};
  for (std::size_t i = 0; i < centres.size(); ++i)
    if (!(std::abs(axis.first + static_cast<double>(i) * axis.step - centres[i]) <= 1e-3 * std::abs(axis.step)) ||
        axis.step == 0)
      throw BadInput(fmt::format("the coordinate '{}' is not evenly spaced: {} at {}, where {} was expected", label,
                                 centres[i], i, axis.first + static_cast<double>(i) * axis.step),
                     {}, label);
  return axis;
}

/// As rioxarray keeps it: the scalar coordinate spatial_ref, or the attribute crs.
py::object crs_of(const py::object& array) {
  const py::object coords = array.attr("coords");
  if (py::cast<bool>(coords.attr("__contains__")("spatial_ref"))) {
    const py::object attributes = coords.attr("__getitem__")("spatial_ref").attr("attrs");
    for (const char* key : {"crs_wkt", "spatial_ref"})
      if (py::cast<bool>(attributes.attr("__contains__")(key))) return attributes.attr("__getitem__")(key);
  }
  return array.attr("attrs").attr("get")("crs");
}

py::object flipped(const py::object& values, bool rows, bool columns) {
  const py::slice all(std::nullopt, std::nullopt, std::nullopt), back(std::nullopt, std::nullopt, py::ssize_t{-1});
  return values.attr("__getitem__")(py::make_tuple(rows ? back : all, columns ? back : all));
}

}  // namespace

bool is_data_array(const py::object& object) {
  return py::hasattr(object, "dims") && py::hasattr(object, "coords") && py::hasattr(object, "attrs") &&
         py::hasattr(object, "values");
}

py::object read_data_array(const py::object& array, Placing& placing) {
  const py::object values = array.attr("values");
  const py::tuple dims(array.attr("dims"));
  if (dims.size() != 2)
    throw BadInput(fmt::format("z must be a DataArray of two dimensions, not {}: select the others first, as in "
                               "z.squeeze() or z.isel(band=0)",
                               py::cast<std::string>(py::repr(dims))),
                   {}, "z");
  const py::object attributes = array.attr("attrs");
  if (placing.nodata.is_none() && py::cast<bool>(attributes.attr("__contains__")("_FillValue")))
    placing.nodata = attributes.attr("__getitem__")("_FillValue");
  if (!placing.transform.is_none()) return values;
  const std::optional<Axis> y = axis_of(array, dims[0]), x = axis_of(array, dims[1]);
  if (!x || !y) return values;
  const bool flip_rows = y->step > 0, flip_columns = x->step < 0;
  const py::tuple shape(array.attr("shape"));
  const double rows = py::cast<double>(shape[0]), columns = py::cast<double>(shape[1]);
  const double north = flip_rows ? y->first + (rows - 1) * y->step : y->first;
  const double west = flip_columns ? x->first + (columns - 1) * x->step : x->first;
  const double a = std::abs(x->step), e = -std::abs(y->step);
  placing.transform = py::make_tuple(a, 0.0, west - a / 2, 0.0, e, north - e / 2);
  if (placing.crs.is_none()) placing.crs = crs_of(array);
  return flipped(values, flip_rows, flip_columns);
}

}  // namespace retalho::python
