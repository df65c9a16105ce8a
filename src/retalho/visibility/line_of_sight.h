// The sight line between two points of a grid: is it free, what does the terrain under it look like, and how much of
// the Fresnel zone of a radio link is free. It is also the slow, obvious twin of the viewshed's horizon.
#pragma once

#include <vector>

#include "retalho/raster/raster.h"
#include "retalho/visibility/viewshed.h"

namespace retalho {

/// One crossing of the sight line with a grid line, from the observer to the target.
struct ProfilePoint {
  double distance = 0;  ///< from the observer, local units
  Vec2 at;              ///< local coordinates
  double ground = 0;    ///< terrain height, lowered by the Earth's curvature where asked for; NaN: no data
  double sight = 0;     ///< height of the straight sight line
  double fresnel = 0;   ///< radius of the first Fresnel zone; 0 without a frequency
};

struct SightLine {
  bool visible = false;
  double clearance = 0;  ///< smallest height of the sight line over the ground between the ends (negative: blocked)
  double fresnel_clear =
      0;  ///< smallest clearance over the Fresnel radius (1: the first zone is free); NaN without frequency
  double blocked_at = 0;              ///< distance of the first blocking crossing; NaN when visible
  std::vector<ProfilePoint> profile;  ///< both ends included
};

struct SightOptions {
  double target_height = 0;  ///< above the ground
  double frequency = 0;      ///< Hz; > 0: Fresnel zones; needs heights and distances in metres
  bool earth_curvature = false;
  double refraction = 0.13;
  VoidRule voids = VoidRule::transparent;
};

/// By the definition of viewshed.h: every crossing with a grid line is tested. Cost: O(columns + rows).
/// Throws BadInput where an end is outside of the grid or void.
SightLine line_of_sight(const Raster& raster, const Observer& observer, int target_column, int target_row,
                        const SightOptions& options = {});
/// The same, asking for the cells beside the line alone.
SightLine line_of_sight(const CellHeights& cells, const Observer& observer, int target_column, int target_row,
                        const SightOptions& options = {});

}  // namespace retalho
