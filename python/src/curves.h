// The class Curve, its files and its pictures.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <vector>

#include "retalho/curve/curve.h"

namespace retalho::python {

struct CurveBox {
  Curve curve;
};

/// (n, dimension) of points, and one as a tuple.
pybind11::array_t<double> coordinates(const std::vector<Vec3>& points, int dimension);
pybind11::tuple coordinates(Vec3 p, int dimension);

void add_curves(pybind11::module_& module);
/// More questions; read_curves, write_curves, read_lines and draw_curves, which need the classes Graph and LevelSet.
void add_curve_measures(pybind11::module_& module);
void add_curve_files(pybind11::module_& module);

}  // namespace retalho::python
