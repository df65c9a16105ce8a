// The text of a CRS is its EPSG code's, whatever the thread has done before.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "retalho/raster/crs_code.h"
#include "retalho/raster/gdal.h"
#include "retalho/raster/io.h"
#include "support/support.h"

namespace retalho {
namespace {

std::string in_thread(const std::function<std::string()>& work) {
  std::string text;
  std::thread thread([&] { text = work(); });
  thread.join();
  return text;
}

TEST(CrsText, DoesNotDependOnTheThreadOrOnWhatItDidBefore) {
  const test::ScratchFolder folder;
  for (const int code : {32611, 25832, 2193, 3857}) {
    const std::string expected = in_thread([&] { return wkt_of_epsg(code); });
    EXPECT_EQ(epsg_of(expected), code);
    Raster raster;
    raster.columns = raster.rows = 3;
    raster.heights = std::vector<float>(9, 1.0F);
    raster.georef.origin_x = 500000;
    raster.georef.origin_y = 4200000;
    raster.georef.crs_wkt = expected;
    const std::string path = folder / (std::to_string(code) + ".tif");
    write_raster(raster, path);
    const auto of_file = [&] { return read_raster(path).georef.crs_wkt; };
    const auto of_code = [&] { return wkt_of_epsg(code); };
    // PROJ's own words change once a thread has read a GeoTIFF.
    EXPECT_EQ(in_thread(of_file), expected) << code;
    EXPECT_EQ(in_thread([&] { return of_file(), of_code(); }), expected) << code;
    EXPECT_EQ(in_thread([&] { return of_code(), of_file(); }), expected) << code;
    EXPECT_EQ(in_thread([&] { return of_file(), of_file(), of_code(); }), expected) << code;
    EXPECT_EQ(of_file(), expected) << code;
    EXPECT_EQ(epsg_of(of_file()), code);
  }
}

TEST(CrsText, OfACrsThatOnlyClaimsACodeIsItsOwn) {
  std::string moved = wkt_of_epsg(32611);
  const std::string words = "\"False easting\",500000";
  moved.replace(moved.find(words), words.size(), "\"False easting\",400000");
  Georef georef;
  std::vector<std::string> remarks;
  describe_crs_text(moved, 0, georef, remarks);
  EXPECT_NE(georef.crs_wkt.find("\"False easting\",400000"), std::string::npos) << georef.crs_wkt;
  EXPECT_EQ(epsg_of(georef.crs_wkt), 0);
}

}  // namespace
}  // namespace retalho
