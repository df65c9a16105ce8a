// Curves by formulas: Graph, y = f(x), and LevelSet, f(x, y) = 0.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "retalho/curve/curve.h"
#include "retalho/curve/explicit.h"
#include "retalho/level/implicit_curve.h"

namespace retalho::python {

struct GraphBox {
  std::string formula;
  double from = 0, to = 1;
  ExplicitCurve graph;
  std::optional<Curve> exact;
};
struct LevelSetBox {
  std::string formula;
  std::vector<double> box;
  ImplicitCurve level;
};

/// Needs the class Curve.
void add_formulas(pybind11::module_& module);

}  // namespace retalho::python
