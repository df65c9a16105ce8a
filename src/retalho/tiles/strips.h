// What tiles that share a seam must agree on when heights and gradients are fitted to the cells: the unknowns of the
// seam's vertices, decided by the seam's own strip of data.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>

#include "retalho/core/context.h"
#include "retalho/tiles/plan.h"
#include "retalho/tiles/seam.h"

namespace retalho {

/// Triangulations of a tile and its eight neighbours, row by row; tin == nullptr where there is none.
using TilesAround = std::array<PlacedTin, 9>;

struct VertexData {
  double height = 0;
  Vec2 gradient;  ///< unused by linear surfaces
};

/// The fitted data of the vertices that the middle tile shares with neighbours, by GridCell::key().
///
/// A corner where tiles meet is fitted on the triangles within kStripRings rings of it, out of all tiles that have it;
/// a seam on those within kStripRings rings of its vertices, out of its two tiles, with the corners at its ends held.
/// Each of these problems is the same whichever of its tiles asks: same triangles in the same order, same cells read;
/// so all get the same bits. A vertex's unknowns feel data at ring r with about 0.11, 0.03, 5e-3, 1.5e-3 at r = 1 to 4
/// (docs/tiles.md), which bounds what the strip leaves out.
/// Reads the heights of the strips; memory: fit_least_squares' for the largest strip, at most four tiles' cells.
std::unordered_map<std::uint64_t, VertexData> fit_seams(const TilePlan& plan, const TilesAround& tiles,
                                                        const Context& context = {});

inline constexpr int kStripRings = 4;

}  // namespace retalho
