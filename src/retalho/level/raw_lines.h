// Internal to level/: lines as they were traced, before they are thinned.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/contours.h"
#include "retalho/level/trace.h"

namespace retalho {

struct RawLines {
  ContourSet set;
  std::vector<std::uint32_t> cell;                 ///< the triangle of each point; empty for grids
  std::vector<std::array<std::uint32_t, 2>> ends;  ///< of each line: its first and last point in the trace
  double raw = 0;                                  ///< every chord is this close to its arc
};

/// The lines of a trace, by level, then by start (level/lines.h), copied out; of equal consecutive points one stays.
/// Fills set.points, set.lines, cell and ends.
void gather_lines(const Trace& trace, RawLines& lines, const Context& context);

/// Sorts `lines` by level, then by where they start in the trace, and brings their points into that order.
void sort_lines(RawLines& lines);

}  // namespace retalho
