// Tiled models read tile by tile: what the joined model says, within a bound of memory.
#include "retalho/tiles/reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/raster/io.h"
#include "retalho/tiles/make.h"
#include "support/support.h"

namespace retalho {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Made {
  test::ScratchFolder folder;
  std::string dem = (folder.path() / "dem.tif").string(), tiles = (folder.path() / "tiles").string();

  /// `voids`: a lake across seams, and all of one tile but its eastern seam.
  Made(bool voids, SurfaceKind surface) {
    Raster raster;
    raster.columns = 131;
    raster.rows = 98;
    raster.cell_width = 7.3;
    raster.cell_height = 9.1;
    raster.georef.origin_x = 500003.65;
    raster.georef.origin_y = 4200004.55;
    std::vector<double> heights(raster.cells());
    for (int r = 0; r < raster.rows; ++r)
      for (int c = 0; c < raster.columns; ++c) {
        const bool hole = voids && (std::hypot(c - 40, r - 37) < 9 || (c > 80 && c < 120 && r > 40 && r < 80));
        heights[raster.index(c, r)] = hole ? kNan : 80 * std::sin(c / 11.0) * std::cos(r / 9.0) + 0.2 * c;
      }
    raster.heights = std::move(heights);
    write_raster(raster, dem);
    make_tiles(plan_tiles(dem, {.size = 40, .max_error = 1.5, .surface = surface}), tiles, 2, false);
  }
};

class Reader : public ::testing::TestWithParam<std::tuple<bool, SurfaceKind>> {};
INSTANTIATE_TEST_SUITE_P(Kinds, Reader,
                         ::testing::Combine(::testing::Bool(),
                                            ::testing::Values(SurfaceKind::linear, SurfaceKind::powell_sabin,
                                                              SurfaceKind::clough_tocher)));

TEST_P(Reader, SaysWhatTheJoinedModelSays) {
  const auto [voids, surface] = GetParam();
  const Made made(voids, surface);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const TerrainEvaluator evaluator(whole);
  TileReader reader(made.tiles);
  test::Random random;
  std::size_t inside = 0, outside = 0;
  for (int k = 0; k < 4000; ++k) {
    Vec2 p{random.uniform(-5, 135 * 7.3), -random.uniform(-5, 100 * 9.1)};
    if (k % 4 == 0) p.x = 40 * 7.3 * std::floor(random.uniform(0, 4));  // on seams
    if (k % 8 == 0) p.y = -40 * 9.1 * std::floor(random.uniform(0, 3));
    const auto a = evaluator.jet(p), b = reader.jet(p);
    ASSERT_EQ(a.has_value(), b.has_value()) << p.x << ", " << p.y;
    ++(a ? inside : outside);
    if (!a) continue;
    EXPECT_NEAR(a->value, b->value, 1e-9);
    if (surface != SurfaceKind::linear || k % 4 != 0) {
      EXPECT_LT(norm(a->gradient - b->gradient), 1e-8) << p.x << ", " << p.y;
    }
  }
  EXPECT_GT(inside, 2500U);
  EXPECT_GT(outside, 100U);
}

TEST_P(Reader, SamplesRowsAsTheJoinedModelDoes) {
  const auto [voids, surface] = GetParam();
  const Made made(voids, surface);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const TerrainEvaluator evaluator(whole);
  for (const auto& [origin, step, columns, rows] : {std::tuple{Vec2{0, 0}, Vec2{7.3, 9.1}, 131, 98},
                                                    {Vec2{-31.7, 20.2}, Vec2{3.1, 4.7}, 340, 220},
                                                    {Vec2{133.3, -211.1}, Vec2{19, 5}, 30, 40}}) {
    const auto count = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    std::vector<double> expected(count), got(count);
    std::vector<Vec2> expected_g(count), got_g(count);
    evaluator.grid_values(origin, step, columns, rows, expected, expected_g);
    TileReader reader(made.tiles, 1);  // one tile at a time
    for (int first = 0; first < rows; first += 17) {
      const int some = std::min(17, rows - first);
      const auto at = static_cast<std::size_t>(first) * static_cast<std::size_t>(columns),
                 size = static_cast<std::size_t>(some) * static_cast<std::size_t>(columns);
      sample_rows(reader, {origin, step, columns, first, some}, std::span(got).subspan(at, size),
                  std::span(got_g).subspan(at, size));
    }
    std::size_t valid = 0, differing = 0;
    for (std::size_t k = 0; k < count; ++k) {
      // A cell that lies on the border of the data but for rounding may fall on either side of it.
      if (std::isnan(expected[k]) != std::isnan(got[k])) {
        ++differing;
        continue;
      }
      if (std::isnan(expected[k])) continue;
      ++valid;
      ASSERT_NEAR(expected[k], got[k], 1e-9) << k;
    }
    EXPECT_GT(valid, count / 4);
    EXPECT_EQ(differing, 0U);
  }
}

TEST_P(Reader, AssessesAsTheJoinedModelIsAssessed) {
  const auto [voids, surface] = GetParam();
  const Made made(voids, surface);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const Raster raster = read_raster(made.dem);
  const ErrorReport expected = assess(whole, raster, 1.5);
  TileReader reader(made.tiles, 1);
  TiledFacts facts;
  const ErrorReport got = assess_tiles(
      reader, [&](const CellWindow& window) { return read_raster(made.dem, {.window = window}); }, 1.5, &facts);
  EXPECT_EQ(got.cells, expected.cells);
  EXPECT_EQ(got.valid_cells, expected.valid_cells);
  EXPECT_EQ(got.uncovered, expected.uncovered);
  EXPECT_EQ(got.violations, expected.violations);
  EXPECT_NEAR(got.rmse, expected.rmse, 1e-12);
  EXPECT_NEAR(got.max_error, expected.max_error, 1e-9);
  EXPECT_NEAR(got.max_error_at.x, expected.max_error_at.x, 1e-6);
  EXPECT_NEAR(got.max_error_at.y, expected.max_error_at.y, 1e-6);
  // Of a flat surface the slope on a seam is that of either side.
  EXPECT_NEAR(got.slope_rmse, expected.slope_rmse, surface == SurfaceKind::linear ? 0.02 * expected.slope_rmse : 1e-9);
  EXPECT_EQ(facts.vertices, whole.tin.vertex_count());
  EXPECT_EQ(facts.triangles, whole.tin.triangle_count());
  EXPECT_EQ(facts.gradients, whole.gradient_kind);
}

TEST(TileReader, KeepsToItsBoundAndForgetsTheOldest) {
  const Made made(false, SurfaceKind::clough_tocher);
  TileReader all(made.tiles);
  std::size_t largest = 0, sum = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) {
      largest = std::max(largest, all.tile(r, c)->bytes());
      sum += all.tile(r, c)->bytes();
    }
  EXPECT_EQ(all.reads(), 12U);
  EXPECT_EQ(all.most_kept(), sum);
  const std::size_t bound = 3 * largest;
  ASSERT_LT(bound, sum);
  TileReader few(made.tiles, bound);
  for (int round = 0; round < 2; ++round)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) few.tile(r, c);
  EXPECT_LE(few.most_kept(), bound);
  EXPECT_EQ(few.reads(), 24U) << "round about, a least recently used one is always the next one needed";
  const auto kept = few.tile(2, 3);
  EXPECT_EQ(few.reads(), 24U) << "the last one is there";
  few.tile(0, 0);
  few.tile(2, 3);
  EXPECT_EQ(few.reads(), 25U) << "and stays, as it was used";
  EXPECT_EQ(kept.get(), few.tile(2, 3).get());
  EXPECT_THROW(TileReader(made.dem), CannotRead);
}

TEST(WriteRows, GiveTheRasterOfTheWhole) {
  const Made made(true, SurfaceKind::linear);
  Raster raster = read_raster(made.dem);
  raster.heights = std::vector<float>(raster.cells(), 1.0F);
  auto& heights = std::get<std::vector<float>>(raster.heights);
  for (std::size_t k = 0; k < heights.size(); ++k)
    heights[k] = k % 7 == 0 ? static_cast<float>(kNan) : 0.1F * static_cast<float>(k % 991);
  Raster place = raster;
  place.heights = std::vector<float>();
  for (const auto& [name, driver] : {std::pair{"a.tif", ""}, {"b.tif", "COG"}}) {
    const std::string whole = (made.folder.path() / name).string(), rows = whole + "rows.tif";
    write_raster(raster, whole, {.driver = driver});
    write_rows(place, rows, {.driver = driver}, [&](int first, int count, std::span<float> out) {
      std::copy_n(heights.begin() + static_cast<std::ptrdiff_t>(raster.index(0, first)), out.size(), out.begin());
      EXPECT_EQ(out.size(), static_cast<std::size_t>(count) * 131U);
    });
    const Raster a = read_raster(whole), b = read_raster(rows);
    ASSERT_EQ(a.cells(), b.cells());
    for (std::size_t k = 0; k < a.cells(); ++k)
      ASSERT_TRUE(a.at(k) == b.at(k) || (std::isnan(a.at(k)) && std::isnan(b.at(k)))) << name << " " << k;
    EXPECT_EQ(a.georef.origin_x, b.georef.origin_x);
  }
  EXPECT_FALSE(takes_rows("x.asc"));
  EXPECT_THROW(write_rows(place, (made.folder.path() / "x.asc").string(), {}, [](int, int, std::span<float>) {}),
               UsageError);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(made.folder.path()))
    files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 5U) << "the grid and four rasters; nothing in between is left";
}

}  // namespace
}  // namespace retalho
