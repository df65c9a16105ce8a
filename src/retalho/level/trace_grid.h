// Internal to level/: tracing a fixed-point bicubic grid, in strips of rows that are joined afterwards.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/trace.h"

namespace retalho {

/// An edge between a patch and nothing, with its roots in the order of u or v.
struct BorderEdge {
  int column, row;
  bool horizontal;  ///< from (column, row) to (column + 1, row), else to (column, row + 1)
  std::vector<EdgeRoot> roots;
};

/// One trace of the whole grid. The strips and with them the points' order depend on the grid alone.
/// `border`: filled with the border edges that have roots, unless null.
Trace trace_grid(const FixedGrid& grid, const FixedLevels& levels, double tolerance, std::vector<BorderEdge>* border,
                 const Context& context);

}  // namespace retalho
