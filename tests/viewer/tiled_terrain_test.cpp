// A tiled model on the page without being joined (viewer/tiled_terrain.h): the surface is the joined model's wherever
// it is looked at, without cracks, finer where the eye is near, within the budget.
#include "viewer/tiled_terrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/model/model.h"
#include "retalho/tiles/make.h"
#include "support/support.h"
#include "tiles/made.h"
#include "viewer/input_files.h"
#include "viewer/level_tree.h"
#include "viewer/terrain_calls.h"

namespace retalho::viewer {
namespace {

struct Shown : test::MadeTiles {
  explicit Shown(bool voids, SurfaceKind kind = SurfaceKind::clough_tocher) : MadeTiles(voids, kind) {
    make_tiles(plan, tiles, 2, false);
    joined = std::get<Terrain>(load_model(tiles));
  }
  Terrain joined;
};

TEST(LevelTree, FansFitTogetherAndCoverTheRectangle) {
  test::Random random;
  for (int round = 0; round < 12; ++round) {
    const int columns = 1 + static_cast<int>(random.index(3)), rows = 1 + static_cast<int>(random.index(3));
    const double x = random.uniform(0, columns), y = random.uniform(0, rows);
    LevelTree tree(columns, rows);
    tree.refine(
        [&](const LevelSquare& s) {
          const double side = std::ldexp(1.0, -s.level);
          return side / std::hypot((s.i + 0.5) * side - x, (s.j + 0.5) * side - y);
        },
        0.2, 9, 3000);
    const LevelTree::Fans fans = tree.fans();
    EXPECT_GT(tree.deepest(), 6);
    EXPECT_LT(tree.leaves(), 3100U);
    TriangleMesh mesh;
    for (const auto& p : fans.places) mesh.positions.push_back({1.0 * p[0], -1.0 * p[1], 0});
    mesh.triangles = fans.triangles;
    double area = 0;
    for (const auto& t : mesh.triangles) {
      const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
      const double twice = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      EXPECT_GT(twice, 0);
      area += twice / 2;
    }
    EXPECT_EQ(area, 1.0 * columns * rows * fans.halves * fans.halves);
    const MeshCheck check = check_mesh(mesh);
    EXPECT_TRUE(check.watertight());
    EXPECT_EQ(check.components, 1U);
  }
}

TEST(TiledTerrain, IsTheJoinedSurfaceWhereverTheEyeIs) {
  for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::clough_tocher})
    for (const bool voids : {false, true}) {
      const Shown shown(voids, kind);
      const TerrainEvaluator evaluator(shown.joined);
      TiledTerrain terrain(shown.tiles, 1);
      EXPECT_EQ(terrain.reader().reads(), 12U) << "each tile once";
      for (const Vec3 eye : {Vec3{400, -400, 30}, Vec3{900, -20, 200}, Vec3{460, -440, 1e6}}) {
        DetailOptions options;
        options.eye = eye;
        options.angle = eye.z > 1000 ? 1e-9 : 1e-3;
        options.budget = 20000;
        DetailNotes notes;
        const TriangleMesh mesh = terrain.detail(options, &notes);
        EXPECT_GT(mesh.triangles.size(), 3000U);
        EXPECT_LE(mesh.triangles.size(), options.budget * 5 / 4);
        EXPECT_TRUE(check_mesh(mesh).watertight());
        std::vector<std::uint8_t> used(mesh.positions.size(), 0);
        double area = 0;
        for (const auto& t : mesh.triangles) {
          for (const std::uint32_t v : t) used[v] = 1;
          const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
          area += ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
        }
        std::size_t compared = 0;
        for (std::size_t v = 0; v < used.size(); ++v) {
          if (used[v] == 0) continue;
          const Vec3 p = mesh.positions[v];
          const std::optional<Jet> jet = evaluator.jet({p.x, p.y});
          if (!jet) continue;  // on the border of the data but for rounding
          ++compared;
          ASSERT_NEAR(p.z, jet->value, 1e-8) << p.x << ", " << p.y;
          if (kind == SurfaceKind::linear) continue;
          ASSERT_LT(norm(mesh.normals[v] - normalized(Vec3{-jet->gradient.x, -jet->gradient.y, 1})), 1e-7);
        }
        EXPECT_GT(compared, mesh.positions.size() * (voids ? 8U : 10U) / 10 - 10);
        if (!voids) {
          EXPECT_NEAR(area, 130 * 7.3 * 97 * 9.1, 1e-4 * area);
        }
        // Again, from two threads: the same.
        const TriangleMesh again = terrain.detail(options, nullptr, {.threads = 2});
        EXPECT_EQ(again.triangles, mesh.triangles);
        EXPECT_EQ(again.positions, mesh.positions);
      }
    }
}

TEST(TiledTerrain, IsFinerWhereTheEyeIsNear) {
  const Shown shown(false);
  TiledTerrain terrain(shown.tiles);
  DetailOptions options;
  options.eye = {100, -100, 100};
  options.budget = 3000;
  const TriangleMesh mesh = terrain.detail(options);
  std::size_t near = 0, far = 0;
  for (const Vec3 p : mesh.positions) {
    near += norm(Vec2{p.x - 100, p.y + 100}) < 100 ? 1 : 0;
    far += norm(Vec2{p.x - 800, p.y + 800}) < 100 ? 1 : 0;
  }
  EXPECT_GT(near, 5 * far);
  options.forward = {1, -1, 0};  // what lies behind is coarse
  const TriangleMesh ahead = terrain.detail(options);
  const auto behind = [](const TriangleMesh& m) {
    return std::count_if(m.positions.begin(), m.positions.end(), [](Vec3 p) { return p.x - p.y < 100; });
  };
  EXPECT_LT(2 * behind(ahead), behind(mesh));
}

/// The page's calls of a folder, joined or by its tiles.
CallTable calls_of(const Shown& shown, std::size_t most_joined) {
  CallTable table;
  add_terrain_calls(table, read_inputs({shown.tiles}, {}, most_joined));
  return table;
}

TEST(TiledTerrain, AnswersThePageAsTheJoinedModelDoes) {
  const Shown shown(true);
  const CallTable tiles = calls_of(shown, 10), joined = calls_of(shown, kMostJoined);
  const auto ask = [](const CallTable& table, const char* name, const Json& input) {
    return table.at(std::string("/api/terrain/") + name).run(input, {});
  };
  const Json files = ask(tiles, "files", {}).words.at("files").at(0);
  EXPECT_EQ(files.at("kind"), "model");
  EXPECT_NE(files.at("described").get<std::string>().find("131 x 98 cells in 12 tiles"), std::string::npos);
  for (const CallTable* table : {&tiles, &joined}) {
    const Answer fit = ask(*table, "fit", {{"file", 0}, {"triangles", 5000}});
    EXPECT_EQ(fit.words.at("surface"), "clough-tocher");
    EXPECT_EQ(fit.words.contains("tiles"), table == &tiles);
    for (const char* key : {"gradients", "vertices", "coefficients", "range", "origin", "detail"})
      EXPECT_TRUE(fit.words.contains(key)) << key;
  }
  const Json model{{"model", "0"}};
  const auto both = [&](const char* name, Json input) {
    input["model"] = "0";
    return std::pair{ask(tiles, name, input), ask(joined, name, input)};
  };
  // The origins differ where a corner has no data: places are asked for in the CRS.
  const auto [at, at_joined] = both("at", {{"crs_x", 500503.65}, {"crs_y", 4199504.55}});
  EXPECT_NEAR(at.words.at("z").get<double>(), at_joined.words.at("z").get<double>(), 1e-9);
  EXPECT_NEAR(at.words.at("slope").get<double>(), at_joined.words.at("slope").get<double>(), 1e-6);
  const auto [lines, lines_joined] = both("contours", {{"interval", 10}});
  EXPECT_EQ(lines.words.at("levels"), lines_joined.words.at("levels"));
  EXPECT_EQ(lines.words.at("lines"), lines_joined.words.at("lines"));
  EXPECT_EQ(lines.words.at("closed_lines"), lines_joined.words.at("closed_lines"));
  const Json profile_points = {{{"x", -200}, {"y", 100}}, {{"x", 300}, {"y", -50}}};
  const auto [profile, profile_joined] = both("profile", {{"points", profile_points}, {"count", 50}});
  EXPECT_EQ(profile.arrays.at(0).bytes.size(), profile_joined.arrays.at(0).bytes.size());
  const auto [seen, seen_joined] = both("viewshed", {{"x", 50}, {"y", 60}, {"height", 5}, {"radius", 250}});
  EXPECT_EQ(seen.words.at("visible_cells"), seen_joined.words.at("visible_cells"));
  EXPECT_NEAR(seen.words.at("ground").get<double>(), seen_joined.words.at("ground").get<double>(), 1e-9);
  EXPECT_NEAR(seen.words.at("observer").at(0).get<double>(), seen_joined.words.at("observer").at(0).get<double>(),
              1e-6);
  EXPECT_LT(seen.words.at("cells").get<double>(), seen_joined.words.at("cells").get<double>()) << "within the radius";
  EXPECT_THROW(both("save", {{"format", "retalho"}}), BadInput) << "a tiled model is not joined by the page";
}

}  // namespace
}  // namespace retalho::viewer
