// retalho viewshed from the command line.
#include <gtest/gtest.h>

#include "program.h"
#include "retalho/raster/io.h"

namespace retalho::test {
namespace {

/// A plain with a wall at column 20; cells 10 wide from (1000, 2000).
struct Wall : ScratchFolder {
  Wall() {
    put("dem.asc", ascii_grid(40, 30, [](int c, int) { return c == 20 ? 50.0 : 0.0; }));
  }
};

TEST(Viewshed, AWallHidesWhatIsBehindIt) {
  const Wall folder;
  const Outcome outcome = run(folder, "viewshed dem.asc -o v.tif --observer 1105,2155,2 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["observers"], 1);
  EXPECT_EQ(outcome.json()["cells"], 1200);
  EXPECT_EQ(outcome.json()["visible_cells"], 21 * 30);
  const Raster v = read_raster(folder / "v.tif");
  EXPECT_EQ(v.at(5, 5), 1);
  EXPECT_EQ(v.at(20, 5), 1);
  EXPECT_EQ(v.at(30, 5), 0);
  EXPECT_EQ(v.georef.origin_x, 1005);
}

TEST(Viewshed, CountsObserversAndTellsNeededHeights) {
  const Wall folder;
  ASSERT_EQ(run(folder, "viewshed dem.asc -o c.tif --what count --observer 1105,2155,2 --observer 1355,2155,2").code,
            0);
  const Raster count = read_raster(folder / "c.tif");
  EXPECT_EQ(count.at(5, 5), 1);
  EXPECT_EQ(count.at(20, 5), 2);
  EXPECT_EQ(count.at(30, 5), 1);
  ASSERT_EQ(run(folder, "viewshed dem.asc -o h.tif --what height --observer 1105,2155,2").code, 0);
  // From (10, height 2) over the wall (20, height 50) the line is at 2 + 48 * 20 / 10 at column 30.
  EXPECT_NEAR(read_raster(folder / "h.tif").at(30, 14), 98, 1e-4);
}

TEST(Viewshed, SightLineAsJson) {
  const Wall folder;
  const Outcome outcome =
      run(folder, "viewshed dem.asc --observer 1105,2155,2 --to 1305,2155 --frequency 2.4e9 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_FALSE(outcome.json()["visible"].get<bool>());
  EXPECT_NEAR(outcome.json()["distance"].get<double>(), 200, 1e-9);
  EXPECT_NEAR(outcome.json()["blocked_at"].get<double>(), 90, 10);
  EXPECT_EQ(outcome.json()["profile"].size(), 21U);
  EXPECT_TRUE(
      run(folder, "viewshed dem.asc --observer 1105,2155,2 --to 1185,2155 --json").json()["visible"].get<bool>());
}

TEST(Viewshed, IntervisibilityMapAndModels) {
  const Wall folder;
  const Outcome outcome = run(folder, "viewshed dem.asc -o i.tif --intervisibility --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Raster map = read_raster(folder / "i.tif");
  EXPECT_NEAR(map.at(5, 15), 21 * 30, 25);
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 0 --surface linear").code, 0);
  EXPECT_EQ(run(folder, "viewshed m.retalho -o w.tif --observer 1105,2155,2 --json").json()["visible_cells"], 21 * 30);
}

TEST(Viewshed, ExactAsksTheSurfaceOfAModel) {
  const Wall folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 0 --surface linear").code, 0);
  const Outcome outcome = run(folder, "viewshed m.retalho --exact -o w.tif --observer 1105,2155,2 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(outcome.json()["exact"].get<bool>());
  EXPECT_EQ(outcome.json()["visible_cells"], 21 * 30);
  EXPECT_EQ(read_raster(folder / "w.tif").at(30, 5), 0);
  ASSERT_EQ(run(folder, "viewshed m.retalho --exact -o h.tif --what height --observer 1105,2155,2").code, 0);
  EXPECT_NEAR(read_raster(folder / "h.tif").at(30, 14), 98, 1e-3);
  const Outcome line = run(folder, "viewshed m.retalho --exact --observer 1105,2155,2 --to 1305,2155 --json");
  ASSERT_EQ(line.code, 0) << line.err;
  // Level at 2 to 0: it meets the wall's foot, which rises 5 a unit from 90 on.
  EXPECT_NEAR(line.json()["blocked_at"].get<double>(), 90.22, 0.05);
  EXPECT_EQ(run(folder, "viewshed dem.asc --exact -o x.tif --observer 1105,2155,2").code, 2);
  EXPECT_EQ(run(folder, "viewshed m.retalho --exact -o x.tif --observer 5,5,2").code, 3);
  EXPECT_EQ(run(folder, "viewshed m.retalho --exact --intervisibility -o x.tif").code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.tif"));
}

TEST(Viewshed, ASightLineCanBeDrawn) {
  const Wall folder;
  for (const char* name : {"line.svg", "line.png", "line.pdf"})
    ASSERT_EQ(
        run(folder, std::string("viewshed dem.asc --observer 1105,2155,2 --to 1305,2155 --frequency 1e9 -o ") + name)
            .code,
        0);
  const std::string svg = bytes_of(folder / "line.svg");
  EXPECT_NE(svg.find("blocked at"), std::string::npos);
  EXPECT_NE(svg.find("Fresnel"), std::string::npos);
  EXPECT_EQ(run(folder, "viewshed dem.asc --observer 1105,2155,2 --to 1305,2155 -o line.xyz").code, 2);
  EXPECT_EQ(run(folder, "viewshed dem.asc --observer 1105,2155,2 --to 1105,2155 -o none.svg").code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.svg"));
}

TEST(Viewshed, StrideCountsExactlyFromFewerCells) {
  const Wall folder;
  const Outcome outcome = run(folder, "viewshed dem.asc -o s.tif --intervisibility --stride 5 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.json()["valid_cells"], 8 * 6);
  const Raster map = read_raster(folder / "s.tif");
  EXPECT_EQ(map.columns, 8);
  EXPECT_EQ(map.rows, 6);
  EXPECT_EQ(map.cell_width, 50);
  EXPECT_EQ(map.georef.origin_x, 1025);  // the middle of the first five
  EXPECT_EQ(map.at(0, 0), 21 * 30);
  EXPECT_EQ(map.at(7, 5), 20 * 30);
  EXPECT_EQ(run(folder, "viewshed dem.asc -o t.tif --intervisibility --stride 31").code, 2);
  EXPECT_EQ(run(folder, "viewshed dem.asc -o t.tif --stride 3 --observer 1105,2155").code, 2);
}

TEST(Viewshed, CompareTellsHowFarTheMapsAreAndDrawsThem) {
  const Wall folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 0 --surface linear").code, 0);
  const auto same = run(folder, "compare dem.asc m.retalho --visibility 100 --json").json()["models"][0];
  EXPECT_EQ(same["visibility_cells"], 1200);
  EXPECT_NEAR(same["visibility_rmse"].get<double>(), 0, 1e-3);  // the model is the grid
  const Outcome kinds =
      run(folder, "compare dem.asc --vertices 6 --visibility 0 --visibility-maps pictures --directions 36 --json");
  ASSERT_EQ(kinds.code, 0) << kinds.err;
  const auto json = kinds.json();  // it must outlive the loop
  for (const auto& model : json["models"]) {
    EXPECT_LE(model["visibility_rmse"].get<double>(), model["visibility_max"].get<double>());
    EXPECT_GT(model["visibility_max"].get<double>(), 1);  // six vertices do not make a wall
    EXPECT_LE(model["visibility_max"].get<double>(), 1250);
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures/linear.png"));
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures/powell-sabin-normals.png"));
  EXPECT_EQ(run(folder, "compare dem.asc --vertices 6 --visibility-maps p").code, 2);
  EXPECT_EQ(run(folder, "compare dem.asc --vertices 6 --visibility -3").code, 2);
}

TEST(Viewshed, RefusesWhatMakesNoSense) {
  const Wall folder;
  EXPECT_EQ(run(folder, "viewshed dem.asc -o v.tif").code, 2);
  EXPECT_EQ(run(folder, "viewshed dem.asc -o v.tif --observer 1,1").code, 3);
  EXPECT_EQ(run(folder, "viewshed dem.asc -o v.tif --observer 1105").code, 2);
  EXPECT_EQ(run(folder, "viewshed dem.asc --observer 1105,2155").code, 2);
  EXPECT_EQ(run(folder, "viewshed dem.asc -o v.tif --observer 1105,2155 --intervisibility").code, 2);
  EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace retalho::test
