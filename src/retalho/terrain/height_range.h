// How low and how high a terrain goes: what ranges of levels, of colours and of tolerances are taken from.
#pragma once

#include "retalho/terrain/terrain.h"

namespace retalho {

struct HeightRange {
  double low = 0, high = 0;
};

/// Of the vertices that lie where the model has data; of all where none does, 0 and 0 without vertices. A vertex in a
/// void has no height to be near to: a fit may leave it anywhere on the planes that go out from the data. The surface
/// may go a little beyond its vertices. `origin`: the local coordinates of the grid's north-western cell.
HeightRange height_range(const Terrain& terrain, Vec2 origin = {});

}  // namespace retalho
