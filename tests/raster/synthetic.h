// Small rasters made with GDAL, for what the reader must cope with.
#pragma once

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace retalho::test {

struct MadeRaster {
  std::string driver = "GTiff";
  int columns = 4, rows = 3;
  GDALDataType type = GDT_Float32;
  std::vector<double> values = {};  ///< rows of the file; written in `type`
  std::array<double, 6> transform{100, 10, 0, 500, 0, -10};
  std::string crs = "EPSG:32611";  ///< empty: none
  bool placed = true;
  std::function<void(GDALDataset&)> more = {};  ///< anything else, before the values are written
  std::vector<const char*> options = {};
};

/// Makes `path` as told and closes it.
inline std::string make_raster(const std::string& path, const MadeRaster& made) {
  GDALAllRegister();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(made.driver.c_str());
  std::vector<const char*> options = made.options;
  options.push_back(nullptr);
  GDALDataset* dataset =
      driver->Create(path.c_str(), made.columns, made.rows, 1, made.type, const_cast<char**>(options.data()));
  if (dataset == nullptr) throw std::runtime_error("cannot make " + path);
  if (made.placed) {
    std::array<double, 6> transform = made.transform;
    dataset->SetGeoTransform(transform.data());
  }
  if (!made.crs.empty()) {
    OGRSpatialReference crs;
    crs.SetFromUserInput(made.crs.c_str());
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    dataset->SetSpatialRef(&crs);
  }
  if (made.more) made.more(*dataset);
  if (!made.values.empty()) {
    EXPECT_EQ(made.values.size(), static_cast<std::size_t>(made.columns) * static_cast<std::size_t>(made.rows));
    const auto write = [&](auto values, GDALDataType type) {
      EXPECT_EQ(dataset->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, made.columns, made.rows, values.data(),
                                                    made.columns, made.rows, type, 0, 0, nullptr),
                CE_None);
    };
    // GDAL rounds large doubles on their way to 64-bit integers: these go as what they are.
    if (made.type == GDT_Int64 || made.type == GDT_UInt64)
      write(std::vector<std::int64_t>(made.values.begin(), made.values.end()), GDT_Int64);
    else
      write(made.values, GDT_Float64);
  }
  GDALClose(dataset);
  return path;
}

}  // namespace retalho::test
