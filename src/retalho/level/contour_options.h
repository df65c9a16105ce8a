// Internal to level/: what every way of tracing does with its options.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/level/contour.h"

namespace retalho {

inline void check_contours(const std::vector<double>& levels, const ContourOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw BadInput(fmt::format("the tolerance of contour lines must be a positive number, not {}", options.tolerance));
  check_levels(levels);
}

/// Lines that will be thinned are traced closer than they have to be.
inline double raw_tolerance(const ContourOptions& options) {
  return options.simplify ? options.tolerance / 5 : options.tolerance;
}

/// What a set of lines is said to be, before there are lines.
inline ContourSet empty_set(std::vector<double> levels, const ContourOptions& options, double quantum) {
  ContourSet set;
  set.levels = std::move(levels);
  set.tolerance = options.tolerance;
  set.height_quantum = quantum;
  return set;
}

}  // namespace retalho
