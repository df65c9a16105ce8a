// retalho contour from the command line.
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "program.h"

namespace retalho::test {
namespace {

struct Hills : ScratchFolder {
  Hills() { put("dem.asc", ascii_grid(40, 30, hills)); }
};

struct Close {
  void operator()(GDALDataset* d) const { GDALClose(d); }
};
using Dataset = std::unique_ptr<GDALDataset, Close>;

Dataset open(const std::string& path) {
  GDALAllRegister();
  return Dataset(static_cast<GDALDataset*>(GDALOpenEx(path.c_str(), GDAL_OF_VECTOR, nullptr, nullptr, nullptr)));
}

TEST(Contour, LinesInEveryFormat) {
  const Hills folder;
  GIntBig features = 0;
  for (const char* ending : {"gpkg", "geojson", "shp", "dxf"}) {
    const Outcome outcome = run(folder, fmt::format("contour dem.asc -o lines.{} --interval 20 --json", ending));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto json = outcome.json();
    EXPECT_GT(json["lines"].get<int>(), 5);
    EXPECT_TRUE(json["singular"].is_array());
    const Dataset dataset = open(folder / fmt::format("lines.{}", ending));
    ASSERT_TRUE(dataset) << ending;
    OGRLayer* layer = dataset->GetLayer(0);
    ASSERT_NE(layer, nullptr);
    EXPECT_EQ(layer->GetFeatureCount(), json["lines"].get<GIntBig>()) << ending;
    features += layer->GetFeatureCount();
    if (std::string(ending) == "dxf") continue;
    for (auto& feature : *layer) {
      const double elev = feature->GetFieldAsDouble("elev");
      EXPECT_EQ(std::fmod(elev, 20), 0);
      EXPECT_EQ(feature->GetFieldAsInteger("index"), std::fmod(elev, 100) == 0 ? 1 : 0);
      const OGRLineString* line = feature->GetGeometryRef()->toLineString();
      EXPECT_EQ(line->get_IsClosed(), feature->GetFieldAsInteger("closed") == 1);
      EXPECT_GE(line->getX(0), 1005);
      EXPECT_LE(line->getX(0), 1395);
    }
  }
  EXPECT_GT(features, 0);
}

TEST(Contour, BandsCoverTheGrid) {
  const Hills folder;
  ASSERT_EQ(run(folder, "contour dem.asc -o bands.gpkg --interval 20 --bands").code, 0);
  const Dataset dataset = open(folder / "bands.gpkg");
  ASSERT_TRUE(dataset);
  double area = 0;
  for (auto& feature : *dataset->GetLayer(0)) {
    EXPECT_TRUE(feature->GetGeometryRef()->IsValid());
    area += feature->GetGeometryRef()->toPolygon()->get_Area();
  }
  EXPECT_NEAR(area, 390.0 * 290.0, 1e-6 * 390 * 290);
}

TEST(Contour, ModelsAndPointsToo) {
  const Hills folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 2").code, 0);
  EXPECT_EQ(run(folder, "contour m.retalho -o m.gpkg --interval 20").code, 0);
  EXPECT_EQ(run(folder, "contour dem.asc -o ps.gpkg --interval 20 --surface powell-sabin --max-error 2").code, 0);
  std::string xyz;
  for (int i = 0; i < 200; ++i) xyz += fmt::format("{} {} {}\n", (i * 37) % 101, (i * 53) % 97, (i * 29) % 31);
  folder.put("points.xyz", xyz);
  const Outcome outcome = run(folder, "contour points.xyz -o p.geojson --interval 5 --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_GT(outcome.json()["lines"].get<int>(), 0);
}

TEST(Contour, ConicsOfPowellSabinSurfaces) {
  const Hills folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 2 --surface powell-sabin").code, 0);
  const Outcome outcome = run(folder, "contour m.retalho -o exact.json --interval 20 --conics --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Outcome lines = run(folder, "contour m.retalho -o lines.geojson --interval 20 --json");
  EXPECT_EQ(outcome.json()["lines"], lines.json()["lines"]);
  EXPECT_EQ(outcome.json()["closed_lines"], lines.json()["closed_lines"]);
  EXPECT_GT(outcome.json()["conics"].get<int>(), outcome.json()["lines"].get<int>());
  // They are curves as any other.
  EXPECT_EQ(run(folder, "curve exact.json -o exact.svg").code, 0);
  const std::size_t before = folder.entries();
  EXPECT_EQ(run(folder, "contour m.retalho -o x.gpkg --interval 20 --conics").code, 2);
  EXPECT_EQ(run(folder, "contour m.retalho -o x.json --interval 20 --conics --bands").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.json --interval 20 --conics").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.json --interval 20 --conics --max-error 2 --surface clough-tocher").code,
            3);
  EXPECT_EQ(folder.entries(), before);
}

TEST(Contour, BandsOfModelsWithVoids) {
  const Hills folder;
  folder.put("holes.asc", ascii_grid(40, 30, [](int c, int r) {
               return c > 15 && c < 20 && r > 9 && r < 14 ? -9999.0 : hills(c, r);
             }));
  ASSERT_EQ(run(folder, "fit holes.asc -o m.retalho --max-error 2").code, 0);
  ASSERT_EQ(run(folder, "contour m.retalho -o bands.gpkg --interval 20 --bands").code, 0);
  const Dataset data = open((folder.path() / "bands.gpkg").string());
  ASSERT_NE(data, nullptr);
  double area = 0;
  for (const auto& feature : data->GetLayer(0)) {
    EXPECT_TRUE(feature->GetGeometryRef()->IsValid());
    area += feature->GetGeometryRef()->toPolygon()->get_Area();
  }
  EXPECT_NEAR(area, (39 * 29 - 16) * 100, 1e-6);
}

TEST(Contour, BreaklinesOfSurveys) {
  const ScratchFolder folder;
  std::string csv = "x,y,z\n";
  // A ridge along x = 50.5: height falls by 1 to the west and by 0.2 to the east.
  const auto height = [](double x) { return x < 50.5 ? 60 - (50.5 - x) : 60 - 0.2 * (x - 50.5); };
  for (int i = 0; i < 400; ++i) csv += fmt::format("{},{},{}\n", (i * 37) % 101, (i * 53) % 97, height((i * 37) % 101));
  folder.put("survey.csv", csv);
  folder.put("ridge.geojson",
             R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":)"
             R"("LineString","coordinates":[[50.5,2,60],[50.5,40,60],[50.5,90,60]]}}]})");
  const Outcome lines = run(folder, "contour survey.csv -o l.gpkg --interval 5 --breaklines ridge.geojson --json");
  ASSERT_EQ(lines.code, 0) << lines.err;
  EXPECT_NE(lines.err.find("1 breaklines with 3 vertices"), std::string::npos) << lines.err;
  const Outcome model = run(folder, "fit survey.csv -o m.retalho --breaklines ridge.geojson --json");
  ASSERT_EQ(model.code, 0) << model.err;
  const Outcome smooth = run(folder, "fit survey.csv -o s.retalho --json");
  ASSERT_EQ(smooth.code, 0) << smooth.err;
  // The model keeps both planes to the ridge; the smooth one cannot.
  const auto error_at = [&](const char* file, double x, double y) {
    const Outcome at = run(folder, fmt::format("sample {} --at {},{} --json", file, x, y));
    EXPECT_EQ(at.code, 0) << at.err;
    return std::abs(at.json()["points"][0]["z"].get<double>() - height(x));
  };
  double worst = 0, worst_smooth = 0;
  for (double y = 20; y < 75; y += 5)
    for (const double x : {49.9, 51.1}) {
      worst = std::max(worst, error_at("m.retalho", x, y));
      worst_smooth = std::max(worst_smooth, error_at("s.retalho", x, y));
    }
  EXPECT_LT(worst, 1e-9);
  EXPECT_GT(worst_smooth, 0.05);
  EXPECT_EQ(run(folder, "mesh m.retalho -o m.ply").code, 0);
  EXPECT_EQ(run(folder, "contour m.retalho -o b.gpkg --interval 5 --bands").code, 0);
}

TEST(Contour, BreaklinesRefusedInWords) {
  const Hills folder;
  folder.put("p.csv", "x,y,z\n0,0,1\n10,0,2\n0,10,3\n10,10,4\n");
  folder.put("points.geojson", R"({"type":"Point","coordinates":[1,2,3]})");
  folder.put("far.geojson", R"({"type":"LineString","coordinates":[[1,2],[300,4]]})");
  const std::size_t before = folder.entries();
  const auto words = [&](const std::string& arguments, int code) {
    const Outcome outcome = run(folder, arguments);
    EXPECT_EQ(outcome.code, code) << arguments << outcome.err;
    return outcome.err;
  };
  EXPECT_NE(words("contour dem.asc -o x.gpkg --interval 5 --breaklines far.geojson", 2).find("goes with points"),
            std::string::npos);
  EXPECT_NE(words("contour p.csv -o x.gpkg --interval 1 --breaklines points.geojson", 3).find("holds no line"),
            std::string::npos);
  EXPECT_NE(words("contour p.csv -o x.gpkg --interval 1 --breaklines far.geojson", 3).find("give the lines heights"),
            std::string::npos);
  EXPECT_NE(words("contour p.csv -o x.gpkg --interval 1 --breaklines none.geojson", 4).find("does not exist"),
            std::string::npos);
  EXPECT_NE(words("contour p.csv -o x.gpkg --interval 1 --breakline-layer a", 2).find("goes with --breaklines"),
            std::string::npos);
  for (const char* command : {"fit p.csv -o x.retalho", "contour p.csv -o x.gpkg --interval 1"})
    EXPECT_NE(words(std::string(command) + " --max-error 1 --breaklines far.geojson", 2)
                  .find("--breaklines keeps every point"),
              std::string::npos);
  EXPECT_EQ(folder.entries(), before);
}

TEST(Contour, ABudgetOfPointsLeavesVerticesOut) {
  const Hills folder;
  std::string points = "x,y,z\n";
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) points += std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(x) + "\n";
  folder.put("plane.csv", points);
  const auto traced = [&](const std::string& budget) {
    const Outcome outcome = run(
        folder, "contour plane.csv -o plane.gpkg --overwrite --raw --surface linear --levels 14.5 --json " + budget);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.json()["vertices"].get<int>();
  };
  EXPECT_GT(traced(""), 29);                  // a vertex on every edge that it crosses
  EXPECT_EQ(traced("--max-error 0.001"), 3);  // two triangles
  EXPECT_EQ(traced("--vertices 4"), 3);
}

TEST(Contour, NoLevelInReachGivesALayerWithoutFeatures) {
  const Hills folder;
  const Outcome outcome = run(folder, "contour dem.asc -o none.gpkg --levels 5000");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("no features"), std::string::npos);
  const Dataset dataset = open(folder / "none.gpkg");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->GetLayer(0)->GetFeatureCount(), 0);
}

TEST(Contour, RefusesWithAMessageAndLeavesNothing) {
  const Hills folder;
  const std::size_t before = folder.entries();
  EXPECT_EQ(run(folder, "contour dem.asc -o x.gpkg").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.gpkg --interval 20 --levels 1").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.gpkg --levels 1,b").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.gpkg --interval 1e-9").code, 3);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.tif --interval 20").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.dxf --interval 20 --bands").code, 5);
  EXPECT_EQ(run(folder, "contour dem.asc -o nowhere/x.gpkg --interval 20").code, 5);
  EXPECT_EQ(run(folder, "contour missing.asc -o x.gpkg --interval 20").code, 4);
  EXPECT_EQ(folder.entries(), before);
  ASSERT_EQ(run(folder, "contour dem.asc -o x.shp --interval 20").code, 0);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.shp --interval 20").code, 5);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.shp --interval 30 --overwrite").code, 0);
}

TEST(ContourSheet, SvgAndPdfMapSheets) {
  const Hills folder;
  const Outcome svg =
      run(folder, "contour dem.asc -o map.svg --interval 10 --bands --curves --title 'Two hills' --sheet A5 --json");
  ASSERT_EQ(svg.code, 0) << svg.err;
  const auto json = svg.json();
  EXPECT_GT(json["sheet"]["curves"].get<int>(), 20);
  EXPECT_EQ(json["sheet"]["unproved_pairs"].get<int>(), 0);
  EXPECT_NEAR(json["tolerance"].get<double>(), 1, 1e-12);
  const std::string text = slurp(folder / "map.svg");
  EXPECT_NE(text.find("width=\"210mm\" height=\"148mm\""), std::string::npos);
  EXPECT_NE(text.find("Two hills"), std::string::npos);
  EXPECT_NE(text.find("Contour lines every 10"), std::string::npos);
  EXPECT_TRUE(text.ends_with("</svg>\n"));
  ASSERT_EQ(run(folder, "contour dem.asc -o map.pdf --interval 10 --sheet 300x200").code, 0);
  EXPECT_TRUE(slurp(folder / "map.pdf").starts_with("%PDF-"));
  EXPECT_EQ(run(folder, "contour dem.asc -o map.pdf --interval 10").code, 5) << "it exists";
  // Models have sheets too, and a grid without any line has a frame and a word.
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 2").code, 0);
  EXPECT_EQ(run(folder, "contour m.retalho -o m.svg --interval 20 --curves --bands").code, 0);
  const Outcome none = run(folder, "contour dem.asc -o none.svg --levels 5000 --curves");
  ASSERT_EQ(none.code, 0) << none.err;
  EXPECT_NE(none.err.find("frame alone"), std::string::npos);
  EXPECT_NE(slurp(folder / "none.svg").find("No contour line"), std::string::npos);
}

TEST(ContourSheet, RefusesWithAMessageAndLeavesNothing) {
  const Hills folder;
  const std::size_t before = folder.entries();
  EXPECT_EQ(run(folder, "contour dem.asc -o x.svg --interval 10 --sheet A9").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.svg --interval 10 --sheet 40x40").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.gpkg --interval 10 --curves").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o x.gpkg --interval 10 --title T").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc -o nowhere/x.pdf --interval 10").code, 5);
  EXPECT_EQ(folder.entries(), before);
}

TEST(ContourSheet, SeasPlateausAndVoids) {
  const ScratchFolder folder;
  const auto land = [](int c, int r) {
    return std::round(30 - 1.5 * std::hypot(c - 28, r - 20) + 4 * std::sin(0.5 * c));
  };
  folder.put("sea.asc", ascii_grid(60, 44, [&](int c, int r) { return std::max(0.0, land(c, r)); }));
  folder.put("table.asc", ascii_grid(60, 44, [&](int c, int r) { return std::min(20.0, land(c, r)); }));
  folder.put("voids.asc",
             ascii_grid(60, 44, [&](int c, int r) { return (c * 7 + r * 5) % 31 < 4 ? NAN : land(c, r); }));
  for (const char* name : {"sea", "table", "voids"}) {
    const Outcome outcome =
        run(folder, fmt::format("contour {0}.asc -o {0}.pdf --interval 5 --bands --curves --json", name));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto sheet = outcome.json()["sheet"];
    EXPECT_GT(sheet["curves"].get<int>(), 30) << name;
    EXPECT_LT(20 * sheet["straight_pieces"].get<int>(), sheet["curves"].get<int>()) << name;
    EXPECT_EQ(sheet["unproved_pairs"].get<int>(), 0) << name;
  }
}

TEST(CompareSurfaces, OfGridsAndPoints) {
  const Hills folder;
  const Outcome grid = run(folder, "contour dem.asc --interval 10 --compare-surfaces c.svg --zoom 20 --json");
  ASSERT_EQ(grid.code, 0) << grid.err;
  const auto names = grid.json()["surfaces"];
  ASSERT_EQ(names.size(), 8U);
  EXPECT_NE(grid.err.find("middle 20 x 20 cells of 40 x 30"), std::string::npos);
  const std::string svg = slurp(folder / "c.svg");
  for (const auto& name : names) EXPECT_NE(svg.find(fmt::format(">{}<", name.get<std::string>())), std::string::npos);
  std::string xyz;
  for (int i = 0; i < 120; ++i) xyz += fmt::format("{} {} {}\n", (i * 37) % 101, (i * 53) % 97, (i * 29) % 31);
  folder.put("points.xyz", xyz);
  const Outcome points = run(folder, "contour points.xyz --interval 5 --compare-surfaces p.png -o p.gpkg");
  ASSERT_EQ(points.code, 0) << points.err;
  EXPECT_TRUE(slurp(folder / "p.png").starts_with("\x89PNG"));
  EXPECT_FALSE(slurp(folder / "p.gpkg").empty());
}

TEST(CompareSurfaces, RefusesWithAMessageAndLeavesNothing) {
  const Hills folder;
  ASSERT_EQ(run(folder, "fit dem.asc -o m.retalho --max-error 2").code, 0);
  const std::size_t before = folder.entries();
  EXPECT_EQ(run(folder, "contour dem.asc --interval 10").code, 2);  // no output at all
  EXPECT_EQ(run(folder, "contour dem.asc --interval 10 --compare-surfaces c.tif").code, 2);
  EXPECT_EQ(run(folder, "contour m.retalho --interval 10 --compare-surfaces c.png").code, 2);
  EXPECT_EQ(run(folder, "contour dem.asc --interval 10 --compare-surfaces nowhere/c.png").code, 5);
  EXPECT_EQ(run(folder, "contour dem.asc --interval 10 --compare-surfaces c.png --zoom -1").code, 2);
  EXPECT_EQ(folder.entries(), before);
}

}  // namespace
}  // namespace retalho::test
