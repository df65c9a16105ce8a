// The class Bicubic: the smooth surface through every cell of a grid.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

#include "retalho/terrain/bicubic.h"

namespace retalho::python {

/// Of the options' names. Throws UsageError with the choices.
BicubicOptions bicubic_options(const std::string& twist, const std::string& ends, bool keep_flats);

void add_bicubic(pybind11::module_& module);

}  // namespace retalho::python
