// Every real grid reads with the size, CRS, voids and range that its origin states.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "retalho/raster/io.h"
#include "support/support.h"

namespace retalho {
namespace {

struct Known {
  const char* file;
  int columns, rows;
  const char* crs;
  double void_percent, minimum, maximum;
  const char* unit;
};

class RealGrid : public testing::TestWithParam<Known> {};

TEST_P(RealGrid, ReadsAsStated) {
  const Known& known = GetParam();
  RETALHO_DATA_FILE(path, std::string("dem/") + known.file);
  ReadNotes notes;
  const Raster raster = read_raster(path, {}, &notes);
  const RasterSummary summary = summarize(raster);
  EXPECT_EQ(raster.columns, known.columns);
  EXPECT_EQ(raster.rows, known.rows);
  EXPECT_EQ(notes.crs_name.substr(0, notes.crs_name.find(' ')), known.crs) << notes.crs_name;
  EXPECT_EQ(raster.georef.unit, known.unit);
  EXPECT_NEAR(100.0 * static_cast<double>(summary.cells - summary.valid) / static_cast<double>(summary.cells),
              known.void_percent, 0.06);
  EXPECT_NEAR(summary.minimum, known.minimum, 0.051);
  EXPECT_NEAR(summary.maximum, known.maximum, 0.051);
  EXPECT_TRUE(std::holds_alternative<std::vector<float>>(raster.heights));
}

INSTANTIATE_TEST_SUITE_P(
    Dem, RealGrid,
    testing::Values(Known{"crater.pgm", 336, 459, "", 0, 1533, 2478, "unit"},
                    Known{"crater_p5.pgm", 336, 459, "", 0, 1533, 2478, "unit"},
                    Known{"N48W125.hgt.zip", 3601, 3601, "EPSG:4326", 50.0, -13, 1095, "metre"},
                    Known{"N44W072.hgt", 1201, 1201, "EPSG:4326", 0, 115, 1908, "metre"},
                    Known{"N42E001.hgt.zip", 1201, 1201, "EPSG:4326", 0.53, 349, 3100, "metre"},
                    Known{"N41E001.hgt.zip", 1201, 1201, "EPSG:4326", 0.01, -20, 1204, "metre"},
                    Known{"N53E027.hgt.zip", 1201, 1201, "EPSG:4326", 0, 142, 354, "metre"},
                    Known{"N53E028.hgt.zip", 1201, 1201, "EPSG:4326", 0, 134, 260, "metre"},
                    Known{"SainteHelens.dem", 327, 468, "EPSG:26710", 2.7, 682, 2543, "metre"},
                    Known{"bigtujunga.tif", 1197, 643, "EPSG:32611", 0, 315, 2295, "metre"},
                    Known{"exploradores_aster.tif", 539, 618, "EPSG:32718", 2.67, 317.7, 3959.9, "metre"},
                    Known{"dom1_32_356_5699_1_nw_2020.tif", 1000, 1000, "EPSG:25832", 0, 87.29, 167.74, "metre"},
                    Known{"drumlin_dem.tif", 499, 1146, "EPSG:26918", 0.29, 124.56, 172.60, "metre"},
                    Known{"gabilan.bil", 921, 859, "EPSG:32611", 0, 187.90, 307.28, "metre"},
                    Known{"rhine_elv0.tif", 997, 682, "EPSG:4326", 48.6, 0, 3532.1, "metre"},
                    Known{"LisbonElevation.tif", 547, 421, "EPSG:4326", 0, -6.83, 217.94, "metre"},
                    Known{"zion_srtm.tif", 465, 457, "EPSG:4326", 0, 1024, 2892, "metre"}),
    [](const auto& one) {
      std::string name = one.param.file;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name;
    });

TEST(RealGrid, AsciiAndBinaryPgmAreTheSame) {
  RETALHO_DATA_FILE(text_file, "dem/crater.pgm");
  RETALHO_DATA_FILE(binary_file, "dem/crater_p5.pgm");
  const Raster ascii = read_raster(text_file), binary = read_raster(binary_file);
  EXPECT_EQ(ascii.heights, binary.heights);
  EXPECT_EQ(ascii.cell_width, 1);
  EXPECT_EQ(binary.cell_width, 1);
}

}  // namespace
}  // namespace retalho
