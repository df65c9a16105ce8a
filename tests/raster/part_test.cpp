#include "retalho/raster/part.h"

#include <gtest/gtest.h>

#include "retalho/core/error.h"

namespace retalho {
namespace {

template <class Number>
Raster numbered(int columns, int rows) {
  Raster raster;
  raster.columns = columns;
  raster.rows = rows;
  raster.cell_width = 3;
  raster.cell_height = 2;
  raster.georef.origin_x = 5e6;
  raster.georef.origin_y = 4e6;
  std::vector<Number> heights(raster.cells());
  for (std::size_t k = 0; k < heights.size(); ++k) heights[k] = static_cast<Number>(k) / 3;
  raster.heights = std::move(heights);
  return raster;
}

TEST(RasterPart, HasTheSameHeightsAtTheSamePlaces) {
  for (const Raster& whole : {numbered<float>(9, 7), numbered<double>(9, 7)})
    for (const CellWindow& w : {CellWindow{0, 0, 9, 7}, CellWindow{2, 3, 5, 4}, CellWindow{8, 6, 1, 1}}) {
      const Raster part = part_of(whole, w);
      ASSERT_EQ(part.columns, w.columns);
      ASSERT_EQ(part.rows, w.rows);
      EXPECT_EQ(part.heights.index(), whole.heights.index());
      for (int r = 0; r < w.rows; ++r)
        for (int c = 0; c < w.columns; ++c) {
          EXPECT_EQ(part.at(c, r), whole.at(w.column + c, w.row + r));
          EXPECT_TRUE(part.georef.to_crs(part.centre(c, r)) ==
                      whole.georef.to_crs(whole.centre(w.column + c, w.row + r)));
        }
    }
}

TEST(RasterPart, ThinnedKeepsTheMiddleCellOfEachBlock) {
  const Raster whole = numbered<float>(9, 7);
  const Raster thin = thinned(whole, 3);
  ASSERT_EQ(thin.columns, 3);
  ASSERT_EQ(thin.rows, 2);
  EXPECT_EQ(thin.cell_width, 9);
  EXPECT_EQ(thin.cell_height, 6);
  for (int r = 0; r < thin.rows; ++r)
    for (int c = 0; c < thin.columns; ++c) {
      EXPECT_EQ(thin.at(c, r), whole.at(3 * c + 1, 3 * r + 1));
      EXPECT_TRUE(thin.georef.to_crs(thin.centre(c, r)) == whole.georef.to_crs(whole.centre(3 * c + 1, 3 * r + 1)));
    }
  EXPECT_EQ(thinned(whole, 1).cells(), whole.cells());
  EXPECT_EQ(thinned(whole, 7).cells(), 1U);
  EXPECT_THROW(thinned(whole, 0), UsageError);
  EXPECT_THROW(thinned(whole, 8), UsageError);
}

}  // namespace
}  // namespace retalho
