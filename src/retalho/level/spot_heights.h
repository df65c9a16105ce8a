// Spot heights: summits and pits that contour lines alone do not tell the height of.
//
// A summit's prominence is how far one must go down from it to reach higher ground; a pit's, how far up to lower
// ground. Both are found among the samples (8 neighbours on a grid, edges on a triangulation) and then, on a bicubic
// grid, moved to the surface's own extremum beside the sample. A place whose flat touches the border of the valid area
// is none: the ground may go on rising behind it.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/bicubic.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct SpotHeight {
  Vec2 at;  ///< local coordinates; of a flat summit or a lake: its middle
  double height = 0;
  double prominence = 0;  ///< height units, > 0; the highest (lowest) place has the whole range
  bool summit = true;     ///< else a pit
};

/// All summits and pits of at least `prominence` (> 0, else BadInput), the most prominent first. Cost: a sort of the
/// samples; 21 bytes a sample.
std::vector<SpotHeight> find_spot_heights(const BicubicGrid& grid, double prominence, const Context& context = {});
/// The same among the vertices of a model.
std::vector<SpotHeight> find_spot_heights(const Terrain& terrain, double prominence, const Context& context = {});

/// The prominence that goes with contour lines: the mean step between the levels, so that every spot's hill could have
/// a line of its own; a twentieth of the heights' range for less than two levels.
double spot_prominence(const std::vector<double>& levels, double low, double high);

}  // namespace retalho
