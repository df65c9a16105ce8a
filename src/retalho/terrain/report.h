// How good a model is: its error against the grid it stands for, measured at every valid cell by a scan conversion of
// its own (barycentric, in double), never by the refinement's.
#pragma once

#include <cstddef>

#include "retalho/core/context.h"
#include "retalho/raster/mask.h"
#include "retalho/raster/raster.h"
#include "retalho/raster/window.h"
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

/// One part of a grid that is assessed part by part.
struct AssessedPart {
  const Terrain* terrain = nullptr;  ///< null: the model has no data here
  const Raster* raster = nullptr;    ///< lies as the terrain's own grid does
  CellWindow cells;                  ///< of `raster`, in the whole grid
  Mask only;                         ///< the cells of `raster` that count here; those of all parts make up the grid
  const Raster* around = nullptr;    ///< `raster` with the cells beyond its border that slopes need
  CellWindow around_cells;
};
/// What parts add up to. The first largest error, in raster order of the whole, is kept.
struct ErrorSums {
  int columns = 0;  ///< of the whole grid: set it before the first part
  std::size_t cells = 0, valid = 0, covered = 0, violations = 0, slopes = 0, largest_cell = 0;
  double squares = 0, slope_squares = 0, largest = -1;
};
/// assess() of the cells that count; what rounding is allowed (kRoundingAllowance) goes by the part's own range.
void assess_part(const AssessedPart& part, double tolerance, ErrorSums& sums, const Context& context = {});
/// Throws BadInput when no valid cell was covered. `largest`'s place is the caller's: max_error_at is left at zero.
ErrorReport report_of(const ErrorSums& sums);

}  // namespace retalho
