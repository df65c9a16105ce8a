// Internal to level/: pieces of lines that strips of rows leave, put together where they meet.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/level/line_chains.h"
#include "retalho/level/raw_lines.h"
#include "retalho/level/trace_grid.h"

namespace retalho {

class LineJoiner {
 public:
  /// Takes the pieces of the next strip; their ends are points of the strip's own trace. Leaves in `lines` those that
  /// go on nowhere, whole, their ends numbered through all strips, by level, then by start. `last`: no strip follows.
  /// Throws BadInput where four billion points have been traced.
  void add(RawLines& lines, const GridStrip& strip, bool last);
  /// The number through all strips of a point of the strip that was added last.
  std::uint32_t joined(std::uint32_t point) const {
    return point < seam_.size() ? seam_[point] : static_cast<std::uint32_t>(point + offset_);
  }

 private:
  /// Where another strip may go on: the roots of the first row and of the last one, by their numbers.
  LineChains::Place place_of(std::uint32_t point, const GridStrip& strip, bool last) const;

  LineChains chains_;
  std::vector<std::uint32_t> seam_;       ///< roots of the first row, numbered through all strips
  std::vector<std::uint32_t> next_seam_;  ///< and of the last one
  std::uint64_t offset_ = 0, total_ = 0;
};

}  // namespace retalho
