// The terrain view's calls: fit, mesh, errors, contours, values at a point, profile, viewshed.
#pragma once

#include "calls.h"
#include "input_files.h"

namespace retalho::viewer {

/// Adds /api/terrain/... to `table`. The calls keep the inputs and the last few models that were fitted.
void add_terrain_calls(CallTable& table, const InputFiles& inputs);

}  // namespace retalho::viewer
