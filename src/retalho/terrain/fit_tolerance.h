// Refinement of a surface until every valid cell is within a tolerance of it. Internal to terrain/.
#pragma once

#include <cstddef>

#include "retalho/terrain/fit_state.h"

namespace retalho {

inline constexpr CgLimits kRoughSolve{1e-5, 60}, kFinalSolve{1e-11, 1000};

/// Sweeps of relocation, then exchanges each with a sweep.
void better(FitState& state, int relocations, int exchanges, const Context& context);

/// Lawson's weights: cells near the tolerance or over it count more. False, and nothing done to the elements, where
/// none is over it.
bool reweigh(FitState& state, double tolerance, const Context& context);

struct ToleranceOptions {
  double max_error = 0;
  std::size_t vertices = 0;  ///< 0: no budget
  double growth = 0.25;
  int relocations = 3, exchanges = 3;
};

Terrain refine_to_tolerance(FitState& state, const Raster& raster, const ToleranceOptions& options,
                            const Context& context);

}  // namespace retalho
