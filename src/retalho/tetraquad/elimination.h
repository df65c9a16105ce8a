// An order of elimination for a block matrix, and which blocks its factors have. Internal to the room.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/tetraquad/block_matrix.h"

namespace retalho {

/// Vertices that are eliminated together (a supernode), after those of its children.
struct Supernode {
  std::vector<std::uint32_t> pivots;  ///< in order of elimination
  std::vector<std::uint32_t> border;  ///< vertices eliminated later that it is coupled to, in order of elimination
  std::vector<std::int32_t> children;
};

/// Children before parents. The order is approximate minimum degree on the blocks; neighbours in the elimination tree
/// are joined where that adds few zeros.
std::vector<Supernode> plan_elimination(const BlockMatrix& matrix);

}  // namespace retalho
