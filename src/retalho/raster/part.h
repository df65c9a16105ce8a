// A part of a grid as a grid of its own.
#pragma once

#include "retalho/raster/raster.h"
#include "retalho/raster/window.h"

namespace retalho {

/// The cells of `window`, which must lie within `whole`: their heights to the bit, and the origin at the window's
/// north-western cell.
Raster part_of(const Raster& whole, const CellWindow& window);

}  // namespace retalho
