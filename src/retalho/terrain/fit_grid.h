// The grid that a surface is fitted to, in the units of the fit: a cell has area 1, x runs east, y north, the origin is
// the centre of the north-west cell. Internal to terrain/.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/row_spans.h"

namespace retalho {

struct FitGrid {
  int columns = 0, rows = 0;
  double unit = 1;        ///< local units a unit of the fit
  Vec2 step;              ///< of a cell, in units of the fit; step.x * step.y = 1
  double reference = 0;   ///< subtracted from every height: the mean
  double range = 0;       ///< of the valid heights
  std::vector<double> z;  ///< height - reference; NaN: void
  std::size_t valid = 0;
  std::vector<std::uint8_t> torn;  ///< 1: a crease lies between the cell's neighbours; empty: nowhere

  FitGrid() = default;
  FitGrid(const Raster& raster, const Context& context);

  std::size_t cell(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  /// Marks the cells between whose neighbours the crease a-b (cell coordinates) lies: no difference across it is a
  /// slope.
  void tear(Vec2 a, Vec2 b);
  /// From cell coordinates (column, -row) to units of the fit.
  Vec2 place(Vec2 at) const { return {at.x * step.x, at.y * step.y}; }
  RowGrid lattice() const { return {{0, 0}, {1, 1}, columns, rows}; }
  RowGrid placed_lattice() const { return {{0, 0}, step, columns, rows}; }

  /// Central differences, as ErrorReport::slope_rmse takes them; nullopt where a neighbour is missing or across a
  /// crease.
  std::optional<Vec2> slope(int column, int row) const {
    if (column == 0 || row == 0 || column == columns - 1 || row == rows - 1) return std::nullopt;
    const std::size_t at = cell(column, row), across = static_cast<std::size_t>(columns);
    if (!torn.empty() && torn[at] != 0) return std::nullopt;
    const Vec2 d{(z[at + 1] - z[at - 1]) / (2 * step.x), (z[at - across] - z[at + across]) / (2 * step.y)};
    if (std::isnan(d.x) || std::isnan(d.y)) return std::nullopt;
    return d;
  }
};

/// The cells of a triangle of a mesh whose outline is convex, such that every cell belongs to exactly one triangle: a
/// cell on an edge or at a vertex counts as moved a little towards `inside`, a point inside the outline.
class CellSpans {
 public:
  /// Corners in cell coordinates (column, -row), counter-clockwise.
  CellSpans(const Corners& corners, Vec2 inside) : corners_(corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
      int side = side_of(a, b, inside);
      if (side == 0) side = a.y < b.y || (a.y == b.y && a.x < b.x) ? 1 : -1;
      if (side < 0) foreign_[count_++] = {a, b};
    }
  }

  /// use(row, first, last) for every row with cells, from south to north.
  template <class Use>
  void each(const RowGrid& lattice, const Use& use) const {
    for_each_row_span(corners_, lattice, 1, row_range(corners_, lattice, 1), [&](int row, int first, int last) {
      while (first <= last && on_foreign_edge(lattice.at(first, row))) ++first;
      while (first <= last && on_foreign_edge(lattice.at(last, row))) --last;
      if (first <= last) use(row, first, last);
    });
  }

 private:
  bool on_foreign_edge(Vec2 p) const {
    for (std::size_t k = 0; k < count_; ++k)
      if (side_of(foreign_[k][0], foreign_[k][1], p) == 0) return true;
    return false;
  }

  Corners corners_;
  std::array<std::array<Vec2, 2>, 3> foreign_{};  // edges whose cells are a neighbour's
  std::size_t count_ = 0;
};

/// Where a vertex lies in cell coordinates (column, -row); whole numbers where it is a cell's centre but for rounding.
Vec2 cell_coordinates(Vec2 local, const Raster& raster);

}  // namespace retalho
