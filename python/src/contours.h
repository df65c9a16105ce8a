// Level lines: retalho.contours of grids, Terrain.contours of models.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <vector>

#include "retalho/level/contours.h"
#include "retalho/raster/georef.h"
#include "retalho/terrain/terrain.h"

namespace retalho::python {

/// What Python asks of level lines.
struct AskedLines {
  std::optional<std::vector<double>> levels;
  std::optional<double> interval, tolerance;
  double base = 0;
  bool simplify = true, bands = false;
};
/// Throws UsageError for what does not go together.
AskedLines parse_lines(const pybind11::object& levels, std::optional<double> interval, double base,
                       std::optional<double> tolerance, bool simplify, bool bands);
/// The levels of a surface whose samples go from `low` to `high`: it may go a little beyond both. Throws BadInput.
std::vector<double> levels_of(const AskedLines& asked, double low, double high);
/// What a tolerance is chosen by: a cell, or of a model of points the mean edge.
double line_cell(const Terrain& terrain);
/// An object of the class Contours.
pybind11::object contours_object(ContourSet set, const Georef& georef, const AskedLines& asked);

/// Needs the class Terrain.
void add_contours(pybind11::module_& module);
/// Terrain.conics; needs the classes Terrain and Curve.
void add_conics(pybind11::module_& module);

}  // namespace retalho::python
