// Elevation grids out of a formula, for tests.
#pragma once

#include <utility>
#include <vector>

#include "retalho/raster/raster.h"

namespace retalho::test {

/// Heights height(column, row) stored as `Height`; NaN is void. Cells of 1 x 1 at the origin.
template <class Height = float>
Raster make_grid(int columns, int rows, const auto& height) {
  Raster r;
  r.columns = columns;
  r.rows = rows;
  std::vector<Height> z(r.cells());
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) z[r.index(x, y)] = static_cast<Height>(height(x, y));
  r.heights = std::move(z);
  return r;
}

}  // namespace retalho::test
