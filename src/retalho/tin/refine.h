// Greedy Delaunay refinement of an elevation grid to a tolerance or a budget (Garland and Heckbert 1995), in the
// tile-major order of docs/algorithms/greedy-tin.md.
//
// Promises: every valid cell is within `max_error` of the flat TIN, in double, ties included; void cells ask for
// nothing and never become vertices; the triangulation is Delaunay in grid coordinates (exact predicates); the result
// is the same from any number of threads; with a tolerance and no budget, the samples chosen on the grid's border rows
// and columns depend on that border alone, so grids that share a border row or column agree along it.
//
// "In double" means: exactly for integer heights (of b bits on a side of k bits, b + 2 k <= 48), else down to rounding,
// 2^-48 of the largest height: 3e-11 m at 8,000 m. A smaller tolerance is taken as that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/tin/tin.h"

namespace retalho {

struct RefineOptions {
  double max_error = 0;      ///< height units, 0 or more. 0: until the TIN passes through every cell
  std::size_t vertices = 0;  ///< stop at this many vertices (exact worst-first order at the end); 0: no budget, only
                             ///< max_error. With both, whichever comes first. The corners of the valid cells' hull
                             ///< are always vertices, however small the budget.
};

/// A triangulation of grid cells: vertices in raster order, each a cell (row << 16 | column).
struct GridTin {
  std::vector<std::uint32_t> cells;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from above, north up
  std::vector<std::array<std::uint32_t, 3>> neighbors;  ///< as in Tin
  double max_error = 0;  ///< of the flat TIN over all valid cells, as refinement knows it
};

/// Throws BadInput: fewer than three valid cells not on one line ("no area"), a side over 65,535 cells, an infinite
/// height; UsageError: a negative or NaN max_error; Interrupted.
/// Cost: about 0.1-0.6 us a cell on one thread; memory: see docs/algorithms/greedy-tin.md.
GridTin refine_grid(const Raster& raster, const RefineOptions& options = {}, const Context& context = {});

/// The same as a Tin in local coordinates, with the raster's heights.
Tin to_tin(const GridTin& grid_tin, const Raster& raster);

/// refine_grid and to_tin in one step.
Tin refine_tin(const Raster& raster, const RefineOptions& options = {}, const Context& context = {});

}  // namespace retalho
