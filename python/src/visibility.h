// Viewsheds, intervisibility maps and sight lines.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

void add_visibility(pybind11::module_& module);

}  // namespace retalho::python
