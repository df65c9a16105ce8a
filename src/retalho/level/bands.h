// Internal to level/: regions between neighbouring levels, put together from the lines and the border of the valid area
// (docs/contours.md, "Bands").
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/level/band_nesting.h"
#include "retalho/level/contours.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/trace_grid.h"
#include "retalho/level/trace_terrain.h"

namespace retalho {

/// A piece of the border, with the valid area on its left.
struct DirectedBorder {
  static constexpr int kUnknownBand = -1;  ///< another piece of the chain may know
  static constexpr int kAskMiddle = -2;    ///< the piece's middle lies in the triangulation: a BandLocator knows

  std::uint64_t from = 0, to = 0;    ///< nodes
  Vec2 place;                        ///< of `from`
  Vec2 along;                        ///< which way it runs; a piece may have no length
  int band = 0;                      ///< that `from` lies in, or one of the above
  std::vector<std::uint32_t> roots;  ///< points of the trace, in the order of the walk
};

std::vector<DirectedBorder> grid_border(const FixedGrid& grid, const FixedLevels& levels,
                                        std::vector<BorderEdge> edges);
std::vector<DirectedBorder> terrain_border(const Terrain& terrain, const EdgeTable& edges, double per_unit,
                                           const FixedLevels& levels, const OuterRoots& outer, const Trace& trace);

/// `ends`: the first and last point of each line of `set` in the trace (only open lines' are read).
/// `around`: asked where no line meets a chain of the border and none of its pieces knows its band.
/// Throws Error (internal) when an open line does not end on the border.
BandSet build_bands(const ContourSet& set, const std::vector<std::array<std::uint32_t, 2>>& ends,
                    const std::vector<DirectedBorder>& border, const BandLocator* around = nullptr);

}  // namespace retalho
