// Internal to level/: a bicubic grid in whole quanta. The surface that is traced is defined by these integers, so every
// decision about it is exact; shared edges are the same integers seen from both sides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "retalho/level/frame.h"
#include "retalho/level/rectangle_patch.h"
#include "retalho/terrain/bicubic.h"

namespace retalho {

struct FixedGrid {
  int columns = 0, rows = 0;
  double cell_width = 1, cell_height = 1;
  double per_unit = 1;  ///< quanta a height unit, a power of two
  Mask valid;
  std::vector<std::int32_t> z, u, v, t;  ///< height, zu / 3, zv / 3, zuv / 9; their magnitudes add up to less than 2^24

  std::size_t node(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  bool has_sample(int column, int row) const { return valid.empty() || valid.get(column, row); }
  bool has_patch(int column, int row) const {
    return column >= 0 && row >= 0 && column + 1 < columns && row + 1 < rows &&
           (valid.empty() || (has_sample(column, row) && has_sample(column + 1, row) && has_sample(column, row + 1) &&
                              has_sample(column + 1, row + 1)));
  }
  /// Doubled ordinates of a patch.
  RectanglePatch::Net<double> net(int column, int row) const;
  /// u to the east, v to the south: mirrored in local coordinates.
  Frame frame(int column, int row) const {
    return {{column * cell_width, -row * cell_height}, {cell_width, 0}, {0, -cell_height}};
  }
};

FixedGrid fix_grid(const BicubicGrid& grid, const Context& context);

}  // namespace retalho
