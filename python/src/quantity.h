// What can be asked of a surface at a place, and the cells of a raster that it is asked at.
#pragma once

#include <pybind11/pybind11.h>

#include <array>
#include <string>

#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/terrain.h"

namespace retalho::python {

/// What can be asked of a point, and how many numbers it has.
struct Quantity {
  const char* name;
  pybind11::ssize_t width;
};
enum What { height, gradient, slope, aspect, normal, curvature };
inline constexpr std::array<Quantity, 6> kQuantities{
    {{"height", 1}, {"gradient", 2}, {"slope", 1}, {"aspect", 1}, {"normal", 3}, {"curvature", 1}}};

/// Throws UsageError for a word that is none of them.
What parse_what(const std::string& name);
/// Writes kQuantities[what].width numbers.
void put(What what, const Jet& jet, double* out);

/// Where a raster's cells lie in a model's local coordinates.
struct Cells {
  Vec2 origin, step;
  int columns = 0, rows = 0;
};
/// Those of `transform` and `shape`; None for both: those of the model's own grid. Throws UsageError, BadInput.
Cells cells_of(const Georef& georef, const GridDomain& grid, const pybind11::object& transform,
               const pybind11::object& shape);

}  // namespace retalho::python
