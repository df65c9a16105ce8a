// xarray.DataArray, without importing xarray: by its attributes.
#pragma once

#include <pybind11/pybind11.h>

#include "grid.h"

namespace retalho::python {

bool is_data_array(const pybind11::object& object);

/// The values with rows from north and columns from west, and in `placing` what the coordinates (of the cells' centres)
/// and attributes say and the caller did not. The first dimension is north-south, whatever it is called. Throws
/// BadInput for coordinates that are not evenly spaced, to a thousandth of a cell.
pybind11::object read_data_array(const pybind11::object& array, Placing& placing);

}  // namespace retalho::python
