// Points from files: the class Points and read_points.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

void add_points(pybind11::module_& module);

}  // namespace retalho::python
