#include "retalho/visibility/model_map.h"

#include <cmath>
#include <limits>
#include <utility>

#include "retalho/terrain/evaluate.h"

namespace retalho {

std::vector<float> model_intervisibility(const Terrain& terrain, const Raster& raster,
                                         const IntervisibilityOptions& options, const Context& context) {
  Raster heights;  // as `raster`, but for its heights, which need not be copied
  heights.columns = raster.columns;
  heights.rows = raster.rows;
  heights.cell_width = raster.cell_width;
  heights.cell_height = raster.cell_height;
  heights.georef = raster.georef;
  heights.height_unit = raster.height_unit;
  const Vec2 first = terrain.georef.to_local(raster.georef.to_crs({0, 0}));
  const Vec2 step{raster.cell_width / raster.georef.scale_x * terrain.georef.scale_x,
                  raster.cell_height / raster.georef.scale_y * terrain.georef.scale_y};
  std::vector<double> z(raster.cells());
  TerrainEvaluator(terrain, context).grid_values(first, step, raster.columns, raster.rows, z, {}, context);
  for (std::size_t i = 0; i < z.size(); ++i)
    if (std::isnan(raster.at(i))) z[i] = std::numeric_limits<double>::quiet_NaN();
  heights.heights = std::move(z);
  return intervisibility_map(heights, options, context);
}

}  // namespace retalho
