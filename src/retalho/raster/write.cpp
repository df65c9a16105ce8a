// write_raster: one band of heights through any GDAL driver that can create or copy, complete or not at all.
#include <cpl_string.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <span>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/raster/checked_files.h"
#include "retalho/raster/gdal.h"
#include "retalho/raster/io.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;
using Rows = std::function<void(int, int, std::span<float>)>;
constexpr int kRowsAtOnce = 256;

bool can(GDALDriver& driver, const char* what) {
  return CPLTestBool(CSLFetchNameValueDef(driver.GetMetadata(), what, "NO"));
}

GDALDriver& choose_driver(const std::string& path, const std::string& wanted) {
  GDALDriverManager& manager = *GetGDALDriverManager();
  if (!wanted.empty()) {
    GDALDriver* driver = manager.GetDriverByName(wanted.c_str());
    if (driver && can(*driver, GDAL_DCAP_RASTER) &&
        (can(*driver, GDAL_DCAP_CREATE) || can(*driver, GDAL_DCAP_CREATECOPY)))
      return *driver;
    throw CannotWrite(fmt::format("GDAL has no raster driver '{}' that writes: gdalinfo --formats lists them", wanted),
                      path);
  }
  std::string extension = fs::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (int k = 0; k < manager.GetDriverCount() && !extension.empty(); ++k) {
    GDALDriver& driver = *manager.GetDriver(k);
    if (std::string(driver.GetDescription()) == "VRT") continue;  // names other files, holds no heights
    if (!can(driver, GDAL_DCAP_RASTER) || !(can(driver, GDAL_DCAP_CREATE) || can(driver, GDAL_DCAP_CREATECOPY)))
      continue;
    const char* known = driver.GetMetadataItem(GDAL_DMD_EXTENSIONS);
    const CPLStringList list(CSLTokenizeString2(known ? known : "", " ", 0));
    if (list.FindString(extension.c_str()) >= 0) return driver;
  }
  throw CannotWrite(
      fmt::format("'{}': no raster format that GDAL writes has the ending '{}': use .tif", path, extension), path);
}

bool is_double(const Raster& raster) {
  return std::holds_alternative<std::vector<double>>(raster.heights);
}

bool takes_nan(const GDALDriver& driver) {
  const std::string name = driver.GetDescription();
  for (const char* able : {"GTiff", "COG", "netCDF", "ENVI", "GPKG", "KEA", "HDF5"})
    if (name == able) return true;
  return false;
}

/// NaN where the driver and other tools understand it, else a value that no height has.
double choose_nodata(const Raster& raster, const GDALDriver& driver) {
  if (takes_nan(driver)) return std::numeric_limits<double>::quiet_NaN();
  return std::visit(
      [](const auto& heights) {
        for (const double candidate : {-9999.0, -32768.0, -99999.0})
          if (std::find(heights.begin(), heights.end(), candidate) == heights.end()) return candidate;
        return -1e30;
      },
      raster.heights);
}

CPLStringList creation_options(const GDALDriver& driver, const Raster& raster, const WriteOptions& options) {
  CPLStringList list;
  for (const std::string& option : options.creation_options) list.AddString(option.c_str());
  if (!options.creation_options.empty() || std::string(driver.GetDescription()) != "GTiff") return list;
  for (const char* option : {"COMPRESS=DEFLATE", "PREDICTOR=3", "BIGTIFF=IF_SAFER"}) list.AddString(option);
  if (raster.columns >= 256 && raster.rows >= 256) list.AddString("TILED=YES");
  return list;
}

void set_facts(GDALDataset& dataset, const Raster& raster, double nodata) {
  const Georef& g = raster.georef;
  const double width = raster.cell_width / g.scale_x, height = raster.cell_height / g.scale_y;
  std::array<double, 6> gt{g.origin_x - 0.5 * width, width, 0, g.origin_y + 0.5 * height, 0, -height};
  dataset.SetGeoTransform(gt.data());
  OGRSpatialReference crs;
  if (!g.crs_wkt.empty() && crs.importFromWkt(g.crs_wkt.c_str()) == OGRERR_NONE) {
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    dataset.SetSpatialRef(&crs);
  }
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  band.SetNoDataValue(nodata);
  if (!raster.height_unit.empty()) band.SetUnitType(raster.height_unit.c_str());
}

/// Rows that are made as they are written.
void put_made_rows(GDALDataset& dataset, const Raster& place, const Rows& make_rows, const GdalMessages& messages,
                   const Context& context) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  std::vector<float> buffer;
  for (int row = 0; row < place.rows; row += kRowsAtOnce) {
    context.check();
    const int rows = std::min(kRowsAtOnce, place.rows - row);
    buffer.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(place.columns));
    make_rows(row, rows, buffer);
    const CPLErr outcome = band.RasterIO(GF_Write, 0, row, place.columns, rows, buffer.data(), place.columns, rows,
                                         GDT_Float32, 0, 0, nullptr);
    if (outcome != CE_None || messages.failed()) return;
    band.FlushCache(false);
    context.report("write", static_cast<double>(row + rows) / place.rows);
  }
}

void put_rows(GDALDataset& dataset, const Raster& raster, double nodata, const GdalMessages& messages,
              const Context& context) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  int block_width = 0, block_height = 1;
  band.GetBlockSize(&block_width, &block_height);
  const auto columns = static_cast<std::size_t>(raster.columns);
  std::visit(
      [&](const auto& heights) {
        using Height = typename std::remove_cvref_t<decltype(heights)>::value_type;
        std::vector<Height> buffer;
        for (int row = 0; row < raster.rows; row += block_height) {
          context.check();
          const int rows = std::min(block_height, raster.rows - row);
          const Height* const from = heights.data() + static_cast<std::size_t>(row) * columns;
          buffer.assign(from, from + columns * static_cast<std::size_t>(rows));
          if (!std::isnan(nodata))
            for (Height& h : buffer)
              if (std::isnan(h)) h = static_cast<Height>(nodata);
          const CPLErr outcome = band.RasterIO(GF_Write, 0, row, raster.columns, rows, buffer.data(), raster.columns,
                                               rows, sizeof(Height) == 8 ? GDT_Float64 : GDT_Float32, 0, 0, nullptr);
          if (outcome != CE_None || messages.failed()) return;  // the caller looks at the messages
          band.FlushCache(false);                               // else GDAL's cache fills with blocks that are done
          context.report("write", static_cast<double>(row + rows) / raster.rows);
        }
      },
      raster.heights);
}

/// Makes `file`, which is `on_disk` without an account, with `driver`; what went wrong is in `messages`.
void make(GDALDriver& driver, const std::string& file, const std::string& on_disk, const Raster& raster,
          const WriteOptions& options, const Rows* made, const GdalMessages& messages, const Context& context) {
  const GDALDataType type = is_double(raster) ? GDT_Float64 : GDT_Float32;
  const CPLStringList list = creation_options(driver, raster, options);
  const double nodata = choose_nodata(raster, driver);
  char** const creation = const_cast<CPLStringList&>(list).List();
  if (can(driver, GDAL_DCAP_CREATE)) {
    const DatasetPtr dataset(driver.Create(file.c_str(), raster.columns, raster.rows, 1, type, creation));
    if (!dataset) return;
    set_facts(*dataset, raster, nodata);
    if (made != nullptr)
      put_made_rows(*dataset, raster, *made, messages, context);
    else
      put_rows(*dataset, raster, nodata, messages, context);
    return;  // closing may fail too: GDAL says so through the messages
  }
  if (made != nullptr) {  // a GeoTIFF on the disk in between, instead of memory
    GDALDriver& tiff = *GetGDALDriverManager()->GetDriverByName("GTiff");
    const std::string between = file + ".rows.tif";
    const auto remove = [&] {
      std::error_code ec;
      fs::remove(on_disk + ".rows.tif", ec);
    };
    {
      const char* const plain[] = {"TILED=YES", "COMPRESS=DEFLATE", "PREDICTOR=3", "BIGTIFF=IF_SAFER", nullptr};
      const DatasetPtr dataset(
          tiff.Create(between.c_str(), raster.columns, raster.rows, 1, type, const_cast<char**>(plain)));
      if (!dataset) return;
      try {
        set_facts(*dataset, raster, nodata);
        put_made_rows(*dataset, raster, *made, messages, context);
      } catch (...) {
        remove();
        throw;
      }
    }
    if (!messages.failed()) {
      const DatasetPtr source(static_cast<GDALDataset*>(GDALOpen(between.c_str(), GA_ReadOnly)));
      if (source) {
        const DatasetPtr copy(driver.CreateCopy(file.c_str(), source.get(), TRUE, creation, nullptr, nullptr));
      }
    }
    remove();
    return;
  }
  GDALDriver& memory = *GetGDALDriverManager()->GetDriverByName("MEM");
  const DatasetPtr source(memory.Create("", raster.columns, raster.rows, 1, type, nullptr));
  if (!source) return;
  set_facts(*source, raster, nodata);
  put_rows(*source, raster, nodata, messages, context);
  const DatasetPtr copy(driver.CreateCopy(file.c_str(), source.get(), TRUE, creation, nullptr, nullptr));
}

/// Some formats have no place for a no-data value: voids would come back as heights.
void check_voids(const Raster& raster, const std::string& file, const std::string& path) {
  const bool has_voids = std::visit(
      [](const auto& heights) {
        return std::any_of(heights.begin(), heights.end(), [](auto h) { return std::isnan(h); });
      },
      raster.heights);
  if (!has_voids) return;
  const GdalMessages messages;
  const DatasetPtr dataset(static_cast<GDALDataset*>(GDALOpen(file.c_str(), GA_ReadOnly)));
  int has_nodata = 0;
  if (dataset && dataset->GetRasterCount() > 0) dataset->GetRasterBand(1)->GetNoDataValue(&has_nodata);
  if (!has_nodata)
    throw CannotWrite(
        fmt::format("'{}': this format has no no-data value, and the raster has void cells: use .tif", path), path);
}

}  // namespace

namespace {

void write(const Raster& raster, const std::string& path, const WriteOptions& options, const Rows* made,
           const Context& context) {
  register_gdal();
  if (raster.columns < 1 || raster.rows < 1)
    throw CannotWrite(fmt::format("'{}': a raster without cells cannot be written", path), path);
  GDALDriver& driver = choose_driver(path, options.driver);
  AtomicFile file(path, options.overwrite);

  // Statistics, masks and overviews beside an old file would be taken for the new one's.
  std::error_code ec;
  std::vector<std::string> leftovers;
  for (const char* tail : {".aux.xml", ".ovr", ".msk"})
    if (fs::exists(path + tail, ec)) leftovers.push_back(path + tail);
  if (!options.overwrite && !leftovers.empty())
    throw CannotWrite(fmt::format("'{}' exists and would be taken as part of '{}': add --overwrite to remove it",
                                  leftovers.front(), path),
                      path);

  const GdalMessages messages;
  const CPLStringList given = creation_options(driver, raster, options);
  if (!GDALValidateCreationOptions(&driver, given.List()))
    throw CannotWrite(fmt::format("cannot write '{}' as {}: {}", path, driver.GetDescription(),
                                  messages.words("a creation option is wrong")),
                      path);
  const CheckedFiles checked;
  const bool counted = CheckedFiles::serves(driver.GetDescription());
  make(driver, counted ? checked.name(file.temporary()) : file.temporary(), file.temporary(), raster, options, made,
       messages, context);
  if (checked.error() != 0)
    throw CannotWrite(fmt::format("cannot write '{}': {}", path, std::strerror(checked.error())), path);
  if (messages.failed() || !fs::exists(file.temporary(), ec))
    throw CannotWrite(fmt::format("cannot write '{}' as {}: {}", path, driver.GetDescription(),
                                  messages.words("no reason was given")),
                      path);
  if (made == nullptr) check_voids(raster, file.temporary(), path);
  for (const std::string& old : leftovers) file.supersede(old);
  file.commit();
}

}  // namespace

void write_raster(const Raster& raster, const std::string& path, const WriteOptions& options, const Context& context) {
  write(raster, path, options, nullptr, context);
}

bool takes_rows(const std::string& path, const WriteOptions& options) {
  register_gdal();
  return takes_nan(choose_driver(path, options.driver));
}

void write_rows(const Raster& place, const std::string& path, const WriteOptions& options,
                const std::function<void(int first, int count, std::span<float> out)>& rows, const Context& context) {
  if (!takes_rows(path, options))
    throw UsageError(fmt::format("'{}': this format cannot be written row by row: use .tif", path), path);
  write(place, path, options, &rows, context);
}

}  // namespace retalho
