// retalho.compare: models, or every kind of surface, beside one another.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

/// Needs the class Terrain.
void add_compare(pybind11::module_& module);

}  // namespace retalho::python
