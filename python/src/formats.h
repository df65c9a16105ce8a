// Files of other forms out of Python: compact model files, and tiles for viewers of the globe.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

void add_formats(pybind11::module_& module);

}  // namespace retalho::python
