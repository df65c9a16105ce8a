// Internal to level/: from points that know their successor to lines.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/level/trace.h"

namespace retalho {

/// A line as a walk through a trace.
struct TracedLine {
  int level;
  bool closed;
  std::uint32_t start, stop;  ///< first and last point
  std::uint32_t count;
};

/// All lines, by level, then by start. An open line starts at the point without predecessor, a closed one at its
/// smallest point.
std::vector<TracedLine> find_lines(const Trace& trace);

}  // namespace retalho
