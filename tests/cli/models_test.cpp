// fit, compare, sample, mesh and render from the command line: keys, codes, complete or absent outputs, the same bytes
// from any number of threads, and numbers that a slow evaluator written here agrees with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "program.h"
#include "retalho/model/model.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/terrain.h"

namespace retalho::test {
namespace {

struct Folder : ScratchFolder {
  Folder() { put("dem.asc", ascii_grid(70, 50, hills)); }
};

/// The surface's height by its definition: the piece that holds the point, found by looking at all, and the Bernstein
/// sum with factorials.
double slow_height(const Terrain& terrain, Vec2 p) {
  const EdgeTable edges = build_edges(terrain.tin);
  std::array<TerrainPatch, 6> pieces;
  double best = -1e300, height = std::numeric_limits<double>::quiet_NaN();
  for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
    const int n = triangle_patches(terrain, edges, t, pieces);
    for (int i = 0; i < n; ++i) {
      const TerrainPatch& piece = pieces[static_cast<std::size_t>(i)];
      const auto& [a, b, c] = piece.corners;
      const double area = cross(b - a, c - a), r = cross(b - p, c - p) / area, s = cross(c - p, a - p) / area,
                   u = 1 - r - s;
      const double inside = std::min({r, s, u});
      if (inside <= best) continue;
      best = inside;
      height = 0;
      const auto factorial = [](int k) { return k < 2 ? 1.0 : k == 2 ? 2.0 : 6.0; };
      std::size_t at = 0;
      for (int x = piece.degree; x >= 0; --x)
        for (int y = piece.degree - x; y >= 0; --y) {
          const int z = piece.degree - x - y;
          height += factorial(piece.degree) / (factorial(x) * factorial(y) * factorial(z)) * std::pow(r, x) *
                    std::pow(s, y) * std::pow(u, z) * piece.ordinates[at++];
        }
    }
  }
  return height;
}

TEST(Models, CompareAgreesWithASlowObviousEvaluator) {
  const Folder folder;
  const Raster raster = read_raster(folder / "dem.asc");
  for (const std::string surface : {"linear", "powell-sabin", "clough-tocher"}) {
    ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --overwrite --vertices 60 --surface " + surface).code, 0);
    const Outcome outcome = run(folder, "compare dem.asc m.retalho --json");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto report = outcome.json()["models"][0];
    const Terrain terrain = std::get<Terrain>(load_model(folder / "m.retalho"));
    double sum = 0, worst = 0;
    for (int row = 0; row < raster.rows; ++row)
      for (int column = 0; column < raster.columns; ++column) {
        const double e = slow_height(terrain, raster.centre(column, row)) - raster.at(column, row);
        sum += e * e;
        worst = std::max(worst, std::abs(e));
      }
    EXPECT_NEAR(report["rmse"].get<double>(), std::sqrt(sum / static_cast<double>(raster.cells())), 1e-9) << surface;
    EXPECT_NEAR(report["max_error"].get<double>(), worst, 1e-9) << surface;
    EXPECT_GT(worst, 1);
    EXPECT_EQ(report["vertices"], 60);
    EXPECT_EQ(report["numbers"], surface == "linear" ? 180 : 300);
    EXPECT_EQ(report["coefficients"], surface == "linear" ? 60 : 180);
    EXPECT_EQ(report["bytes"], bytes_of(folder / "m.retalho").size());
  }
}

TEST(Models, FitHasItsKeysAndKeepsTheToleranceOfTheFlatSurface) {
  const Folder folder;
  const Outcome outcome = run(folder, "fit dem.asc -o m.retalho --surface linear --max-error 4 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = outcome.json();
  for (const char* key :
       {"surface", "vertices", "triangles", "coefficients", "numbers", "bytes", "rmse", "max_error", "max_error_at",
        "slope_rmse", "cells", "valid_cells", "violations", "creases", "seconds", "seconds_triangulation"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["violations"], 0);
  EXPECT_LE(json["max_error"].get<double>(), 4);
  EXPECT_EQ(json["cells"], 3500);
  EXPECT_EQ(json["max_error_at"].size(), 2U);
}

TEST(Models, RatioAndVerticesAreBudgets) {
  const Folder folder;
  EXPECT_EQ(run(folder, "fit dem.asc -o a.retalho --vertices 35 --json").json()["vertices"], 35);
  EXPECT_EQ(run(folder, "fit dem.asc -o b.retalho --ratio 1% --json").json()["vertices"], 35);
  EXPECT_EQ(run(folder, "fit dem.asc -o c.retalho --ratio 0.01 --json").json()["vertices"], 35);
  EXPECT_EQ(run(folder, "fit dem.asc -o d.retalho --ratio 0").code, 2);
  EXPECT_EQ(run(folder, "fit dem.asc -o d.retalho --vertices 10 --ratio 1%").code, 2);
}

TEST(Models, SameBytesFromAnyNumberOfThreads) {
  const Folder folder;
  for (const char* threads : {"1", "2", "7"}) {
    const std::string t = threads;
    ASSERT_EQ(run(folder, "fit dem.asc -o m" + t + ".retalho --max-error 3 --threads " + t).code, 0);
    ASSERT_EQ(run(folder, "sample m" + t + ".retalho -o s" + t + ".tif --like dem.asc --threads " + t).code, 0);
    ASSERT_EQ(run(folder, "mesh m" + t + ".retalho -o m" + t + ".ply --tolerance 1 --threads " + t).code, 0);
    ASSERT_EQ(run(folder, "render m" + t + ".retalho -o m" + t + ".png --size 120x100 --threads " + t).code, 0);
  }
  for (const char* name : {"m%.retalho", "s%.tif", "m%.ply"}) {
    const auto file = [&](const std::string& t) { return bytes_of(folder / std::string(name).replace(1, 1, t)); };
    EXPECT_EQ(file("1"), file("2")) << name;
    EXPECT_EQ(file("1"), file("7")) << name;
  }
}

TEST(Models, OutputsAreCompleteOrAbsent) {
  const Folder folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 5").code, 0);
  const std::string before = bytes_of(folder / "m.retalho");
  const std::size_t files = folder.entries();
  EXPECT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 2").code, 5);  // exists
  EXPECT_EQ(bytes_of(folder / "m.retalho"), before);
  EXPECT_EQ(run(folder, "fit dem.asc -o no/such/m.retalho").code, 5);
  EXPECT_EQ(run(folder, "sample m.retalho -o dem.asc --like dem.asc").code, 2);  // its own input
  EXPECT_EQ(run(folder, "mesh m.retalho -o m.xyz").code, 2);
  EXPECT_EQ(run(folder, "fit missing.tif -o n.retalho").code, 4);
  EXPECT_EQ(run(folder, "mesh dem.asc -o n.ply").code, 4);  // not a model
  EXPECT_EQ(folder.entries(), files);
  EXPECT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 2 --overwrite").code, 0);
  EXPECT_NE(bytes_of(folder / "m.retalho"), before);
}

TEST(Models, DamagedModelsAreRefusedWithTheirName) {
  const Folder folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 5").code, 0);
  std::string bytes = bytes_of(folder / "m.retalho");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  folder.put("bad.retalho", bytes);
  const Outcome outcome = run(folder, "compare dem.asc bad.retalho --json");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_EQ(outcome.json()["error"]["kind"], "cannot_read");
  EXPECT_NE(outcome.out.find("bad.retalho"), std::string::npos);
}

TEST(Models, SampleAtPointsSaysWhereThereIsNoData) {
  const Folder folder;
  folder.put("void.asc", ascii_grid(40, 30, [](int c, int r) {
               return c > 30 ? std::numeric_limits<double>::quiet_NaN() : hills(c, r);
             }));
  ASSERT_EQ(run(folder, "fit void.asc -o m.retalho --max-error 0 --surface linear").code, 0);
  const Outcome outcome = run(folder, "sample m.retalho --at 1105,2105 1395,2105 5,5 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto points = outcome.json()["points"];
  ASSERT_EQ(points.size(), 3U);
  EXPECT_TRUE(points[0]["valid"].get<bool>());
  EXPECT_NEAR(points[0]["z"].get<double>(), hills(10, 19), 1e-9);  // a cell's centre
  EXPECT_FALSE(points[1]["valid"].get<bool>());
  EXPECT_FALSE(points[2]["valid"].get<bool>());
}

TEST(Models, SampledRasterIsTheSurfaceWithPositionAndVoids) {
  const Folder folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 0 --surface linear").code, 0);
  ASSERT_EQ(run(folder, "sample m.retalho -o s.tif --like dem.asc").code, 0);
  const Raster a = read_raster(folder / "dem.asc"), b = read_raster(folder / "s.tif");
  ASSERT_EQ(a.columns, b.columns);
  EXPECT_EQ(a.georef.origin_x, b.georef.origin_x);
  EXPECT_EQ(a.georef.origin_y, b.georef.origin_y);
  for (std::size_t i = 0; i < a.cells(); ++i) EXPECT_NEAR(a.at(i), b.at(i), 1e-4);
  EXPECT_EQ(run(folder, "sample m.retalho -o slope.tif --like dem.asc --what slope").code, 0);
}

TEST(Models, MeshIsWatertightInEveryFormat) {
  const Folder folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 5").code, 0);
  for (const char* format : {"ply", "obj", "stl", "glb"}) {
    const Outcome outcome = run(folder, std::string("mesh m.retalho --tolerance 0.5 --json -o m.") + format);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* key : {"vertices", "triangles", "tolerance", "watertight", "bytes"})
      EXPECT_TRUE(outcome.json().contains(key)) << key;
    EXPECT_TRUE(outcome.json()["watertight"].get<bool>());
    EXPECT_EQ(outcome.json()["bytes"], bytes_of(folder / (std::string("m.") + format)).size());
  }
}

TEST(Models, LeastSquaresIsNearerThanInterpolation) {
  const Folder folder;
  const auto rmse = [&](const std::string& options) {
    const Outcome outcome = run(folder, "fit dem.asc -o m.retalho --overwrite --json --vertices 60 " + options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.json()["rmse"].get<double>();
  };
  for (const std::string kind : {"--surface linear ", "--surface powell-sabin ", "--surface clough-tocher "}) {
    const double before = rmse(kind + "--refine flat"), fitted = rmse(kind + "--fit least-squares"),
                 z_only = rmse(kind + "--fit z-only");
    EXPECT_LT(fitted, 0.9 * before) << kind;
    EXPECT_LT(z_only, 0.95 * before) << kind;
    const Outcome compared = run(folder, "compare dem.asc m.retalho --json");  // read back
    EXPECT_NEAR(compared.json()["models"][0]["rmse"].get<double>(), z_only, 1e-12);
  }
  EXPECT_EQ(run(folder, "fit dem.asc -o n.retalho --fit least-squares --gradients network").code, 2);
  EXPECT_EQ(run(folder, "fit dem.asc -o n.retalho --fit least-squares --cross-derivative cubic").code, 2);
  EXPECT_EQ(run(folder, "fit dem.asc -o n.retalho --fit best").code, 2);
  const Outcome table = run(folder, "compare dem.asc --vertices 60");
  EXPECT_NE(table.out.find("clough-tocher fitted least-squares"), std::string::npos);
}

TEST(Models, RefinementBySurfaceIsNearerStill) {
  const Folder folder;
  const Outcome fitted = run(folder, "fit dem.asc -o a.retalho --json --vertices 60 --fit least-squares");
  const Outcome refined = run(folder, "fit dem.asc -o b.retalho --json --vertices 60 --refine surface");
  ASSERT_EQ(refined.code, 0) << refined.err;
  EXPECT_EQ(refined.json()["vertices"], 60);
  EXPECT_LT(refined.json()["rmse"].get<double>(), fitted.json()["rmse"].get<double>());
  EXPECT_EQ(refined.json()["uncovered"], 0);
  const Outcome within = run(folder, "fit dem.asc -o d.retalho --json --max-error 2 --refine surface");
  ASSERT_EQ(within.code, 0) << within.err;
  EXPECT_EQ(within.json()["violations"], 0);
  EXPECT_LE(within.json()["max_error"].get<double>(), 2);
  EXPECT_EQ(run(folder, "compare dem.asc d.retalho --json").json()["models"][0]["violations"], 0);  // of the file
  EXPECT_EQ(run(folder, "fit dem.asc -o c.retalho --max-error 0 --refine surface").code, 2);
  EXPECT_EQ(run(folder, "fit dem.asc -o z.retalho --vertices 60 --refine surface --fit z-only").code, 0);
  EXPECT_EQ(run(folder, "fit dem.asc -o c.retalho --vertices 60 --refine other").code, 2);
  EXPECT_EQ(run(folder, "mesh b.retalho -o b.ply").code, 0);
}

TEST(Models, ASmoothSurfaceIsRefinedByItsOwnErrorUnlessSomethingSpeaksAgainstIt) {
  const Folder folder;
  const auto fit = [&](const std::string& options) {
    const Outcome outcome = run(folder, "fit dem.asc -o m.retalho --overwrite --json --vertices 60 " + options);
    EXPECT_EQ(outcome.code, 0) << options << outcome.err;
    return bytes_of(folder / "m.retalho");
  };
  const std::string refined = fit("--refine surface"), flat = fit("--refine flat");
  EXPECT_EQ(fit(""), refined);
  EXPECT_EQ(fit("--effort normal"), refined);
  EXPECT_NE(flat, refined);
  EXPECT_EQ(fit("--gradients normals"), flat);
  EXPECT_EQ(fit("--fit interpolate"), flat);
  EXPECT_EQ(fit("--surface linear"), fit("--surface linear --refine flat"));
  EXPECT_NE(fit("--surface linear --effort fast"), fit("--surface linear --refine flat"));
  for (const std::string options : {"-o e.retalho", "-o f.retalho --refine flat"})
    ASSERT_EQ(run(folder, "fit dem.asc --max-error 0 " + options).code, 0);  // every cell: nothing to choose
  EXPECT_EQ(bytes_of(folder / "e.retalho"), bytes_of(folder / "f.retalho"));
  const Outcome within = run(folder, "fit dem.asc -o w.retalho --json --max-error 2");
  EXPECT_EQ(within.json()["violations"], 0);
}

TEST(Models, MoreEffortIsNearer) {
  const Folder folder;
  std::vector<double> rmse;
  for (const std::string effort : {"fast", "normal", "best"}) {
    const Outcome outcome = run(folder, "fit dem.asc -o m.retalho --overwrite --json --vertices 60 --effort " + effort);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    rmse.push_back(outcome.json()["rmse"].get<double>());
  }
  EXPECT_LT(rmse[1], 0.97 * rmse[0]);
  EXPECT_LT(rmse[2], rmse[1]);
  for (const std::string options : {"--effort slow", "--effort best --refine flat", "--effort best --fit z-only",
                                    "--effort fast --gradients normals", "--effort fast --max-error 0"})
    EXPECT_EQ(run(folder, "fit dem.asc -o n.retalho " + options).code, 2) << options;
  EXPECT_FALSE(std::filesystem::exists(folder / "n.retalho"));
}

TEST(Models, BaselinesHaveTheNumbersOrTheBytesOfTheirModel) {
  const Folder folder;
  for (const std::string form : {"exact", "compact"}) {
    ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --overwrite --vertices 90 --format " + form).code, 0);
    const Outcome outcome = run(folder, "compare dem.asc m.retalho --baselines --json");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto models = outcome.json()["models"];
    ASSERT_EQ(models.size(), 5U);
    for (std::size_t k : {1U, 3U}) {  // of its numbers, then of its bytes
      EXPECT_EQ(models[k]["surface"], "linear");
      EXPECT_EQ(models[k]["numbers"], models[0]["numbers"]);
      const double ratio = models[k + 1]["bytes"].get<double>() / models[0]["bytes"].get<double>();
      EXPECT_NEAR(ratio, 1, 0.05) << form;
    }
    EXPECT_LT(models[3]["rmse"].get<double>(), models[1]["rmse"].get<double>()) << form;  // the strong one is strong
  }
  const auto kinds = run(folder, "compare dem.asc --vertices 100 --baselines --json").json()["models"];
  ASSERT_EQ(kinds.size(), 18U);
  EXPECT_EQ(kinds[13]["name"], "strong linear");
  EXPECT_EQ(kinds[14]["numbers"], kinds[13]["numbers"]);
  EXPECT_EQ(run(folder, "compare dem.asc m.retalho --baselines --visibility 100").code, 2);
}

TEST(Models, SurveyPointsBecomeASurfaceToo) {
  const Folder folder;
  std::string points = "x,y,z\n";
  for (int i = 0; i < 400; ++i) {
    const int c = (i * 37) % 70, r = (i * 53) % 50;
    points += fmt::format("{},{},{}\n", 1005 + 10 * c, 2495 - 10 * r, hills(c, r));
  }
  folder.put("points.csv", points);
  const Outcome outcome = run(folder, "fit points.csv -o p.retalho --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_LE(outcome.json()["max_error"].get<double>(), 1e-6);  // the surface passes through its points
  EXPECT_EQ(run(folder, "mesh p.retalho -o p.ply").code, 0);
  EXPECT_EQ(run(folder, "fit points.csv -o q.retalho --max-error 5 --surface linear --json").json()["violations"], 0);
}

TEST(Models, RenderDrawsGridsAndModelsSideBySide) {
  const Folder folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 5").code, 0);
  ASSERT_EQ(run(folder, "render dem.asc m.retalho -o p.png --size 400x200").code, 0);
  const std::string png = bytes_of(folder / "p.png");
  ASSERT_GT(png.size(), 1000U);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  const auto number = [&](std::size_t at) {
    return (static_cast<unsigned char>(png[at + 2]) << 8) | static_cast<unsigned char>(png[at + 3]);
  };
  EXPECT_EQ(number(16), 400);
  EXPECT_EQ(number(20), 200);
  EXPECT_EQ(run(folder, "render m.retalho -o q.png --size 0x10").code, 2);
}

TEST(Models, TheCompactFormIsAModelForEveryCommand) {
  const Folder folder;
  const auto fit = run(folder, "fit dem.asc -o c.retalho --max-error 2 --format compact --surface auto --json");
  ASSERT_EQ(fit.code, 0) << fit.err;
  EXPECT_EQ(fit.json()["violations"], 0);
  EXPECT_LE(fit.json()["max_error"].get<double>(), 2.0);
  EXPECT_EQ(fit.json()["bytes"].get<std::size_t>(), bytes_of(folder / "c.retalho").size());
  ASSERT_EQ(run(folder, "fit dem.asc -o e.retalho --max-error 2 --refine surface").code, 0);
  EXPECT_LT(10 * bytes_of(folder / "c.retalho").size(), 6 * bytes_of(folder / "e.retalho").size());
  const auto compared = run(folder, "compare dem.asc c.retalho --json").json()["models"][0];
  for (const char* key : {"rmse", "max_error", "bytes", "vertices", "slope_rmse"})
    EXPECT_EQ(compared[key], fit.json()[key]);
  EXPECT_EQ(run(folder, "info c.retalho --json").json()["vertices"], fit.json()["vertices"]);
  EXPECT_EQ(run(folder, "sample c.retalho -o s.tif").code, 0);
  EXPECT_EQ(run(folder, "contour c.retalho -o l.geojson --interval 10").code, 0);
  EXPECT_EQ(run(folder, "mesh c.retalho -o m.ply").code, 0);
  EXPECT_EQ(run(folder, "render c.retalho -o r.png").code, 0);
  ASSERT_EQ(run(folder, "fit dem.asc -o v.retalho --vertices 60 --format compact --fit z-only --json").code, 0);
  EXPECT_EQ(run(folder, "info v.retalho --json").json()["vertices"], 60);
}

TEST(Models, TheCompactFormSaysWhatItDoesNotTake) {
  const Folder folder;
  folder.put("points.xyz", "0 0 1\n1 0 2\n0 1 3\n");
  for (const std::string options :
       {"dem.asc --max-error 2 --format small", "dem.asc --max-error 2 --format compact --surface powell-sabin",
        "dem.asc --max-error 2 --surface auto", "dem.asc --vertices 60 --format compact --surface auto",
        "dem.asc --max-error 2 --vertices 60 --format compact", "dem.asc --max-error 0 --format compact",
        "dem.asc --max-error 2 --format compact --gradients normals", "points.xyz --format compact",
        "dem.asc --max-error 2 --format compact --cross-derivative cubic",
        "dem.asc --max-error 2 --format compact --fit z-only"}) {
    const auto outcome = run(folder, "fit " + options + " -o n.retalho");
    EXPECT_EQ(outcome.code, 2) << options << outcome.err;
  }
  EXPECT_EQ(folder.entries(), 2U);
}

}  // namespace
}  // namespace retalho::test
