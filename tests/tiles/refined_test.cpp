// Tiles refined by their surface: better than by the flat triangulation, and still one surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/model/model.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/report.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tiles/make.h"
#include "support/support.h"
#include "tiles/made.h"

namespace retalho {
namespace {

using Made = test::MadeTiles;
using test::contents;

TEST(RefinedTiles, AreBetterThanFlatRefinedOnesWithNoMoreVertices) {
  for (const SurfaceKind surface : {SurfaceKind::linear, SurfaceKind::clough_tocher})
    for (const bool voids : {false, true}) {
      const Made flat(voids, surface, 900, std::nullopt), made(voids, surface, 900, Effort::normal);
      const TiledIndex index = make_tiles(made.plan, made.tiles, 2, false);
      make_tiles(flat.plan, flat.tiles, 2, false);
      EXPECT_EQ(index.effort, "normal");
      const Raster raster = read_raster(made.dem);
      const auto before = std::get<Terrain>(load_model(flat.tiles)), after = std::get<Terrain>(load_model(made.tiles));
      EXPECT_LE(after.tin.vertex_count(), before.tin.vertex_count());
      EXPECT_GE(after.tin.vertex_count(), before.tin.vertex_count() * 98 / 100);
      const ErrorReport was = assess(before, raster), is = assess(after, raster);
      EXPECT_LT(is.rmse, 0.9 * was.rmse) << surface_name(surface) << " voids " << voids;
      EXPECT_EQ(is.uncovered, 0U);
      EXPECT_TRUE(check_mesh(mesh_terrain(after, {.tolerance = 1})).watertight());
      save_model(after, (made.folder.path() / "one.retalho").string());  // which checks it
      RecordProperty(std::string(surface_name(surface)) + (voids ? " voids" : ""), std::to_string(is.rmse / was.rmse));
    }
}

TEST(RefinedTiles, AreTheSameBytesWhoeverMakesThem) {
  const Made made(true, SurfaceKind::clough_tocher, 900, Effort::normal);
  make_tiles(made.plan, made.tiles, 1, false, {.threads = 1});
  const auto expected = contents(made.tiles);
  for (const int jobs : {1, 2, 5}) {
    const std::string other = (made.folder.path() / std::to_string(jobs)).string();
    make_tiles(made.plan, other, jobs, false);
    EXPECT_EQ(contents(other), expected) << jobs << " jobs";
  }
  // Another effort is another model.
  const TilePlan fast = plan_tiles(
      made.dem,
      {.size = 40, .vertices = 900, .surface = SurfaceKind::clough_tocher, .fitted = true, .refine = Effort::fast});
  EXPECT_THROW(make_tiles(fast, made.tiles, 2, false), CannotWrite);
  EXPECT_EQ(index_text(parse_index(index_text(read_tiled_index(made.tiles)))),
            index_text(read_tiled_index(made.tiles)));
}

TEST(RefinedTiles, AnIndexThatSaysOtherwiseIsRefused) {
  const Made made(false, SurfaceKind::linear, 900, Effort::fast);
  const std::string text = index_text(made.plan.frame);
  EXPECT_EQ(parse_frame(text).effort, "fast");
  for (const auto& [from, to, words] :
       {std::tuple{"\"refine\": \"surface\"", "\"refine\": \"luck\"", "an unknown refinement \"luck\""},
        {"\"effort\": \"fast\"", "\"effort\": \"none\"", "an unknown effort 'none'"}}) {
    std::string wrong = text;
    const std::size_t at = wrong.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    wrong.replace(at, std::string(from).size(), to);
    try {
      parse_frame(wrong);
      FAIL() << to;
    } catch (const CannotRead& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  }
}

TEST(RefinedTiles, TakeWhatASeamCanKeep) {
  const Made made(false);
  const auto plan = [&](TileOptions options) {
    options.size = 40;
    options.refine = Effort::fast;
    return plan_tiles(made.dem, options);
  };
  EXPECT_THROW(plan({.max_error = 1, .fitted = true}), UsageError);
  EXPECT_THROW(plan({.vertices = 900}), UsageError) << "interpolated";
  EXPECT_THROW(plan({.vertices = 900, .surface = SurfaceKind::powell_sabin, .fitted = true}), UsageError);
  EXPECT_NO_THROW(plan({.vertices = 900, .surface = SurfaceKind::linear, .fitted = true}));
}

TEST(RefineInside, KeepsItsSides) {
  const Raster raster = test::hills(60, 50, false);
  std::vector<SideVertex> sides;
  for (const int column : {0, 7, 20, 21, 40, 59}) {
    SideVertex side;
    side.column = column;
    side.held = column % 2 == 1;
    side.height = raster.at(column, 0) + 3;
    side.gradient = {0.1, -0.2};
    sides.push_back(side);
  }
  const Terrain terrain = refine_inside(raster, sides, {true, false, false, false}, {.vertices = 150});
  EXPECT_EQ(terrain.tin.vertex_count(), 150U);
  std::size_t north = 0;
  for (std::size_t v = 0; v < terrain.tin.vertex_count(); ++v) {
    const Vec2 p = terrain.tin.points[v];
    if (p.y != 0) continue;
    ++north;
    const auto column = static_cast<int>(std::lround(p.x / raster.cell_width));
    const auto side = std::find_if(sides.begin(), sides.end(), [&](const SideVertex& s) { return s.column == column; });
    ASSERT_NE(side, sides.end()) << "column " << column;
    EXPECT_EQ(terrain.tin.heights[v] == side->height, side->held);
    EXPECT_EQ(terrain.gradients[v] == side->gradient, side->held);
  }
  EXPECT_EQ(north, sides.size());
  EXPECT_THROW(refine_inside(raster, sides, {true}, {.max_error = 1}), UsageError);
  sides.back().column = 60;
  try {
    refine_inside(raster, sides, {true}, {.vertices = 100});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("no vertex can be settled at cell (60, 0)"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(refine_inside(raster, sides, {true}, {.surface = SurfaceKind::powell_sabin, .vertices = 100}),
               UsageError);
}

}  // namespace
}  // namespace retalho
