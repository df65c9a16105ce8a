// Tiled models: tiles agree along their seams to the last bit, whoever made them, and join to one surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <ostream>
#include <utility>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/model/model.h"
#include "retalho/model/tiled.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/report.h"
#include "retalho/tiles/make.h"
#include "support/errors.h"
#include "support/sample_terrain.h"
#include "support/support.h"
#include "tiles/made.h"

namespace retalho {
namespace {

using test::hills;
using Made = test::MadeTiles;
using test::contents;

namespace fs = std::filesystem;

/// Vertices by their cell of the whole grid.
using Vertices = std::map<std::pair<long long, long long>, std::pair<double, Vec2>>;
Vertices vertices_of(const TiledIndex& index, const TileEntry& entry, const Terrain& tile) {
  Vertices all;
  for (std::size_t v = 0; v < tile.tin.vertex_count(); ++v) {
    const auto column = entry.cells.column + std::llround(tile.tin.points[v].x / index.cell_width);
    const auto row = entry.cells.row + std::llround(-tile.tin.points[v].y / index.cell_height);
    all[{row, column}] = {tile.tin.heights[v], tile.gradients.empty() ? Vec2{} : tile.gradients[v]};
  }
  return all;
}

struct Case {
  bool voids;
  SurfaceKind surface;
  bool fitted, refined = false;

  Made make() const { return refined ? Made(voids, surface, 1500, Effort::fast) : Made(voids, surface, 1.5, fitted); }
};
void PrintTo(const Case& c, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest looks for it
  *out << surface_name(c.surface)
       << (c.refined  ? " refined"
           : c.fitted ? " fitted"
                      : "")
       << (c.voids ? " with voids" : "");
}

class Seams : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Kinds, Seams,
    ::testing::Values(Case{false, SurfaceKind::clough_tocher, false}, Case{true, SurfaceKind::clough_tocher, false},
                      Case{false, SurfaceKind::powell_sabin, false}, Case{true, SurfaceKind::powell_sabin, false},
                      Case{false, SurfaceKind::clough_tocher, true}, Case{true, SurfaceKind::clough_tocher, true},
                      Case{false, SurfaceKind::powell_sabin, true}, Case{true, SurfaceKind::powell_sabin, true},
                      Case{false, SurfaceKind::clough_tocher, true, true},
                      Case{true, SurfaceKind::clough_tocher, true, true}));

TEST_P(Seams, HaveTheSameVerticesHeightsAndGradients) {
  const Made made = GetParam().make();
  const TiledIndex index = make_tiles(made.plan, made.tiles, 2, false);
  ASSERT_EQ(index.tile_columns(), 4);
  ASSERT_EQ(index.tile_rows(), 3);
  std::map<std::pair<long long, long long>, int> seen;
  std::vector<Vertices> tiles;
  for (const TileEntry& entry : index.tiles)
    tiles.push_back(entry.file.empty() ? Vertices{} : vertices_of(index, entry, load_tile(index, entry, made.tiles)));
  std::size_t shared = 0, smooth = 0;
  for (std::size_t a = 0; a < tiles.size(); ++a)
    for (std::size_t b = a + 1; b < tiles.size(); ++b) {
      const CellWindow &u = index.tiles[a].cells, &w = index.tiles[b].cells;
      const auto inside = [](const CellWindow& window, std::pair<long long, long long> cell) {
        return cell.first >= window.row && cell.first < window.row + window.rows && cell.second >= window.column &&
               cell.second < window.column + window.columns;
      };
      for (const auto& [cell, data] : tiles[a])
        if (inside(w, cell)) {
          const auto other = tiles[b].find(cell);
          ASSERT_NE(other, tiles[b].end())
              << "cell " << cell.second << ", " << cell.first << " of tiles " << a << ", " << b;
          EXPECT_EQ(data.first, other->second.first);
          EXPECT_EQ(data.second, other->second.second) << "gradient at " << cell.second << ", " << cell.first;
          ++shared;
          smooth += norm(data.second) > 1e-3 ? 1 : 0;
        }
      for (const auto& [cell, data] : tiles[b]) EXPECT_TRUE(!inside(u, cell) || tiles[a].contains(cell));
    }
  EXPECT_GT(shared, 80U);
  EXPECT_GT(smooth, 60U);
}

TEST_P(Seams, AreSmooth) {
  const Made made = GetParam().make();
  const TiledIndex index = make_tiles(made.plan, made.tiles, 1, false);
  std::vector<Terrain> tiles;
  for (const TileEntry& entry : index.tiles) tiles.push_back(load_tile(index, entry, made.tiles));
  std::size_t compared = 0;
  double largest = 0;
  for (int r = 0; r < index.tile_rows(); ++r)
    for (int c = 0; c + 1 < index.tile_columns(); ++c) {
      const std::size_t west = static_cast<std::size_t>(r * index.tile_columns() + c), east = west + 1;
      const TerrainEvaluator a(tiles[west]), b(tiles[east]);
      const CellWindow& w = index.tiles[west].cells;
      for (double y = 0.37; y < w.rows - 1; y += 0.61) {
        const Vec2 left{(w.columns - 1) * index.cell_width, -y * index.cell_height}, right{0, left.y};
        const std::uint32_t ta = a.locate({left.x - 1e-7, left.y}), tb = b.locate({right.x + 1e-7, right.y});
        if (ta == kNone || tb == kNone || !a.valid({left.x - 1e-7, left.y})) continue;
        const Jet ja = a.jet_in(ta, left), jb = b.jet_in(tb, right);
        EXPECT_NEAR(ja.value, jb.value, 1e-9);
        largest = std::max(largest, norm(ja.gradient - jb.gradient));
        ++compared;
      }
    }
  EXPECT_GT(compared, 300U);
  EXPECT_LT(largest, 1e-9);
}

class Joined : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Voids, Joined, ::testing::Bool());

TEST_P(Joined, TilesAreOneTerrainWithinTheTolerance) {
  const Made made(GetParam(), SurfaceKind::linear);
  make_tiles(made.plan, made.tiles, 3, false);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const Raster raster = read_raster(made.dem);
  const ErrorReport report = assess(whole, raster, 1.5);
  EXPECT_EQ(report.violations, 0U);
  EXPECT_EQ(report.uncovered, 0U);
  EXPECT_EQ(report.valid_cells, valid_mask(raster).count());
  EXPECT_GT(report.max_error, 1.0) << "not degenerate";
  EXPECT_TRUE(check_mesh(mesh_terrain(whole, {.tolerance = 1})).watertight());
  save_model(whole, (made.folder.path() / "one.retalho").string());  // which checks it
}

/// All patches of tiles in the whole grid's coordinates: what a reader of one tile or of two computes on a seam.
TEST_P(Seams, HaveTheSamePolynomialsToTheLastBitInTheWholeGrid) {
  const Made made = GetParam().make();
  make_tiles(made.plan, made.tiles, 2, false);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const EdgeTable edges = build_edges(whole.tin);
  const double seam = 40 * 7.3;
  std::size_t compared = 0;
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [a, b] = edges.vertices[e];
    if (whole.tin.points[a].x != seam || whole.tin.points[b].x != seam || edges.triangles[e][1] == kNone) continue;
    // The edge's own ordinates in both triangles' pieces, by where they lie.
    std::array<std::vector<double>, 2> ordinates;
    for (const std::size_t side : {0U, 1U}) {
      std::array<TerrainPatch, 6> patches;
      const int count = triangle_patches(whole, edges, edges.triangles[e][side], patches);
      for (int k = 0; k < count; ++k) {
        const TerrainPatch& p = patches[static_cast<std::size_t>(k)];
        for (int i = p.degree; i >= 0; --i)
          for (int j = p.degree - i; j >= 0; --j) {
            const int l = p.degree - i - j;
            const auto& c = p.corners;
            const auto on = [&](int n, std::size_t corner) { return n == 0 || c[corner].x == seam; };
            if (on(i, 0) && on(j, 1) && on(l, 2))
              ordinates[side].push_back(p.ordinates[static_cast<std::size_t>(ordinate_index(p.degree, i, j))]);
          }
      }
      std::sort(ordinates[side].begin(), ordinates[side].end());
    }
    ASSERT_GE(ordinates[0].size(), 4U);
    EXPECT_EQ(ordinates[0], ordinates[1]);
    ++compared;
  }
  EXPECT_GT(compared, 8U);
}

/// Squares of the errors at all cells and on seams, from one model of the grid on the same triangulation.
TEST(Tiles, FittedOnesAreAsGoodAsOneFitOfTheWhole) {
  for (const SurfaceKind surface : {SurfaceKind::linear, SurfaceKind::clough_tocher, SurfaceKind::powell_sabin}) {
    const Made plain(false, surface, 4), made(false, surface, 4, true);
    make_tiles(plain.plan, plain.tiles, 2, false);
    make_tiles(made.plan, made.tiles, 2, false);
    const Raster raster = read_raster(made.dem);
    const auto start = std::get<Terrain>(load_model(plain.tiles)), tiled = std::get<Terrain>(load_model(made.tiles));
    const Terrain whole = fit_least_squares(start, raster);
    const double before = assess(start, raster).rmse, best = assess(whole, raster).rmse,
                 got = assess(tiled, raster).rmse;
    EXPECT_LT(best, 0.8 * before) << "not degenerate";
    EXPECT_LT(got, best + 0.02 * (before - best)) << surface_name(surface);
    double largest = 0;  // of the data: how far the strips' cut is felt
    for (std::size_t v = 0; v < whole.tin.vertex_count(); ++v)
      largest = std::max(largest, std::abs(whole.tin.heights[v] - tiled.tin.heights[v]));
    EXPECT_LT(largest, 0.5 * before) << surface_name(surface);
    EXPECT_GT(largest, 0) << "the strips are not the whole";
  }
}

TEST(Tiles, ABudgetIsSpentAndNotPassed) {
  for (const bool voids : {false, true}) {
    const Made made(voids);
    const std::size_t valid = valid_mask(hills(131, 98, voids)).count();
    for (const auto& [vertices, ratio] : {std::pair<std::size_t, double>{400, 0}, {3000, 0}, {0, 0.1}}) {
      TileOptions options;
      options.size = 40;
      options.vertices = vertices;
      options.ratio = ratio;
      const TilePlan plan = plan_tiles(made.dem, options);
      const std::string name = std::to_string(vertices), two = (made.folder.path() / (name + "b")).string();
      const TiledIndex index = make_tiles(plan, (made.folder.path() / name).string(), 1, false);
      const auto whole = std::get<Terrain>(load_model((made.folder.path() / name).string()));
      const std::size_t budget =
          vertices > 0 ? vertices : static_cast<std::size_t>(std::llround(ratio * static_cast<double>(valid)));
      EXPECT_EQ(index.budget, budget);
      EXPECT_LE(whole.tin.vertex_count(), budget);
      EXPECT_GE(whole.tin.vertex_count(), budget * 95 / 100) << "voids " << voids;
      make_tiles(plan, two, 3, false);
      EXPECT_EQ(contents(two), contents((made.folder.path() / name).string()));
      EXPECT_NO_THROW(make_tiles(plan, two, 2, false)) << "nothing is left to do";
      options.vertices = options.vertices == 0 ? 0 : options.vertices + 1;
      if (options.vertices != 0) {
        EXPECT_THROW(make_tiles(plan_tiles(made.dem, options), two, 2, false), CannotWrite);
      }
      fs::remove_all(two);
      fs::remove_all(made.folder.path() / name);
    }
    TileOptions tiny;
    tiny.size = 40;
    tiny.vertices = 10;
    EXPECT_THROW(make_tiles(plan_tiles(made.dem, tiny), made.tiles, 1, false), UsageError);
    TileOptions all;
    all.size = 40;
    all.ratio = 1;
    make_tiles(plan_tiles(made.dem, all), made.tiles, 2, false);
    EXPECT_LE(std::get<Terrain>(load_model(made.tiles)).tin.vertex_count(), valid);
  }
}

TEST(Tiles, ContoursCrossSeams) {
  const Made made(false);
  make_tiles(made.plan, made.tiles, 2, false);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const ContourSet set = trace_contours(whole, {-40, 0, 40}, {.tolerance = 0.5});
  std::size_t ends = 0;
  for (const ContourLine& line : set.lines) {
    if (line.closed) continue;
    for (const Vec2 p : {set.points[line.begin], set.points[line.end - 1]}) {
      const double right = 130 * 7.3, bottom = -97 * 9.1;
      EXPECT_LT(std::min({std::abs(p.x), std::abs(p.x - right), std::abs(p.y), std::abs(p.y - bottom)}), 1e-6)
          << "a line ends inside, at " << p.x << ", " << p.y;
      ++ends;
    }
  }
  EXPECT_GT(ends, 10U);
}

TEST(Tiles, AreTheSameBytesWhoeverMakesThem) {
  for (const SurfaceKind surface : {SurfaceKind::clough_tocher, SurfaceKind::powell_sabin})
    for (const bool fitted : {false, true}) {
      const Made made(true, surface, 1.5, fitted);
      make_tiles(made.plan, made.tiles, 1, false, {.threads = 1});
      const auto expected = contents(made.tiles);
      ASSERT_EQ(expected.size(), 13U) << "twelve tiles and the index";
      for (const int jobs : {1, 2, 5}) {
        const std::string other = (made.folder.path() / std::to_string(jobs)).string();
        make_tiles(made.plan, other, jobs, false);
        EXPECT_EQ(contents(other), expected) << jobs << " jobs";
      }
    }
}

TEST(Tiles, ARunGoesOnWhereItWas) {
  const Made made(true);
  make_tiles(made.plan, made.tiles, 2, false);
  const auto expected = contents(made.tiles);
  std::size_t k = 0;
  std::map<std::string, fs::file_time_type> kept;
  for (const auto& [name, bytes] : expected) {
    const fs::path path = fs::path(made.tiles) / name;
    if (k % 3 == 0)
      fs::remove(path);
    else if (k % 3 == 1 && name != "index.json")
      fs::resize_file(path, bytes.size() / 2);  // torn by something else
    else
      kept[name] = fs::last_write_time(path);
    ++k;
  }
  EXPECT_THROW(load_model(made.tiles), CannotRead);
  make_tiles(made.plan, made.tiles, 2, true);
  EXPECT_EQ(contents(made.tiles), expected);
  for (const auto& [name, time] : kept)
    if (name != "index.json") {
      EXPECT_EQ(fs::last_write_time(fs::path(made.tiles) / name), time) << name << " was made again";
    }
  EXPECT_GT(kept.size(), 2U);
  EXPECT_NO_THROW(make_tiles(made.plan, made.tiles, 2, false)) << "nothing is left to do";
  EXPECT_EQ(contents(made.tiles), expected);
  EXPECT_THROW(make_tiles(plan_tiles(made.dem, {.size = 40, .max_error = 2}), made.tiles, 2, false), CannotWrite);
  EXPECT_EQ(contents(made.tiles), expected) << "refused before any work";
}

TEST(Tiles, AnInterruptedRunLeavesWholeFilesOnly) {
  const Made made(false);
  std::atomic<bool> cancel{false};
  Context context;
  context.threads = 1;
  context.cancel = &cancel;
  context.progress = [&](std::string_view stage, double fraction) {
    if (stage == "surface" && fraction > 0.4) cancel = true;
  };
  EXPECT_THROW(make_tiles(made.plan, made.tiles, 1, false, context), Interrupted);
  EXPECT_FALSE(is_tiled_model(made.tiles));
  std::size_t tiles = 0;
  for (const auto& [name, bytes] : contents(made.tiles)) {
    EXPECT_NO_THROW(decode_model(bytes, name));
    tiles += name.starts_with("tile-") ? 1 : 0;
  }
  EXPECT_GT(tiles, 2U);
  EXPECT_LT(tiles, 12U);
  make_tiles(made.plan, made.tiles, 1, false);
  const std::string other = (made.folder.path() / "other").string();
  make_tiles(made.plan, other, 1, false);
  EXPECT_EQ(contents(made.tiles), contents(other));
}

TEST(Tiles, OtherHeightsHaveOtherNames) {
  const Made made(false);
  const std::string before = tin_name(made.plan, 1, 1), far = tin_name(made.plan, 0, 3);
  Raster changed = hills(131, 98, false);
  std::get<std::vector<double>>(changed.heights)[changed.index(60, 60)] += 1;
  write_raster(changed, made.dem, {.overwrite = true});
  EXPECT_NE(tin_name(made.plan, 1, 1), before);
  EXPECT_EQ(tin_name(made.plan, 0, 3), far);
  const TilePlan finer = plan_tiles(made.dem, {.size = 40, .max_error = 1});
  EXPECT_NE(tin_name(finer, 0, 3), far);
}

TEST(Tiles, DamageIsSeen) {
  const Made made(false);
  const TiledIndex index = make_tiles(made.plan, made.tiles, 2, false);
  const std::string first = (fs::path(made.tiles) / index.tiles[0].file).string();
  const std::string second = (fs::path(made.tiles) / index.tiles[1].file).string();
  const std::string bytes = read_file(first);
  write_file(first, read_file(second), true);  // whole, and not the one
  EXPECT_THROW(load_model(made.tiles), CannotRead);
  fs::remove(first);
  EXPECT_THROW(load_model(made.tiles), CannotRead);
  write_file(first, bytes, true);
  EXPECT_NO_THROW(load_model(made.tiles));
  const std::string json = read_file((fs::path(made.tiles) / "index.json").string());
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"retalho-tiles", "tiles"},
                                                        {"\"version\": 1", "\"version\": 2"},
                                                        {"\"tile_size\": 40", "\"tile_size\": 0"},
                                                        {"\"tile_size\": 40", "\"tile_size\": 41"},
                                                        {"\"columns\": 131", "\"columns\": -1"},
                                                        {"\"file\": \"tile", "\"file\": \"../tile"},
                                                        {"\"vertices\"", "\"corners\""}}) {
    std::string wrong = json;
    const std::size_t at = wrong.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    wrong.replace(at, from.size(), to);
    write_file((fs::path(made.tiles) / "index.json").string(), wrong, true);
    EXPECT_THROW(read_tiled_index(made.tiles), CannotRead) << to;
  }
  for (const std::size_t size : {std::size_t{0}, json.size() / 3, json.size() - 3}) {
    write_file((fs::path(made.tiles) / "index.json").string(), json.substr(0, size), true);
    EXPECT_THROW(read_tiled_index(made.tiles), CannotRead) << size;
  }
}

TEST(Tiles, WhatIsRefused) {
  const Made made(false);
  EXPECT_THROW(plan_tiles(made.dem, {.size = 15, .max_error = 1}), UsageError);
  EXPECT_THROW(plan_tiles(made.dem, {.size = 40, .max_error = -1}), UsageError);
  EXPECT_THROW(plan_tiles(made.dem, {.size = 40, .max_error = 1, .vertices = 100}), UsageError);
  EXPECT_THROW(plan_tiles(made.dem, {.size = 40, .ratio = 1.5}), UsageError);
  EXPECT_THROW(plan_tiles(made.dem + "x", {.size = 40, .max_error = 1}), CannotRead);
  EXPECT_THROW(make_tiles(made.plan, made.tiles, -1, false), UsageError);
  EXPECT_THROW(make_tiles(made.plan, made.dem + "/below", 1, false), CannotWrite);
}

TEST(Tiles, WithoutDataAreEmpty) {
  test::ScratchFolder folder;
  Raster raster = hills(131, 98, false);
  auto& heights = std::get<std::vector<double>>(raster.heights);
  for (int r = 0; r < 98; ++r)
    for (int c = 0; c < 131; ++c)
      if (c > 40 && c < 100) heights[raster.index(c, r)] = std::numeric_limits<double>::quiet_NaN();
  const std::string dem = (folder.path() / "dem.tif").string(), tiles = (folder.path() / "tiles").string();
  write_raster(raster, dem);
  const TiledIndex index = make_tiles(plan_tiles(dem, {.size = 40, .max_error = 1}), tiles, 2, false);
  std::size_t empty = 0;
  for (const TileEntry& tile : index.tiles) empty += tile.file.empty() ? 1 : 0;
  EXPECT_EQ(empty, 3U) << "columns 40 to 80: only the seam has data";
  const auto whole = std::get<Terrain>(load_model(tiles));
  EXPECT_EQ(assess(whole, raster).uncovered, 0U);
  EXPECT_FALSE(whole.grid.has_data({60 * 7.3, -50 * 9.1}));
}

TEST(Windows, ArePartsOfTheWhole) {
  test::ScratchFolder folder;
  const std::string dem = (folder.path() / "dem.tif").string();
  write_raster(hills(131, 98, true), dem);
  const Raster whole = read_raster(dem);
  const Raster place = inspect_raster(dem);
  EXPECT_EQ(place.columns, whole.columns);
  EXPECT_EQ(place.georef.origin_x, whole.georef.origin_x);
  test::Random random;
  for (int k = 0; k < 40; ++k) {
    CellWindow w;
    w.column = static_cast<int>(random.uniform(0, 130));
    w.row = static_cast<int>(random.uniform(0, 97));
    w.columns = static_cast<int>(random.uniform(1, 131 - w.column + 0.99));
    w.rows = static_cast<int>(random.uniform(1, 98 - w.row + 0.99));
    const Raster part = read_raster(dem, {.window = w});
    ASSERT_EQ(part.columns, w.columns);
    ASSERT_EQ(part.rows, w.rows);
    EXPECT_NEAR(part.georef.origin_x, whole.georef.to_crs(whole.centre(w.column, w.row)).x, 1e-6);
    EXPECT_NEAR(part.georef.origin_y, whole.georef.to_crs(whole.centre(w.column, w.row)).y, 1e-6);
    for (int r = 0; r < w.rows; ++r)
      for (int c = 0; c < w.columns; ++c) {
        const double a = part.at(c, r), b = whole.at(w.column + c, w.row + r);
        ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << c << ", " << r;
      }
  }
  EXPECT_THROW(read_raster(dem, {.window = CellWindow{0, 0, 132, 5}}), UsageError);
  EXPECT_THROW(read_raster(dem, {.window = CellWindow{-1, 0, 5, 5}}), UsageError);
  EXPECT_THROW(read_raster(dem, {.window = CellWindow{5, 5, 0, 5}}), UsageError);
}

TEST(Tiles, CallsThatDoNotFitTheirPlanAreNamed) {
  const Made made(false);
  test::expect_refused<UsageError>({
      {"1 looks at tiles, where the grid has 12",
       [&] { settle(made.plan, std::vector<TileLook>(1), [](double) { return std::size_t{0}; }); }},
      {"0 tiles are made, where the grid has 12", [&] { finish_tiles(made.plan, {}, {}, made.tiles, false); }},
  });
}

TEST(Tiles, TilesThatAreNotTheirNeighboursAreNamed) {
  // The second tile's file is another one than the index was made for, with its checksum put right.
  const Made made(false, SurfaceKind::powell_sabin);
  const TiledIndex index = make_tiles(made.plan, made.tiles, 2, false);
  const auto with = [&](const std::function<void(Terrain&)>& change) {
    TiledIndex changed = index;
    TileEntry& entry = changed.tiles[1];
    Terrain tile = load_tile(index, entry, made.tiles);
    change(tile);
    entry.file = "changed.retalho";
    save_model(tile, made.tiles + "/changed.retalho", true);
    entry.checksum = content_digest(read_file(made.tiles + "/changed.retalho"));
    write_tiled_index(changed, made.tiles, true);
    load_tiled_model(made.tiles);
  };
  const auto raised = [](Terrain& tile) {
    for (double& z : tile.tin.heights) z += 1;
  };
  const auto split = [](Terrain& tile) {
    for (double& s : tile.edge_split) s = 0.5 + 0.5 * (s - 0.5);
  };
  test::expect_refused<CannotRead>({
      {"and its neighbour differ at their common cell (", [&] { with(raised); }},
      {"and its neighbour split an edge of their seam in two ways: make the tiled model again", [&] { with(split); }},
      {"changed.retalho' holds another surface than index.json says",
       [&] { with([](Terrain& tile) { tile = test::sample_terrain({.kind = SurfaceKind::powell_sabin}); }); }},
  });
  TiledIndex empty = index;
  for (TileEntry& entry : empty.tiles) entry.file.clear();
  write_tiled_index(empty, made.tiles, true);
  test::expect_refused<CannotRead>({{"' holds any data", [&] { load_tiled_model(made.tiles); }},
                                    {"no tile of '", [&] { load_tiled_model(made.tiles); }}});
  test::expect_refused<BadInput>(
      {{"lies where it was asked for", [&] { load_tiled_part(made.tiles, [](const TileEntry&) { return false; }); }}});
}

}  // namespace
}  // namespace retalho
