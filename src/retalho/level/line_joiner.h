// Internal to level/: pieces of lines that strips of rows leave, put together where they meet.
#pragma once

#include <cstdint>
#include <list>
#include <vector>

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
  struct Part {
    std::uint32_t start;       ///< its first point
    std::vector<Vec2> points;  ///< the last one is the next part's first
  };
  /// A line in the making. Ends stand at places of the strip in hand: roots of its first row, then of its last.
  struct Chain {
    int level;
    std::list<Part> parts;
    std::uint32_t stop;
    std::int64_t head, tail;  ///< kEnd: it goes on nowhere
  };
  static constexpr std::int64_t kEnd = -1;
  /// What waits at a place.
  struct Waiting {
    std::uint32_t chain = kNoPoint;
    bool head = false;  ///< the chain's head waits for what comes before it
  };

  std::int64_t place_of(std::uint32_t point, const GridStrip& strip, bool last) const;
  void add_piece(const RawLines& lines, std::size_t line, const GridStrip& strip, bool last);
  std::uint32_t new_chain(int level);
  void finish_if_whole(std::uint32_t chain);
  void finish(std::uint32_t chain, bool closed);
  /// What still waits on the first row waits for nothing; the last row becomes the next strip's first.
  void leave(const GridStrip& strip, bool last);

  std::vector<Chain> chains_;
  std::vector<std::uint32_t> free_;
  std::vector<Waiting> waiting_;          ///< at the places of the strip in hand
  std::vector<std::uint32_t> seam_;       ///< roots of its first row, numbered through all strips
  std::vector<std::uint32_t> next_seam_;  ///< and of its last one
  std::uint64_t offset_ = 0, total_ = 0;
  RawLines done_;
};

}  // namespace retalho
