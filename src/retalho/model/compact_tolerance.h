// A compact file whose surface is within a tolerance of every cell. Internal to the room.
#pragma once

#include "retalho/model/compact_file.h"
#include "retalho/terrain/folded_surface.h"
#include "retalho/terrain/held_fit.h"

namespace retalho {

/// Starts from these vertices (ascending) and the fit's rounding in the loop; then, while cells are over the tolerance,
/// steps the numbers of the vertices around them on their lattices, and adds vertices where that does not help; a
/// vertex that is added late keeps the height of its cell, so that this ends. Half a step must be less than the
/// tolerance: true for steps up to it.
CompactEncoding encode_within(double tolerance, FoldedVertices vertices, const Raster& raster,
                              const CompactFrameFacts& facts, const HeldFitOptions& options, const Context& context);

}  // namespace retalho
