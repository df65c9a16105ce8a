// Pictures: shaded relief, perspective views, map sheets of contour lines.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <utility>

#include "retalho/render/image.h"

namespace retalho::python {

/// (height, width, 3), uint8.
pybind11::array pixels_of(Image image);
/// Throws UsageError for a (width, height) out of range.
void check_size(const std::pair<int, int>& size);

/// render and map_sheet.
void add_pictures(pybind11::module_& module);
/// TetraQuad.render and PatchSet.render; needs the two classes.
void add_shape_pictures(pybind11::module_& module);

}  // namespace retalho::python
