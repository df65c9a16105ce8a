// Pictures: shaded relief, perspective views, map sheets of contour lines.
#pragma once

#include <pybind11/pybind11.h>

namespace retalho::python {

/// render and map_sheet.
void add_pictures(pybind11::module_& module);

}  // namespace retalho::python
