// Internal to level/: the border of a model's valid area, the part of its triangulation that lies in cells with data.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/bands.h"
#include "retalho/level/clip.h"

namespace retalho {

/// Pieces of the border, the valid area on their left: what of `outline` (terrain_border) runs through cells with data,
/// and the sides between cells with data and without that lie on the triangulation, with the cuts of lines on them.
/// `root_places`: of the outline's roots, by their number; `inside`: does a place lie on the triangulation?
/// Cost: O(cells + outline + cuts), and `inside` for each side that the outline does not cross.
std::vector<DirectedBorder> void_border(const GridDomain& grid, const std::vector<DirectedBorder>& outline,
                                        std::span<const Vec2> root_places, const std::vector<LineCut>& cuts,
                                        const std::function<bool(Vec2)>& inside, const Context& context);

}  // namespace retalho
