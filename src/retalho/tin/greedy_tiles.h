// Greedy refinement in tile-major order: the same mesh, within a percent, as the plain worst-first order, several times
// faster, and on many threads (docs/algorithms/greedy-tin.md).
#pragma once

#include "retalho/tin/refine.h"

namespace retalho {

/// As refine_grid. Thresholds fall from the largest error by halves to the tolerance; at each, square tiles work alone
/// on the insertions whose whole cavity lies inside of them, in four passes of shifted tiles; the few that are left are
/// made one by one. Throws greedy::TooManyCells for grids of more than about 2^29 cells, and std::bad_alloc where the
/// address space for 64 bytes a cell is refused.
GridTin refine_grid_in_tiles(const Raster& raster, const RefineOptions& options = {}, const Context& context = {});

}  // namespace retalho
