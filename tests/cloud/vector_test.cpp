// Points out of vector layers: geometries with z, attributes, several layers.
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "retalho/cloud/cloud.h"
#include "retalho/core/error.h"
#include "support/errors.h"
#include "support/support.h"

namespace retalho {
namespace {

using test::holds;
using test::words_of;

std::string geojson(const std::string& features) {
  return R"({"type":"FeatureCollection","features":[)" + features + "]}";
}
std::string feature(const std::string& geometry, const std::string& properties = "{}") {
  return R"({"type":"Feature","properties":)" + properties + R"(,"geometry":)" + geometry + "}";
}

TEST(VectorPoints, PointsMultiPointsAndLines) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.put(
      "x.geojson", geojson(feature(R"({"type":"Point","coordinates":[7,47,1]})") + "," +
                           feature(R"({"type":"MultiPoint","coordinates":[[7.5,47,2],[8,47,3]]})") + "," +
                           feature(R"({"type":"LineString","coordinates":[[7,48,4],[8,48,5]]})") + "," +
                           feature(R"({"type":"Polygon","coordinates":[[[7,48,4],[8,48,5],[8,49,5],[7,48,4]]]})")));
  PointNotes notes;
  const PointCloud cloud = read_points(file, {}, &notes);
  ASSERT_EQ(cloud.positions.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(cloud.positions[k].z, static_cast<double>(k + 1));
  EXPECT_TRUE(cloud.georef.geographic);
  EXPECT_EQ(notes.format, "GeoJSON");
  EXPECT_EQ(notes.crs_name.substr(0, 9), "EPSG:4326");
  const Vec2 first = cloud.georef.to_crs({cloud.positions[0].x, cloud.positions[0].y});
  EXPECT_NEAR(first.x, 7, 1e-12) << "longitude is x";
  EXPECT_NEAR(first.y, 47, 1e-12);
  bool said = false;
  for (const std::string& remark : notes.remarks) said = said || remark.find("1 geometries") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(VectorPoints, HeightFromAnAttribute) {
  const test::ScratchFolder scratch;
  const std::string file = scratch.put(
      "x.geojson", geojson(feature(R"({"type":"Point","coordinates":[1,2]})", R"({"depth":-7.5,"name":"a"})") + "," +
                           feature(R"({"type":"Point","coordinates":[3,4]})", R"({"depth":null,"name":"b"})") + "," +
                           feature(R"({"type":"Point","coordinates":[5,6]})", R"({"depth":9,"name":"c"})")));
  PointNotes notes;
  const PointCloud cloud = read_points(file, {.height_field = "depth"}, &notes);
  ASSERT_EQ(cloud.positions.size(), 2U);
  EXPECT_EQ(cloud.positions[0].z, -7.5);
  EXPECT_EQ(cloud.positions[1].z, 9);
  EXPECT_EQ(notes.skipped, 1U);
  const std::string without = words_of<BadInput>([&] { read_points(file); });
  EXPECT_TRUE(holds(without, "--height-field"));
  EXPECT_TRUE(holds(without, "'depth'"));
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_points(file, {.height_field = "nothing"}); }), "'depth'"));
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_points(file, {.height_field = "name"}); }), "not a number"));
}

TEST(VectorPoints, LayersAreChosenByName) {
  const test::ScratchFolder scratch;
  GDALAllRegister();
  const std::string file = scratch / "x.gpkg";
  GDALDataset* dataset =
      GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  ASSERT_NE(dataset, nullptr);
  OGRSpatialReference crs;
  crs.importFromEPSG(25832);
  for (const char* name : {"one", "two"}) {
    OGRLayer* layer = dataset->CreateLayer(name, &crs, wkbPoint25D, nullptr);
    for (int k = 0; k < (name[0] == 'o' ? 3 : 4); ++k) {
      OGRFeature made(layer->GetLayerDefn());
      OGRPoint point(500000.5 + k, 5700000.25 + k * k, k);
      made.SetGeometry(&point);
      ASSERT_EQ(layer->CreateFeature(&made), OGRERR_NONE);
    }
  }
  GDALClose(dataset);
  const std::string words = words_of<BadInput>([&] { read_points(file); });
  EXPECT_TRUE(holds(words, "'one', 'two'"));
  PointNotes notes;
  const PointCloud cloud = read_points(file, {.layer = "two"}, &notes);
  EXPECT_EQ(cloud.positions.size(), 4U);
  EXPECT_EQ(notes.crs_name, "EPSG:25832 ETRS89 / UTM zone 32N");
  const Vec2 second = cloud.georef.to_crs({cloud.positions[1].x, cloud.positions[1].y});
  EXPECT_EQ(second.x, 500001.5);
  EXPECT_EQ(second.y, 5700001.25);
  EXPECT_TRUE(holds(words_of<BadInput>([&] { read_points(file, {.layer = "three"}); }), "'three'"));
}

}  // namespace
}  // namespace retalho
