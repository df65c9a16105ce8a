// retalho viewshed of a tiled model: the tiles that are needed, and no others.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inputs.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tiles/reader.h"

namespace retalho::app {

/// Where eyes and their targets lie, in CRS coordinates.
struct SightPlaces {
  std::vector<Vec2> observers;
  std::optional<Vec2> target;  ///< of a sight line
  double radius = 0;           ///< local units; 0: no limit
};

/// The model at the cells that the observers may see: all, or those around them within the radius. Says which. Refused
/// where they pass the memory limit, `a_cell` bytes each. Throws BadInput for an observer without a cell.
Raster cells_in_reach(const Program& program, TileReader& reader, const std::string& path, const SightPlaces& places,
                      double a_cell, const Context& context);

/// The tiles that the sight line passes, or those that lie within the radius of an observer, as one terrain. Refused
/// where they pass the memory limit.
Terrain tiles_in_reach(const Program& program, const std::string& path, const SightPlaces& places);

}  // namespace retalho::app
