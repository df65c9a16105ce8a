// Internal to level/: the border of a model's valid area, the part of its triangulation that lies in cells with data.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/bands.h"
#include "retalho/level/clip.h"

namespace retalho {

/// Pieces of the border, the valid area on their left: what of `outline` (terrain_border) runs through cells with data,
/// and the sides between cells with data and without that lie on the triangulation, with the cuts of lines on them.
/// Cost: O(cells + outline + cuts) and a search of the triangulation
/// for each side.
std::vector<DirectedBorder> void_border(const Terrain& terrain, const std::vector<DirectedBorder>& outline,
                                        const Trace& trace, const std::vector<LineCut>& cuts, const Context& context);

}  // namespace retalho
