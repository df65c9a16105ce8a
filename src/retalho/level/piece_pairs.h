// Internal to level/: which pieces of many curves meet where they should not.
#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/cubic.h"

namespace retalho {

struct PairItem {
  static constexpr std::size_t kNoNext = std::numeric_limits<std::size_t>::max();
  const Cubic* cubic;
  std::size_t next;  ///< the item that starts where this one ends
  bool fresh;        ///< pairs without a fresh item are known to be apart
};

/// The pairs (a < b, ascending), one of them fresh at least, that are not proved apart. Pieces that come close to no
/// other cost a few cells of a grid each.
std::vector<std::pair<std::size_t, std::size_t>> touching_pairs(const std::vector<PairItem>& items,
                                                                const Context& context);

}  // namespace retalho
