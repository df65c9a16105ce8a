// Internal to level/: lines of a model end where its grid has no data.
#pragma once

#include "retalho/level/contours.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// Does the model's grid have cells without data?
bool has_voids(const GridDomain& grid);

/// Cuts the lines at the borders of cells without data (a cell is the rectangle of points nearest to its centre).
void clip_to_cells(ContourSet& set, const GridDomain& grid);

}  // namespace retalho
