// A model's intervisibility map beside the grid's own.
#include "retalho/visibility/model_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"
#include "support/grids.h"

namespace retalho {
namespace {

Raster hills() {
  Raster raster = test::make_grid(24, 18, [](int x, int y) { return 9 * std::sin(0.7 * x) * std::cos(0.5 * y); });
  std::visit(
      [&](auto& heights) {
        using Height = typename std::decay_t<decltype(heights)>::value_type;
        heights[raster.index(7, 5)] = std::numeric_limits<Height>::quiet_NaN();
      },
      raster.heights);
  return raster;
}

TEST(ModelMap, OfAModelOfEveryCellIsTheGridsOwn) {
  const Raster raster = hills();
  const IntervisibilityOptions options{.directions = 24, .radius = 9};
  const Terrain all = make_terrain(refine_tin(raster, {}), raster, {.surface = SurfaceKind::linear});
  const std::vector<float> own = intervisibility_map(raster, options),
                           map = model_intervisibility(all, raster, options);
  EXPECT_TRUE(std::isnan(map[raster.index(7, 5)]));
  EXPECT_LT(compare_maps(map, own).rmse, 1e-3);
  const Terrain few =
      make_terrain(refine_tin(raster, {.vertices = 12}), raster, {.surface = SurfaceKind::clough_tocher});
  const MapDifference far = compare_maps(model_intervisibility(few, raster, options), own);
  EXPECT_GT(far.rmse, 1);
  EXPECT_EQ(far.cells, raster.cells() - 1);
}

}  // namespace
}  // namespace retalho
