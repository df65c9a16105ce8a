// retalho fit --tiles, and the commands that take its folder.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "cli/program.h"
#include "retalho/raster/io.h"

namespace retalho::test {
namespace {

struct Tiles : ScratchFolder {
  Tiles() { put("dem.asc", ascii_grid(90, 70, hills)); }
};

TEST(FitTiles, EveryCommandTakesTheFolder) {
  const Tiles folder;
  const Outcome made = run(folder, "fit dem.asc -o m --tiles 32 --max-error 3 --surface linear --jobs 2 --json");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(made.json()["tiles"], 9);
  EXPECT_EQ(made.json()["empty_tiles"], 0);
  EXPECT_EQ(made.json()["cells"], 6300);
  const Outcome compared = run(folder, "compare dem.asc m --json");
  ASSERT_EQ(compared.code, 0) << compared.err;
  const auto model = compared.json()["models"][0];
  EXPECT_LE(model["max_error"].get<double>(), 3.0);
  EXPECT_EQ(model["violations"], 0);
  EXPECT_EQ(model["uncovered"], 0);
  EXPECT_EQ(model["bytes"], made.json()["bytes"]);
  EXPECT_EQ(model["triangles"], made.json()["triangles"]);
  for (const char* command :
       {"info m", "sample m -o s.tif", "sample m --at 1500,2300", "contour m -o c.geojson --interval 20",
        "mesh m -o m.ply", "viewshed m -o v.tif --observer 1505,2305", "render m -o m.png"})
    EXPECT_EQ(run(folder, command).code, 0) << command;
  // Tile by tile, one at a time: the same answers.
  const Outcome streamed = run(folder, "compare dem.asc m --json --tile-memory 1");
  ASSERT_EQ(streamed.code, 0) << streamed.err;
  EXPECT_NE(streamed.err.find("tiles read one by one"), std::string::npos) << streamed.err;
  const Outcome joined = run(folder, "compare dem.asc m --json --visibility 300");  // which joins the model
  ASSERT_EQ(joined.code, 0) << joined.err;
  for (const char* key : {"surface", "vertices", "triangles", "coefficients", "numbers", "bytes", "cells",
                          "valid_cells", "uncovered", "violations"})
    EXPECT_EQ(streamed.json()["models"][0][key], joined.json()["models"][0][key]) << key;
  for (const char* key : {"rmse", "max_error"})
    EXPECT_NEAR(streamed.json()["models"][0][key].get<double>(), joined.json()["models"][0][key].get<double>(), 1e-9);
  for (const char* what : {"height", "slope", "aspect", "curvature"})
    EXPECT_EQ(run(folder, fmt::format("sample m -o {0}.tif --what {0} --resolution 7 --tile-memory 1", what)).code, 0);
  EXPECT_EQ(run(folder, "sample m -o s.asc").code, 0) << "a format that takes no rows";
  EXPECT_EQ(run(folder, "sample m -o l.tif --like s.tif").code, 0);
  EXPECT_EQ(run(folder, "sample m -o x.tif --tile-memory 0").code, 2);
  EXPECT_EQ(run(folder, "compare dem.asc m --tile-memory 0").code, 2);
  const Raster sampled = read_raster(folder / "s.tif"), dem = read_raster(folder / "dem.asc");
  const Raster like = read_raster(folder / "l.tif");
  for (std::size_t i = 0; i < dem.cells(); ++i) ASSERT_EQ(sampled.at(i), like.at(i));
  for (std::size_t i = 0; i < dem.cells(); ++i) ASSERT_NEAR(sampled.at(i), dem.at(i), 3.001);
}

TEST(FitTiles, LinesAndMeshesAreTheSameBytesFromAnyNumberOfThreadsAndAnyBound) {
  const Tiles folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m --tiles 32 --max-error 3 -q").code, 0);
  for (const char* command : {"contour m -o {}.shp --interval 20 --json", "mesh m -o {}.ply --tolerance 1 --json"}) {
    const bool lines = std::string(command).starts_with("contour");
    std::string expected;
    nlohmann::json said;
    for (const char* how : {"--threads 1", "--threads 2", "--threads 7", "--threads 7 --tile-memory 1"}) {
      const Outcome made = run(folder, fmt::format(fmt::runtime(command), "out") + " --overwrite " + how);
      ASSERT_EQ(made.code, 0) << made.err;
      const std::string bytes = slurp(folder / (lines ? "out.shp" : "out.ply"));
      if (expected.empty()) {
        expected = bytes;
        said = made.json();
      }
      EXPECT_TRUE(bytes == expected) << how;
      EXPECT_EQ(made.json()[lines ? "lines" : "triangles"], said[lines ? "lines" : "triangles"]);
    }
    EXPECT_GT(said[lines ? "lines" : "triangles"].get<int>(), 10);
  }
  EXPECT_EQ(run(folder, "contour m -o l.gpkg --interval 20 --tile-memory 0").code, 2);
  EXPECT_EQ(run(folder, "mesh m -o l.ply --tile-memory 0").code, 2);
  EXPECT_EQ(run(folder, "viewshed m -o l.tif --observer 1505,2305 --tile-memory 0").code, 2);
  EXPECT_EQ(run(folder, "contour m -o l.gpkg --interval 20 --surface linear").code, 2);
  // Bands hold the lines, and sheets join the model.
  for (const char* options : {"-o b.gpkg --bands", "-o m.svg", "-o m.pdf --bands --curves"})
    EXPECT_EQ(run(folder, std::string("contour m --interval 20 ") + options).code, 0) << options;
  EXPECT_EQ(run(folder, "contour m -o c.json --interval 20 --conics").code, 3) << "not a Powell-Sabin model";
}

TEST(FitTiles, ViewshedsReadTheTilesThatTheyNeed) {
  const Tiles folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m --tiles 32 --max-error 3 -q").code, 0);
  const auto reads = [](const Outcome& outcome) {
    const std::size_t at = outcome.err.find(" of 9 tiles read");
    return at == std::string::npos ? -1 : outcome.err[at - 1] - '0';
  };
  // A sight line over cells, and over the surface itself.
  for (const char* exact : {"", " --exact"}) {
    const std::string line = "viewshed m --observer 1055,2605 --to 1255,2505 --json" + std::string(exact);
    const Outcome seen = run(folder, line);
    ASSERT_EQ(seen.code, 0) << seen.err;
    EXPECT_GE(reads(seen), 1) << seen.err;
    EXPECT_LE(reads(seen), 4) << seen.err;
    const double distance = seen.json()["distance"];
    EXPECT_NEAR(distance, std::hypot(200, 100), 1e-6);
  }
  // A map within a radius is that part of the whole map.
  ASSERT_EQ(run(folder, "viewshed m -o all.tif --observer 1205,2405").code, 0);
  const Raster all = read_raster(folder / "all.tif");
  EXPECT_EQ(all.columns, 90);
  for (const char* exact : {"", " --exact"}) {
    const Outcome part =
        run(folder, "viewshed m -o part.tif --overwrite --observer 1205,2405 --radius 90 --json" + std::string(exact));
    ASSERT_EQ(part.code, 0) << part.err;
    EXPECT_GE(reads(part), 1) << part.err;
    EXPECT_LE(reads(part), 4) << part.err;
    const Raster some = read_raster(folder / "part.tif");
    EXPECT_LT(some.cells(), all.cells());
    std::size_t within = 0, differing = 0;
    for (int r = 0; r < some.rows; ++r)
      for (int c = 0; c < some.columns; ++c) {
        const Vec2 crs = some.georef.to_crs(some.centre(c, r));
        const Vec2 local = all.georef.to_local(crs);
        const auto column = static_cast<int>(std::lround(local.x / 10)),
                   row = static_cast<int>(std::lround(-local.y / 10));
        if (std::hypot(crs.x - 1205, crs.y - 2405) > 90) {
          EXPECT_EQ(some.at(c, r), 0) << "beyond the radius";
          continue;
        }
        ++within;
        differing += some.at(c, r) == all.at(column, row) ? 0 : 1;
      }
    EXPECT_GT(within, 200U);
    EXPECT_LE(differing, *exact == 0 ? 2U : within / 10) << "cells and surface are two things";
  }
  EXPECT_EQ(run(folder, "viewshed m -o x.tif --observer 5,5").code, 3) << "outside";
  EXPECT_EQ(run(folder, "viewshed m -o x.tif --exact --observer 5,5 --radius 10").code, 3);
}

TEST(FitTiles, BudgetsSurfacesAndFits) {
  const Tiles folder;
  for (const char* surface : {"linear", "powell-sabin", "clough-tocher"})
    for (const char* fit : {"interpolate", "least-squares"}) {
      const Outcome made = run(folder, fmt::format("fit dem.asc -o m --tiles 32 --vertices 400 --surface {} --fit {} "
                                                   "--overwrite --json",
                                                   surface, fit));
      ASSERT_EQ(made.code, 0) << made.err;
      EXPECT_EQ(made.json()["budget"], 400);
      EXPECT_EQ(made.json()["fit"], fit);
      const Outcome compared = run(folder, "compare dem.asc m --json");
      ASSERT_EQ(compared.code, 0) << compared.err;
      const auto model = compared.json()["models"][0];
      EXPECT_LE(model["vertices"].get<int>(), 400);
      EXPECT_GE(model["vertices"].get<int>(), 380);
      EXPECT_EQ(model["surface"], surface);
      EXPECT_LT(model["rmse"].get<double>(), 5);
    }
  const Outcome ratio = run(folder, "fit dem.asc -o r --tiles 32 --ratio 5% --json");
  ASSERT_EQ(ratio.code, 0) << ratio.err;
  EXPECT_EQ(ratio.json()["budget"], 315);
}

TEST(Sample, CloudOptimisedGeoTiff) {
  const Tiles folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m --tiles 32 --max-error 3 -q").code, 0);
  ASSERT_EQ(run(folder, "sample m -o plain.tif --resolution 1").code, 0);
  ASSERT_EQ(run(folder, "sample m -o cloud.tif --resolution 1 --cog").code, 0);
  const std::string command = fmt::format("gdalinfo '{}' >'{}'", folder / "cloud.tif", folder / "info");
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::string info = slurp(folder / "info");
  EXPECT_NE(info.find("LAYOUT=COG"), std::string::npos) << info;
  EXPECT_NE(info.find("Overviews:"), std::string::npos) << info;
  const Raster plain = read_raster(folder / "plain.tif"), cloud = read_raster(folder / "cloud.tif");
  ASSERT_EQ(plain.cells(), cloud.cells());
  std::size_t valid = 0;
  for (std::size_t i = 0; i < plain.cells(); ++i) {
    const double a = plain.at(i), b = cloud.at(i);
    ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << i;
    valid += std::isnan(a) ? 0 : 1;
  }
  EXPECT_GT(valid, 500000U);
  EXPECT_EQ(run(folder, "sample m -o cloud.asc --resolution 1 --cog").code, 2);
  EXPECT_EQ(run(folder, "sample m --at 1500,2300 --cog").code, 2);
}

TEST(FitTiles, RunAgainItHasNothingToDo) {
  const Tiles folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m --tiles 32 --max-error 3 -q").code, 0);
  const std::string index = slurp(folder / "m/index.json");
  EXPECT_EQ(run(folder, "fit dem.asc -o m --tiles 32 --max-error 3 -q").code, 0);
  EXPECT_EQ(slurp(folder / "m/index.json"), index);
  const Outcome other = run(folder, "fit dem.asc -o m --tiles 32 --max-error 2 -q");
  EXPECT_EQ(other.code, 5);
  EXPECT_NE(other.err.find("--overwrite"), std::string::npos) << other.err;
  EXPECT_EQ(slurp(folder / "m/index.json"), index);
  EXPECT_EQ(run(folder, "fit dem.asc -o m --tiles 32 --max-error 2 -q --overwrite").code, 0);
  EXPECT_NE(slurp(folder / "m/index.json"), index);
}

TEST(FitTiles, WhatIsRefused) {
  const Tiles folder;
  folder.put("points.xyz", "0 0 1\n1 0 2\n0 1 3\n");
  folder.put("file", "x");
  folder.put("grid.pgm", "P2\n3 3\n9\n1 2 3 4 5 6 7 8 9\n");
  for (const char* options :
       {"--tiles 32", "--tiles 32 --vertices 5", "--tiles 32 --max-error 1 --ratio 1%", "--tiles 3 --max-error 1",
        "--tiles 32 --max-error 1 --gradients network", "--tiles 32 --max-error 1 --fit z-only",
        "--tiles 32 --vertices 0", "--tiles 32 --max-error 1 --refine surface", "--jobs 2 --max-error 1",
        "--tiles 32 --max-error 1 --jobs -1"})
    EXPECT_EQ(run(folder, std::string("fit dem.asc -o m ") + options).code, 2) << options;
  EXPECT_EQ(run(folder, "fit points.xyz -o m --tiles 32 --max-error 1").code, 2);
  EXPECT_EQ(run(folder, "fit grid.pgm -o m --tiles 32 --max-error 1").code, 3);
  EXPECT_EQ(run(folder, "fit none.tif -o m --tiles 32 --max-error 1").code, 4);
  EXPECT_EQ(run(folder, "fit dem.asc -o file --tiles 32 --max-error 1").code, 5);
  EXPECT_FALSE(std::filesystem::exists(folder / "m/index.json"));
}

}  // namespace
}  // namespace retalho::test
