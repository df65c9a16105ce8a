// Internal to level/: lines of a model end where its grid has no data.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/level/cell_walk.h"
#include "retalho/level/contours.h"

namespace retalho {

/// Does the model's grid have cells without data?
bool has_voids(const GridDomain& grid);

/// Where a line was cut: on the side between a cell with data and one without.
struct LineCut {
  std::uint32_t root;  ///< the number that the end of the line got
  CellSide side;
  Vec2 place;
};

/// Cuts the lines at the borders of cells without data (a cell is the rectangle of points nearest to its centre).
/// `ends`: what each line's ends are called; cut ends get numbers from `first_root` on. A part may have no length; it
/// has two points then.
std::vector<LineCut> clip_to_cells(ContourSet& set, std::vector<std::array<std::uint32_t, 2>>& ends,
                                   std::uint32_t first_root, const PlacedGrid& grid);

/// Drops lines without length.
void drop_points(ContourSet& set);

}  // namespace retalho
