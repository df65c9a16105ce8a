// Internal to level/: where on a bicubic surface the largest ordinate may lie, from its samples alone.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"

namespace retalho {

/// A first row, and how many rows it stands for.
struct SizeBlock {
  int first, last;  ///< rows [first, last)
};

/// What the samples say about the largest sum of the sizes that make an ordinate, whatever the twist.
struct SurfaceSize {
  double least = 0;               ///< it is no smaller: the largest height
  std::vector<SizeBlock> unsure;  ///< blocks of rows whose own may be 2^e or more, the power of two next above `least`
};

/// One pass over the samples. A tangent is at most three times the largest difference of neighbours along its line,
/// nine times at an end; a spline of tangents at most three times their differences again.
SurfaceSize bound_surface(const Raster& raster, int block_rows, const Context& context);

}  // namespace retalho
