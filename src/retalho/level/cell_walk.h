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

/// A grid of which `first_column` and `first_row` say where its cells lie in the coordinates that are walked in.
struct PlacedGrid {
  const GridDomain& grid;
  int first_column = 0, first_row = 0;
  double cell_width = grid.cell_width, cell_height = grid.cell_height;

  PlacedGrid(const GridDomain& domain, int column = 0, int row = 0)  // NOLINT: most grids begin at the origin
      : grid(domain), first_column(column), first_row(row) {}
};

/// The cell nearest to `p`; all that lies outside of the grid is one ring of cells around it.
inline Cell cell_of(Vec2 p, const PlacedGrid& grid) {
  const auto place = [](double cells, int first, int count) {
    return static_cast<int>(std::clamp(std::floor(cells + 0.5), first - 1.0, 1.0 * first + count));
  };
  return {place(p.x / grid.cell_width, grid.first_column, grid.grid.columns),
          place(-p.y / grid.cell_height, grid.first_row, grid.grid.rows)};
}

inline bool holds_data(Cell c, const PlacedGrid& placed) {
  const GridDomain& grid = placed.grid;
  const int column = c.column - placed.first_column, row = c.row - placed.first_row;
  return column >= 0 && row >= 0 && column < grid.columns && row < grid.rows &&
         (grid.valid.empty() || grid.valid.get(column, row));
}

/// The south-eastern corner of a cell.
inline Vec2 corner_place(Cell c, const PlacedGrid& grid) {
  return {(c.column + 0.5) * grid.cell_width, -(c.row + 0.5) * grid.cell_height};
}

/// Calls step(from, to, side, place) for each side that the segment from a to b passes, in their order.
template <class Step>
void walk_cells(Vec2 a, Vec2 b, const PlacedGrid& grid, const Step& step) {
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
