// The range of a terrain's heights is that of the data, wherever the vertices in voids lie.
#include "retalho/terrain/height_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retalho/terrain/surface_refine.h"
#include "support/grids.h"
#include "support/sample_terrain.h"

namespace retalho {
namespace {

// A slope with one corner missing, far away from all data: there a fitted surface goes on as it likes.
TEST(HeightRange, VerticesInVoidsDoNotCount) {
  const Raster raster = test::make_grid(60, 60, [](int x, int y) {
    return x + y < 55 ? NAN : 100 + 4.0 * (x - 30) + 20 * std::sin(x / 5.0) * std::cos(y / 4.0);
  });
  const Terrain terrain = refine_surface(raster, {.vertices = 60});
  const RasterSummary data = summarize(raster);
  const auto [low, high] = std::minmax_element(terrain.tin.heights.begin(), terrain.tin.heights.end());
  const double span = data.maximum - data.minimum;
  ASSERT_GT(std::max(data.minimum - *low, *high - data.maximum), 0.2 * span) << "the case that this is for";
  const HeightRange range = height_range(terrain);
  EXPECT_NEAR(range.low, data.minimum, 0.1 * span);
  EXPECT_NEAR(range.high, data.maximum, 0.1 * span);
  // The same of a tile that lies elsewhere in a whole.
  Terrain moved = terrain;
  const Vec2 origin{400, -700};
  for (Vec2& p : moved.tin.points) p = p + origin;
  EXPECT_EQ(height_range(moved, origin).low, range.low);
  EXPECT_EQ(height_range(moved, origin).high, range.high);
}

TEST(HeightRange, WithoutDataOrVerticesThereIsStillOne) {
  Terrain terrain = test::sample_terrain({.mask = true});
  terrain.grid.valid = Mask(terrain.grid.columns, terrain.grid.rows, false);
  const auto [low, high] = std::minmax_element(terrain.tin.heights.begin(), terrain.tin.heights.end());
  EXPECT_EQ(height_range(terrain).low, *low);
  EXPECT_EQ(height_range(terrain).high, *high);
  EXPECT_EQ(height_range({}).low, 0);
  EXPECT_EQ(height_range({}).high, 0);
}

}  // namespace
}  // namespace retalho
