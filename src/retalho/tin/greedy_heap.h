// The plain greedy refinement: always the worst cell of all, in exact order, from one heap. It is the slow, obvious
// twin of the tiled refinement, and the one that a vertex budget ends with.
#pragma once

#include "retalho/tin/refine.h"

namespace retalho {

/// As refine_grid; the order of insertion is (largest error, then lowest row-major cell) over the whole grid, after the
/// grid's straight border sides have been refined by themselves. Cost: O(log n) and a few scans an insertion.
GridTin refine_grid_by_heap(const Raster& raster, const RefineOptions& options = {}, const Context& context = {});

}  // namespace retalho
