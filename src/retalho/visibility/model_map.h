// The intervisibility map of a model, to be laid beside that of the grid which the model stands for.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"
#include "retalho/visibility/intervisibility.h"

namespace retalho {

/// intervisibility_map of the model's heights at the valid cells of `raster`, so that both maps go by one definition;
/// the others are NaN. The raster may lie elsewhere than the model's own grid. Throws and costs as intervisibility_map.
std::vector<float> model_intervisibility(const Terrain& terrain, const Raster& raster,
                                         const IntervisibilityOptions& options = {}, const Context& context = {});

}  // namespace retalho
