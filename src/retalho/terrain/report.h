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
  std::size_t violations = 0;  ///< valid cells over the tolerance asked for, beyond rounding (kRoundingAllowance)
  double rmse = 0, max_error = 0;
  Vec2 max_error_at;      ///< CRS coordinates of the first cell, in raster order, with the largest error
  double slope_rmse = 0;  ///< root mean square of |grad S - D z|, height units per local unit; D z: central
                          ///< differences of the grid, over cells whose four neighbours are valid
};

/// An error counts as a violation when it exceeds tolerance + kRoundingAllowance * (range of the valid heights): a few
/// units in the last place. On a linear model whose vertices are the raster's own cells the error is the exact integer
/// form |A2 h - plane| / A2, so on integer heights an error equal to the tolerance is no violation, and one larger by
/// any amount that integer heights can make is.
inline constexpr double kRoundingAllowance = 16 * 2.220446049250313e-16;

/// The raster may lie elsewhere than the model's own grid: cells are compared where they lie in the CRS.
/// `tolerance` <= 0: no violations are counted. The same report from any number of threads.
/// Cost: about 0.05-0.1 us a cell on one thread; memory: a bit a cell of the rows in work, and 4 bytes a triangle and
/// band of rows. Throws BadInput when no valid cell is covered.
ErrorReport assess(const Terrain& terrain, const Raster& raster, double tolerance = 0, const Context& context = {});

}  // namespace retalho
