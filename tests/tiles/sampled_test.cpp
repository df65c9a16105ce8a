// Tiled models sampled by others: quantized-mesh tiles and pictures are the joined model's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/model/model.h"
#include "retalho/raster/io.h"
#include "retalho/render/field.h"
#include "retalho/render/relief.h"
#include "retalho/tiles/make.h"
#include "retalho/tiles/source.h"
#include "support/support.h"
#include "tiles/made.h"

namespace retalho {
namespace {

using Made = test::MadeTiles;
using test::contents;

constexpr const char* kUtm =
    "PROJCS[\"WGS 84 / UTM zone 33N\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],"
    "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],"
    "PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",15],PARAMETER[\"scale_factor\",0.9996],"
    "PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",0],UNIT[\"metre\",1]]";

/// Tiles with a CRS, in `folder`/tiles.
void make_utm_tiles(const test::ScratchFolder& folder, bool voids) {
  Raster raster = test::hills(131, 98, voids);
  raster.georef.crs_wkt = kUtm;
  raster.georef.unit = "metre";
  write_raster(raster, folder / "dem.tif");
  make_tiles(plan_tiles(folder / "dem.tif", {.size = 40, .max_error = 1.5}), folder / "tiles", 2, false);
}

TEST(SampledTiles, OnTheGlobeAreTheJoinedModels) {
  for (const bool voids : {false, true}) {
    const test::ScratchFolder folder;
    make_utm_tiles(folder, voids);
    const auto whole = std::get<Terrain>(load_model(folder / "tiles"));
    const QuantizedMeshOptions options{.tolerance = 0.5, .level = 15, .gzip = false};
    const GlobeNotes joined = write_quantized_mesh(TerrainEvaluator(whole), folder / "joined", options);
    const auto expected = contents(folder / "joined");
    std::map<std::string, std::string> first;
    for (const auto& [threads, bound] : {std::pair{1, TileReader::kBound}, {2, std::size_t{1}}, {7, std::size_t{1}}}) {
      const VertexBox box = vertex_box(tile_source(folder / "tiles", bound));
      ASSERT_TRUE(box.data);
      const auto [low, high] = std::minmax_element(whole.tin.heights.begin(), whole.tin.heights.end());
      EXPECT_EQ(box.low.z, *low);
      EXPECT_EQ(box.high.z, *high);
      TileReader reader(folder / "tiles", bound);
      const std::string name = folder / ("tiles" + std::to_string(threads));
      const GlobeNotes notes =
          write_quantized_mesh(globe_surface(reader, box), name, options, false, {.threads = threads});
      EXPECT_EQ(notes.tiles, joined.tiles);
      EXPECT_EQ(notes.levels, joined.levels);
      EXPECT_EQ(notes.step, joined.step);
      EXPECT_NEAR(static_cast<double>(notes.triangles), static_cast<double>(joined.triangles),
                  0.01 * static_cast<double>(joined.triangles));
      const auto got = contents(name);
      if (first.empty()) first = got;
      EXPECT_TRUE(got == first) << threads << " threads";
      // Heights and normals are whole numbers of steps: rounding is seen where one lies between two alone.
      std::size_t same = 0;
      for (const auto& [file, bytes] : expected) {
        ASSERT_TRUE(got.contains(file)) << file;
        same += got.at(file) == bytes ? 1 : 0;
      }
      EXPECT_EQ(got.size(), expected.size());
      EXPECT_GE(same, expected.size() * 9 / 10) << "of " << expected.size();
    }
    EXPECT_GT(joined.triangles, 5000U);
  }
}

TEST(SampledTiles, AsThreeDTilesAreTheJoinedModelsFiles) {
  for (const bool voids : {false, true}) {
    const test::ScratchFolder folder;
    make_utm_tiles(folder, voids);
    const TilesetOptions options{.tolerance = 0.5, .triangles = 1000};
    const GlobeNotes joined =
        write_tileset(std::get<Terrain>(load_model(folder / "tiles")), folder / "joined", options);
    EXPECT_GT(joined.tiles, 4U);
    for (const int threads : {1, 7}) {
      const std::string name = folder / ("tiles" + std::to_string(threads));
      const GlobeNotes notes =
          write_tileset(tile_source(folder / "tiles", 1), name, options, false, {.threads = threads});
      EXPECT_EQ(notes.tiles, joined.tiles);
      EXPECT_EQ(notes.triangles, joined.triangles);
      const auto expected = contents(folder / "joined"), got = contents(name);
      ASSERT_EQ(got.size(), expected.size()) << "and nothing hidden is left";
      for (const auto& [file, bytes] : expected) EXPECT_TRUE(got.at(file) == bytes) << file;
    }
    EXPECT_THROW(write_tileset(tile_source(folder / "tiles"), folder / "joined", options), CannotWrite);
  }
}

TEST(SampledTiles, PicturesAreTheJoinedModels) {
  for (const bool voids : {false, true}) {
    const Made made(voids);
    make_tiles(made.plan, made.tiles, 2, false);
    const auto whole = std::get<Terrain>(load_model(made.tiles));
    const TerrainEvaluator evaluator(whole);
    TileReader reader(made.tiles, 1);
    const Window window = fit_window(whole.georef, extent_of(whole), 301, 233);
    const HeightField expected = field_of(evaluator)(window, {}), got = field_of(reader)(window, {});
    ASSERT_EQ(got.heights.size(), expected.heights.size());
    std::size_t valid = 0;
    for (std::size_t k = 0; k < expected.heights.size(); ++k) {
      ASSERT_EQ(std::isnan(got.heights[k]), std::isnan(expected.heights[k])) << k;
      if (std::isnan(got.heights[k])) continue;
      ++valid;
      ASSERT_NEAR(got.heights[k], expected.heights[k], 1e-9);
      ASSERT_LT(norm(got.gradients[k] - expected.gradients[k]), 1e-8);
    }
    EXPECT_GT(valid, 30000U);
    EXPECT_EQ(reader.reads(), 12U) << "each tile once";
    EXPECT_EQ(shade_relief(field_of(reader), window, {}, {}, {.threads = 1}).pixels,
              shade_relief(field_of(reader), window, {}, {}, {.threads = 7}).pixels);
  }
}

TEST(SampledTiles, AreAskedTileByTile) {
  const Made made(true);
  make_tiles(made.plan, made.tiles, 2, false);
  test::Random random;
  std::vector<Vec2> points;
  for (int k = 0; k < 2000; ++k) points.push_back({random.uniform(-50, 1000), random.uniform(-950, 50)});
  points[7] = {std::nan(""), 0};
  TileReader one(made.tiles, 1), all(made.tiles);
  const auto got = one.jets(points);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto expected = all.jet(points[k]);
    ASSERT_EQ(got[k].has_value(), expected.has_value()) << k;
    if (expected) {
      EXPECT_EQ(got[k]->value, expected->value);
    }
  }
  EXPECT_LT(one.reads(), 60U) << "a tile at a time, and its neighbours for places near a seam without data";
}

}  // namespace
}  // namespace retalho
