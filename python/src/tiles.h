// Making tiled models: the tasks of a scheduler, and all of them at once.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

void add_tiles(pybind11::module_& module);

}  // namespace retalho::python
