// `fit --creases`: chosen for a grid, and along the lines of a file.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "program.h"

namespace retalho::test {
namespace {

/// Two planes that meet along x = 1395, cells of 10.
double roof(int column) {
  return 100 - std::abs(column - 39) * (column < 39 ? 4.0 : 1.5);
}

TEST(Creases, AlongTheLinesOfAFile) {
  const ScratchFolder folder;
  folder.put("roof.asc", ascii_grid(80, 60, [](int c, int) { return roof(c); }));
  folder.put("ridge.geojson", R"({"type":"LineString","coordinates":[[1395,1950],[1395,2900]]})");
  const Outcome folded = run(folder, "fit roof.asc -o m.retalho --vertices 60 --creases ridge.geojson --json");
  ASSERT_EQ(folded.code, 0) << folded.err;
  EXPECT_NE(folded.err.find("1 lines inside the grid"), std::string::npos) << folded.err;
  const Outcome smooth = run(folder, "fit roof.asc -o s.retalho --vertices 60 --json");
  EXPECT_LT(folded.json()["max_error"].get<double>(), 1e-3);
  EXPECT_GT(smooth.json()["max_error"].get<double>(), 0.1);
  EXPECT_GT(folded.json()["creases"], 5);
  EXPECT_EQ(smooth.json()["creases"], 0);
  EXPECT_GT(folded.json()["numbers"].get<int>(), 5 * folded.json()["vertices"].get<int>());
  for (const char* next :
       {"sample m.retalho -o z.tif --like roof.asc", "contour m.retalho -o l.gpkg --interval 5",
        "mesh m.retalho -o m.ply", "viewshed m.retalho -o v.tif --observer 1395,2300,2", "info m.retalho"})
    EXPECT_EQ(run(folder, next).code, 0) << next;
}

TEST(Creases, ChosenInPlaceOfVertices) {
  const ScratchFolder folder;
  // Hipped roofs in rows, askew to the grid.
  const auto from_middle = [](double along) { return std::abs(along - 40 * std::floor(along / 40) - 20); };
  folder.put("town.asc", ascii_grid(96, 80, [&](int c, int r) {
               return 100 + std::max(0.0, 12 - 0.8 * std::max(from_middle(c + 0.2 * r), from_middle(r - 0.2 * c)));
             }));
  const Outcome without = run(folder, "fit town.asc -o a.retalho --vertices 200 --json");
  const Outcome with = run(folder, "fit town.asc -o b.retalho --vertices 200 --creases auto --json");
  ASSERT_EQ(with.code, 0) << with.err;
  EXPECT_GT(with.json()["creases"], 0);
  EXPECT_LE(with.json()["numbers"], without.json()["numbers"]);
  EXPECT_LT(with.json()["rmse"], without.json()["rmse"]);
  const Outcome none = run(folder, "fit town.asc -o c.retalho --vertices 200 --creases none");
  EXPECT_EQ(none.code, 0) << none.err;
  EXPECT_EQ(bytes_of(folder / "a.retalho"), bytes_of(folder / "c.retalho"));
  EXPECT_NE(none.out.find("numbers"), std::string::npos);
}

}  // namespace
}  // namespace retalho::test
