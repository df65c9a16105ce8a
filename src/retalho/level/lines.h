// Internal to level/: from points that know their successor to lines.
#pragma once

#include <cstddef>
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
  std::size_t first;  ///< where its points begin in TracedLines::order
};

struct TracedLines {
  std::vector<TracedLine> lines;
  std::vector<std::uint32_t> order;  ///< points, line by line: to follow `next` once is enough
};

/// All lines, by level, then by start. An open line starts at the point without predecessor, a closed one at its
/// smallest point.
TracedLines find_lines(const Trace& trace);

}  // namespace retalho
