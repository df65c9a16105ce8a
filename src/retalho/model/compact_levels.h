// The order in which a compact model's heights are coded: from a few vertices to all of them, every new vertex among
// neighbours that are known. It follows from the positions alone. Internal to the room.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tin/cell_delaunay.h"

namespace retalho {

struct CellLevel : CellTriangulation {
  std::vector<std::uint32_t> fresh;  ///< vertices that this level adds, ascending
};

/// The coarsest level first; the last one holds all. A level leaves out of the next finer one a maximal set of vertices
/// no two of which are neighbours, those with few neighbours first, corners of the outline never; the coarsest has 8
/// vertices or fewer, or nothing but corners. Cost: about 5 us a vertex; memory: about 500 bytes a vertex.
std::vector<CellLevel> make_levels(std::span<const greedy::Cell> cells, const Context& context = {});

}  // namespace retalho
