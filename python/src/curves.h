// The class Curve.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "retalho/curve/curve.h"

namespace retalho::python {

struct CurveBox {
  Curve curve;
};

void add_curves(pybind11::module_& module);

}  // namespace retalho::python
