// Internal to level/: regions between neighbouring levels, put together from the lines and the border of the valid area
// (docs/contours.md, "Bands").
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/level/contours.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/trace_grid.h"
#include "retalho/level/trace_terrain.h"

namespace retalho {

/// A piece of the border, with the valid area on its left.
struct DirectedBorder {
  std::uint64_t from = 0, to = 0;    ///< nodes
  Vec2 place;                        ///< of `from`
  int band = 0;                      ///< that `from` lies in
  std::vector<std::uint32_t> roots;  ///< points of the trace, in the order of the walk
};

std::vector<DirectedBorder> grid_border(const FixedGrid& grid, const FixedLevels& levels, std::vector<BorderEdge> edges,
                                        const Trace& trace);
std::vector<DirectedBorder> terrain_border(const Terrain& terrain, const EdgeTable& edges, double per_unit,
                                           const FixedLevels& levels, const OuterRoots& outer, const Trace& trace);

/// `ends`: the first and last point of each line of `set` in the trace (only open lines' are read).
/// Throws Error (internal) when an open line does not end on the border.
BandSet build_bands(const ContourSet& set, const std::vector<std::array<std::uint32_t, 2>>& ends,
                    const std::vector<DirectedBorder>& border);

}  // namespace retalho
