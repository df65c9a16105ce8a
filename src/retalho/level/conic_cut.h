// Internal to level/: conics of a model end where its grid has no data.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/conics.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// The parts of the lines that lie in cells with data (a cell is the rectangle of points nearest to its centre), as
/// clip_to_cells has those of polylines: each is still a chain of conics, exactly the same curve. Where it ends is a
/// root of a quadratic, to the rounding of doubles, and lies on the cell's side in the very numbers of the side. A line
/// that is not cut stays as it is. Cost: O(segments + sides passed).
std::vector<ConicLine> cut_conics(std::vector<ConicLine> lines, const GridDomain& grid, const Context& context);

}  // namespace retalho
