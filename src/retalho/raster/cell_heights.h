// The heights of a grid by its cells, where the grid is not at hand as a whole.
#pragma once

#include <functional>

#include "retalho/raster/raster.h"

namespace retalho {

struct CellHeights {
  int columns = 0, rows = 0;
  double cell_width = 1, cell_height = 1;  ///< local units
  Georef georef;
  std::function<double(int column, int row)> at;  ///< NaN: no data; asked for cells of the grid alone

  bool holds(int column, int row) const { return column >= 0 && row >= 0 && column < columns && row < rows; }
  Vec2 centre(double column, double row) const { return {column * cell_width, -row * cell_height}; }
};

/// Of a grid in memory, which must outlive it.
inline CellHeights cells_of(const Raster& raster) {
  return {raster.columns,     raster.rows,   raster.cell_width,
          raster.cell_height, raster.georef, [&raster](int column, int row) { return raster.at(column, row); }};
}

}  // namespace retalho
