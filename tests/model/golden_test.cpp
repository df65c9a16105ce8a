// Files of format 1 as the first version wrote them, kept in data/. They must stay readable for ever: a change that
// breaks this test breaks users' files. New formats get files of their own; these are never written again.
// (To add one: put it into golden() and run with RETALHO_WRITE_GOLDEN=1, which writes the files that are missing.)
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "identical.h"
#include "retalho/model/model.h"
#include "support/paths.h"

namespace retalho {
namespace {

struct Golden {
  const char* name;
  Terrain terrain;
};

/// Typed in, so that it depends on nothing.
std::vector<Golden> golden() {
  Terrain t;
  t.georef = {500000.5, 5100000.25, 1, 1, "LOCAL_CS[\"golden\",UNIT[\"metre\",1]]", "metre", false};
  t.tolerance = 0.25;
  t.tin.points = {{0, 0}, {30, 0}, {60, 0}, {0, -25}, {60, -25}, {30, -50}};
  t.tin.heights = {100, 102.5, 99, 110.25, 1.0 / 3, -7};
  t.tin.triangles = {{3, 1, 0}, {1, 3, 4}, {4, 2, 1}, {5, 4, 3}};
  t.tin.neighbors = {{kNone, kNone, 1}, {3, 2, 0}, {kNone, 1, kNone}, {1, kNone, kNone}};
  std::vector<Golden> all;
  all.push_back({"format-1-linear", t});

  const std::vector<Vec2> gradients = {{0.5, -0.25}, {1.0 / 7, 3}, {0, -0.0}, {1e-9, 1e9}, {-2, 2}, {0.1, 0.2}};
  t.gradient_kind = GradientKind::quadratic;
  t.gradients = gradients;
  t.grid = {3, 3, 30, 25, Mask(3, 3, true)};
  t.grid.valid.set(1, 1, false);
  t.grid.valid.set(0, 2, false);
  t.kind = SurfaceKind::powell_sabin;
  t.edge_split = {0.5, 0.625, 0.1, 0.9, 1.0 / 3, 0.5, 0.25, 0.75, 0.5};
  all.push_back({"format-1-powell-sabin", t});

  t.edge_split.clear();
  t.grid.valid = Mask(3, 3, true);
  t.georef.geographic = true;
  t.georef.scale_x = 78000.125;
  t.kind = SurfaceKind::clough_tocher;
  t.cross_derivative = CrossDerivative::cubic;
  t.gradient_kind = GradientKind::network;
  t.edge_fallback = {0, 0, 1, 0, 0, 0, 1, 0, 0};
  all.push_back({"format-1-clough-tocher", t});
  return all;
}

TEST(GoldenModels, FilesOfFormat1AreRead) {
  for (const Golden& g : golden()) {
    const std::string path = test::source_folder() + "/tests/model/data/" + std::string(g.name) + ".retalho";
    if (std::getenv("RETALHO_WRITE_GOLDEN") && !std::filesystem::exists(path)) save_model(g.terrain, path);
    ModelFileNotes notes;
    const Model model = load_model(path, &notes);
    EXPECT_TRUE(test::identical(std::get<Terrain>(model), g.terrain)) << g.name;
    EXPECT_EQ(notes.format_major, 1);
    EXPECT_EQ(notes.created_by, "retalho 0.1.0");
    EXPECT_EQ(notes.bytes, std::filesystem::file_size(path));
  }
}

}  // namespace
}  // namespace retalho
