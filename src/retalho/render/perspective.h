// A surface seen from the side, in perspective: finely cut into triangles, lit as the relief is, hidden parts removed
// by a z-buffer, with walls down to a base where the data ends.
#pragma once

#include "retalho/render/relief.h"

namespace retalho {

struct PerspectiveOptions {
  ReliefOptions relief;   ///< its exaggeration lifts the shape as well
  double from = 200;      ///< where the eye stands, degrees clockwise from north, seen from the middle
  double elevation = 35;  ///< the eye's height over the horizon, degrees, above 0 and below 90
  double base = 0;        ///< height of the walls' foot (not above the surface's lowest point looks best)
};

/// A width x height picture that the whole of `extent` fits into. White behind it.
Image draw_perspective(const FieldSource& surface, const Georef& georef, const Extent& extent, int width, int height,
                       const PerspectiveOptions& options, const FieldSource& color = {}, const Context& context = {});

}  // namespace retalho
