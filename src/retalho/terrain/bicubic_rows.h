// Internal to terrain/ and level/: a few rows of a bicubic surface, for work that does not want it whole.
#pragma once

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/bicubic.h"

namespace retalho {

/// Throws BadInput for a grid that has no bicubic surface.
void check_bicubic(const Raster& raster);

/// Makes `window` a part of make_bicubic(raster), to the bit in rows [first, last) of the raster; the rows around them,
/// kSplineHalo + 1 to both sides, hold samples but not all of their tangents. Returns the raster's row that is the
/// window's first. What the window held is gone, its memory is used again; it has no georef.
int make_bicubic_rows(const Raster& raster, int first, int last, const BicubicOptions& options, BicubicGrid& window,
                      const Context& context);

}  // namespace retalho
