// What the calls of the room refuse, in its own words: those that no command line can ask for.
#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "retalho/core/error.h"
#include "retalho/raster/gdal.h"
#include "retalho/raster/geodetic.h"
#include "retalho/raster/io.h"
#include "retalho/raster/pgm.h"
#include "retalho/raster/vector_layer.h"
#include "support/errors.h"
#include "support/grids.h"
#include "support/support.h"

namespace retalho::test {
namespace {

TEST(RasterMessages, WhatIsNoGridIsNamed) {
  register_gdal();
  const ScratchFolder scratch;
  const std::string both = (scratch.path() / "both.gpkg").string();
  GDALDriver& gpkg = *GetGDALDriverManager()->GetDriverByName("GPKG");
  for (const char* name : {"one", "two"}) {  // two rasters in one file: none is the file's own
    char** options = CSLSetNameValue(nullptr, "RASTER_TABLE", name);
    if (name == std::string("two")) options = CSLSetNameValue(options, "APPEND_SUBDATASET", "YES");
    const DatasetPtr made(gpkg.Create(both.c_str(), 16, 16, 1, GDT_Byte, options));
    ASSERT_TRUE(made);
    double place[6] = {0, 1, 0, 0, 0, -1};
    made->SetGeoTransform(place);
    CSLDestroy(options);
  }
  std::string text = "P5 2 2 9 abcd";
  const auto source = [&text](char* to, std::size_t) { return text.copy(to, text.size()); };
  expect_refused<BadInput>({
      {"holds no raster band of its own; give one of the rasters inside it:\n  GPKG:", [&] { read_raster(both); }},
  });
  expect_refused<CannotRead>({
      {"no file name was given", [] { read_raster(""); }},
      {"not an ASCII PGM: it should begin with P2 and white space", [&] { read_pgm(source, "five.pgm"); }},
  });
}

TEST(RasterMessages, WhatCannotBeWrittenIsNamed) {
  const ScratchFolder scratch;
  const auto file = [&](const char* name) { return (scratch.path() / name).string(); };
  const Raster grid = make_grid(4, 3, [](int x, int) { return x == 2 ? NAN : 1; });
  expect_refused<CannotWrite>({
      {"GDAL has no raster driver 'Sponge' that writes: gdalinfo --formats lists them",
       [&] { write_raster(grid, file("o.tif"), {.driver = "Sponge"}); }},
      {"this format has no no-data value, and the raster has void cells: use .tif",
       [&] { write_raster(grid, file("o.xyz")); }},
      {"a raster without cells cannot be written", [&] { write_raster({}, file("o.tif")); }},
  });
  expect_refused<UsageError>({
      {"this format cannot be written row by row: use .tif",
       [&] { write_rows(grid, file("o.asc"), {}, [](int, int, std::span<float>) {}); }},
  });
  EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

TEST(RasterMessages, ACrsThatIsNotOnTheEarthIsNamed) {
  expect_refused<BadInput>({
      {"the CRS of this model is not understood: ", [] { Geodetic{"SPONGE[1]"}; }},
      {"there is no way from the CRS of this model to WGS 84: ", [] { Geodetic{"LOCAL_CS[\"a table's top\"]"}; }},
  });
}

TEST(RasterMessages, LayersAreChosenByName) {
  register_gdal();
  const DatasetPtr set(GetGDALDriverManager()->GetDriverByName("Memory")->Create("", 0, 0, 0, GDT_Unknown, nullptr));
  ASSERT_TRUE(set);
  const auto choose = [&] { choose_layer(*set, "", "a.gpkg", "--layer"); };
  expect_refused<BadInput>({{"'a.gpkg' holds no layer", choose}});
  set->CreateLayer("roads");
  choose();
  set->CreateLayer("rivers");
  expect_refused<BadInput>({{"'a.gpkg' holds 2 layers: say which one (--layer): ", choose}});
}

}  // namespace
}  // namespace retalho::test
