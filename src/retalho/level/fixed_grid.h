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

/// All of a grid's rows, or those around a strip of it; rows are counted through the whole grid.
struct FixedGrid {
  int columns = 0, rows = 0;
  int held_first = 0, held_rows = 0;  ///< the rows that are here
  double cell_width = 1, cell_height = 1;
  double per_unit = 1;  ///< quanta a height unit, a power of two
  Mask valid;           ///< of the rows that are here; empty: all
  std::vector<std::int32_t> z, u, v,
      t;  ///< height, zu / 3, zv / 3, zuv / 9; their magnitudes add up to less than 2^24

  std::size_t node(int column, int row) const {
    return static_cast<std::size_t>(row - held_first) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  bool has_sample(int column, int row) const { return valid.empty() || valid.get(column, row - held_first); }
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

/// The same, some rows at a time, straight from the samples: no array of the whole grid is made. One object serves all
/// threads.
class FixedRows {
 public:
  /// Looks at all samples once, for the size of the largest ordinate, and makes the surface where they leave it open.
  /// Throws BadInput for a grid without a bicubic surface.
  FixedRows(const Raster& raster, const BicubicOptions& options, const Context& context);

  double per_unit() const { return per_unit_; }
  int columns() const { return raster_.columns; }
  int rows() const { return raster_.rows; }
  double cell_height() const { return raster_.cell_height; }
  /// Fills `grid` with rows [first, last) of what fix_grid gives of the whole, to the bit. `scratch` and what `grid`
  /// held are used again.
  void make(int first, int last, BicubicGrid& scratch, FixedGrid& grid, const Context& context) const;

 private:
  const Raster& raster_;
  BicubicOptions options_;
  double per_unit_ = 1;
};

}  // namespace retalho
