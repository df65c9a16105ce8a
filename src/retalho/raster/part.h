// A part of a grid, or every so-many-th cell of it, as a grid of its own.
#pragma once

#include "retalho/raster/raster.h"
#include "retalho/raster/window.h"

namespace retalho {

/// The cells of `window`, which must lie within `whole`: their heights to the bit, and the origin at the window's
/// north-western cell.
Raster part_of(const Raster& whole, const CellWindow& window);

/// Throws UsageError for a stride below 1, and for one that passes a side of the grid.
void check_stride(const Raster& whole, int stride);
/// The middle cell of each `stride` x `stride` block (from `stride` / 2 on) as one cell of that size. Throws as
/// check_stride does.
Raster thinned(const Raster& whole, int stride);

}  // namespace retalho
