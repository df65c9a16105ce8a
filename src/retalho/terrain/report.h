// How good a model is: its error against the grid it stands for, measured at every valid cell by a scan conversion of
// its own (barycentric, in double), never by the refinement's.
#pragma once

#include <cstddef>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct ErrorReport {
  std::size_t cells = 0, valid_cells = 0;
  std::size_t uncovered = 0;   ///< valid cells where the model has no data: should be 0
  std::size_t violations = 0;  ///< valid cells over the tolerance asked for
  double rmse = 0, max_error = 0;
  Vec2 max_error_at;           ///< CRS coordinates of the first cell, in raster order, with the largest error
  double slope_rmse = 0;       ///< root mean square of |grad S - D z|, height units per local unit; D z: central
                               ///< differences of the grid, over cells whose four neighbours are valid
};

/// `tolerance` <= 0: no violations are counted. Throws BadInput when no valid cell is covered.
ErrorReport assess(const Terrain& terrain, const Raster& raster, double tolerance = 0, const Context& context = {});

}  // namespace retalho
