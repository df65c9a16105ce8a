// Level lines: retalho.contours of grids, Terrain.contours of models.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

/// Needs the class Terrain.
void add_contours(pybind11::module_& module);

}  // namespace retalho::python
