// The viewshed against its slow twin on pieces of real grids: 20 observers on each of five.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "retalho/raster/io.h"
#include "retalho/visibility/intervisibility.h"
#include "retalho/visibility/line_of_sight.h"
#include "retalho/visibility/viewshed.h"
#include "support/support.h"

namespace retalho {
namespace {

/// `side` x `side` cells around the grid's middle.
Raster middle_of(const Raster& r, int side) {
  Raster out = r;
  out.columns = std::min(side, r.columns);
  out.rows = std::min(side, r.rows);
  const int left = (r.columns - out.columns) / 2, top = (r.rows - out.rows) / 2;
  std::vector<double> z(out.cells());
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.columns; ++x) z[out.index(x, y)] = r.at(left + x, top + y);
  out.heights = std::move(z);
  const Vec2 corner = r.georef.to_crs(r.centre(left, top));
  out.georef.origin_x = corner.x;
  out.georef.origin_y = corner.y;
  return out;
}

void equals_its_twin(const std::string& file) {
  const Raster r = middle_of(read_raster(file), 160);
  test::Random random;
  std::size_t cells = 0, seen = 0, differ = 0;
  for (int observers = 0; observers < 20;) {
    const auto pick = [&](int n) { return std::min(n - 1, static_cast<int>(random.uniform() * n)); };
    const Observer o{pick(r.columns), pick(r.rows), observers % 4 == 0 ? 0.0 : 2.0};
    if (!r.valid(o.column, o.row)) continue;
    ++observers;
    const auto fast = viewshed(r, o);
    for (int y = 0; y < r.rows; ++y)
      for (int x = 0; x < r.columns; ++x) {
        if (!r.valid(x, y)) continue;
        const bool slow = line_of_sight(r, o, x, y).visible;
        const bool quick = fast[r.index(x, y)] != 0;
        differ += slow != quick ? 1U : 0U;
        seen += slow ? 1U : 0U;
        ++cells;
      }
  }
  EXPECT_EQ(differ, 0U) << "of " << cells;
  EXPECT_GT(seen, cells / 200);  // a fair share is seen, and a fair share is not
  EXPECT_LT(seen, cells / 2);
  EXPECT_GT(cells, 200000U);
}

TEST(RealGrids, ViewshedEqualsItsTwinOnTheCrater) {
  RETALHO_DATA_FILE(file, "dem/crater.pgm");
  equals_its_twin(file);
}
TEST(RealGrids, ViewshedEqualsItsTwinOnCityRoofs) {
  RETALHO_DATA_FILE(file, "dem/dom1_32_356_5699_1_nw_2020.tif");
  equals_its_twin(file);
}
TEST(RealGrids, ViewshedEqualsItsTwinOnMountains) {
  RETALHO_DATA_FILE(file, "dem/N44W072.hgt");
  equals_its_twin(file);
}
TEST(RealGrids, ViewshedEqualsItsTwinOnGlaciers) {
  RETALHO_DATA_FILE(file, "dem/exploradores_aster.tif");
  equals_its_twin(file);
}
TEST(RealGrids, ViewshedEqualsItsTwinOnDrumlins) {
  RETALHO_DATA_FILE(file, "dem/drumlin_dem.tif");
  equals_its_twin(file);
}

TEST(CompareMaps, LeavesVoidsOutAndTellsTheSign) {
  const float none = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> map{1, 5, none, 4}, reference{4, 1, 7, none};
  const MapDifference d = compare_maps(map, reference);
  EXPECT_EQ(d.cells, 2U);
  EXPECT_DOUBLE_EQ(d.mean, 0.5);
  EXPECT_DOUBLE_EQ(d.maximum, 4);
  EXPECT_NEAR(d.rmse, std::sqrt(12.5), 1e-12);
  EXPECT_EQ(compare_maps(map, map).maximum, 0);
  EXPECT_THROW(compare_maps(map, std::vector<float>{1}), UsageError);
}

}  // namespace
}  // namespace retalho
