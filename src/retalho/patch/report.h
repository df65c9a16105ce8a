// What a surface is worth: how near it runs to its sides, how smooth it is inside, whether it folds.
#pragma once

#include "retalho/patch/surface.h"

namespace retalho {

struct PatchReport {
  double boundary_gap = 0;   ///< largest distance of the surface from its side curves, at 1001 places a side
  double gradient_jump = 0;  ///< largest difference of a first derivative over an inner edge (three places an edge, at
                             ///< most 20,000 triangles), by |du| + |dv| of the surface there
  FoldReport folds;          ///< of the mesh of nodes
  std::size_t turned = 0;    ///< triangles with a place whose normal looks away from the flat triangle's
};
PatchReport assess(const Patch& patch, const PatchSurface& surface);

}  // namespace retalho
