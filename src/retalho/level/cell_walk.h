// Internal to level/: the cells that a segment passes, as steps over the sides between them. A step's place lies on its
// side in the very numbers of the side; the cells come from the ends' own rounding, so that segments which share a
// point agree about its cell, and a closed walk returns to the cell that it left.
#pragma once

#include <algorithm>
#include <cmath>

#include "retalho/core/vec.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct Cell {
  int column, row;
};

/// The side to the east of a cell (vertical) or to its south.
struct CellSide {
  int column, row;
  bool vertical;
};

/// The cell nearest to `p`; all that lies outside of the grid is one ring of cells around it.
inline Cell cell_of(Vec2 p, const GridDomain& grid) {
  return {static_cast<int>(std::clamp(std::floor(p.x / grid.cell_width + 0.5), -1.0, 1.0 * grid.columns)),
          static_cast<int>(std::clamp(std::floor(-p.y / grid.cell_height + 0.5), -1.0, 1.0 * grid.rows))};
}

inline bool holds_data(Cell c, const GridDomain& grid) {
  return c.column >= 0 && c.row >= 0 && c.column < grid.columns && c.row < grid.rows &&
         (grid.valid.empty() || grid.valid.get(c.column, c.row));
}

/// The south-eastern corner of a cell.
inline Vec2 corner_place(Cell c, const GridDomain& grid) {
  return {(c.column + 0.5) * grid.cell_width, -(c.row + 0.5) * grid.cell_height};
}

/// Calls step(from, to, side, place) for each side that the segment from a to b passes, in their order.
template <class Step>
void walk_cells(Vec2 a, Vec2 b, const GridDomain& grid, const Step& step) {
  Cell here = cell_of(a, grid);
  const Cell last = cell_of(b, grid);
  const auto part = [](double line, double from, double to) {
    return std::clamp((line - from) / (to - from), 0.0, 1.0);
  };
  while (here.column != last.column || here.row != last.row) {
    const bool east = last.column > here.column, south = last.row > here.row;
    const Vec2 corner = corner_place({here.column - (east ? 0 : 1), here.row - (south ? 0 : 1)}, grid);
    const double tx = here.column != last.column ? part(corner.x, a.x, b.x) : 2;
    const double ty = here.row != last.row ? part(corner.y, a.y, b.y) : 2;
    const bool vertical = tx <= ty;
    Cell next = here;
    Vec2 place = a + std::min(tx, ty) * (b - a);
    if (vertical) {
      next.column += east ? 1 : -1;
      const double top = corner_place({0, here.row - 1}, grid).y, bottom = corner_place({0, here.row}, grid).y;
      place = {corner.x, std::clamp(place.y, bottom, top)};
    } else {
      next.row += south ? 1 : -1;
      const double left = corner_place({here.column - 1, 0}, grid).x, right = corner_place({here.column, 0}, grid).x;
      place = {std::clamp(place.x, left, right), corner.y};
    }
    step(here, next, CellSide{std::min(here.column, next.column), std::min(here.row, next.row), vertical}, place);
    here = next;
  }
}

}  // namespace retalho
