// Internal to level/: tracing a fixed-point bicubic grid, a strip of rows at a time. level/strip_lines.h joins them.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/trace.h"

namespace retalho {

inline constexpr int kStripRows = 64;  ///< strips, and with them all points' order, depend on the grid alone

/// An edge between a patch and nothing, with its roots in the order of u or v.
struct BorderEdge {
  int column, row;
  bool horizontal;  ///< from (column, row) to (column + 1, row), else to (column, row + 1)
  std::vector<BorderRoot> roots;
};

/// What lies on kStripRows rows of patches, both outer rows of edges included.
struct GridStrip {
  Trace trace;
  /// Roots on the first row of edges: points 0, 1, ... of the trace; on the last one: as many from `bottom` on. Two
  /// neighbours find the same roots in the same order on the row that they share.
  std::uint32_t top = 0, bottom = 0, bottom_count = 0;
  /// Of the first row's edges; the strip above reports the same stretches.
  std::size_t top_undecided = 0;
  std::vector<BorderEdge> border;  ///< those of the first row are the strip's that starts there
};

inline std::size_t strip_count(int patch_rows) {
  return static_cast<std::size_t>((patch_rows + kStripRows - 1) / kStripRows);
}

/// Traces strip `index`, whose rows `grid` must hold, and one more to both sides where there are any. What `strip` held
/// is gone, its memory is used again. `keep_border`: fills strip.border with the border edges that have roots.
void trace_strip(const FixedGrid& grid, const FixedLevels& levels, double tolerance, int index, bool keep_border,
                 GridStrip& strip, const Context& context);

}  // namespace retalho
