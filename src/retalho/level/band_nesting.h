// Internal to level/: which hole lies in which region.
#pragma once

#include <vector>

#include "retalho/level/contours.h"

namespace retalho {

/// Twice the signed area.
double doubled_area(const std::vector<Vec2>& ring);

/// Rings of one band, outer ones counter-clockwise, to polygons: each hole goes to the smallest region around it.
void nest_rings(int band, std::vector<std::vector<Vec2>> rings, std::vector<BandPolygon>& polygons);

}  // namespace retalho
