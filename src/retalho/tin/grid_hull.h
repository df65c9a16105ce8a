// Where a grid refinement starts: the convex hull of the valid cells, and the grid's own sides.
#pragma once

#include <vector>

#include "retalho/raster/raster.h"
#include "retalho/tin/grid_cell.h"

namespace retalho::greedy {

/// Corners of the convex hull of the valid cells with area2 > 0 around; cells inside its edges are no corners. A full
/// grid gives its four corners. Throws BadInput ("no area") where the valid cells are none or lie on one line, and for
/// a side over 65,535 cells.
std::vector<Cell> hull_of_valid(const Raster& raster);

/// Does the edge a-b run along the grid's own first or last row or column?
inline bool on_side(Cell a, Cell b, int columns, int rows) {
  return (column_of(a) == column_of(b) && (column_of(a) == 0 || column_of(a) == columns - 1)) ||
         (row_of(a) == row_of(b) && (row_of(a) == 0 || row_of(a) == rows - 1));
}

/// The worst valid cell of the straight side a-b over the tolerance, or a where there is none. It depends on the
/// heights along the side alone and not on the order of a and b: grids that share the side agree.
Cell worst_on_side(const Raster& raster, Cell a, Cell b, double tolerance);

}  // namespace retalho::greedy
