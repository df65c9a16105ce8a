#include "retalho/level/write_vector.h"

#include <cpl_vsi.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/raster/checked_files.h"
#include "retalho/raster/gdal.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

struct Format {
  const char* ending;
  const char* driver;
};
constexpr Format kFormats[] = {
    {".gpkg", "GPKG"}, {".geojson", "GeoJSON"}, {".json", "GeoJSON"}, {".shp", "ESRI Shapefile"}, {".dxf", "DXF"}};

std::string driver_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const Format& f : kFormats)
    if (ending == f.ending) return f.driver;
  throw CannotWrite(
      fmt::format("'{}': no vector format of ours ends in '{}': use .gpkg, .geojson, .shp or .dxf", path, ending),
      path);
}

/// Thrown through what gives the features, so that it stops when one could not be written.
struct LayerFailed {};

/// A layer in the making, and the messages that tell whether it went well.
class LayerWriter {
 public:
  LayerWriter(const std::string& file, const std::string& driver_name, const std::string& layer_name,
              OGRwkbGeometryType type, const Georef& georef)
      : driver_name_(driver_name) {
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_name.c_str());
    if (driver == nullptr) throw CannotWrite(fmt::format("this GDAL has no driver {}", driver_name), file);
    dataset_.reset(driver->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    if (!dataset_) return;
    OGRSpatialReference crs;
    const bool has_crs = !georef.crs_wkt.empty() && crs.importFromWkt(georef.crs_wkt.c_str()) == OGRERR_NONE;
    if (has_crs) crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    layer_ = dataset_->CreateLayer(layer_name.c_str(), has_crs ? &crs : nullptr, type, nullptr);
    if (dataset_->TestCapability(ODsCTransactions)) dataset_->StartTransaction();
    in_transaction_ = true;
  }

  bool dxf() const { return driver_name_ == "DXF"; }
  bool usable() const { return layer_ != nullptr; }

  void field(const char* name, OGRFieldType type) {
    if (layer_ == nullptr || dxf()) return;  // DXF has its own fields
    OGRFieldDefn definition(name, type);
    if (type == OFTReal && driver_name_ == "ESRI Shapefile") {
      definition.SetWidth(18);
      definition.SetPrecision(6);
    }
    ok_ = layer_->CreateField(&definition) == OGRERR_NONE && ok_;
  }
  void add(const OGRGeometry& geometry, const std::function<void(OGRFeature&)>& fill) {
    if (!usable()) return;
    const OGRFeatureUniquePtr feature(OGRFeature::CreateFeature(layer_->GetLayerDefn()));
    fill(*feature);
    ok_ = feature->SetGeometry(&geometry) == OGRERR_NONE && layer_->CreateFeature(feature.get()) == OGRERR_NONE && ok_;
  }
  bool ok() const { return ok_; }
  /// Closing may fail as well: GDAL says so through its messages only.
  void close() {
    if (dataset_ && in_transaction_ && dataset_->TestCapability(ODsCTransactions))
      ok_ = dataset_->CommitTransaction() == OGRERR_NONE && ok_;
    dataset_.reset();
  }

 private:
  std::string driver_name_;
  DatasetPtr dataset_;
  OGRLayer* layer_ = nullptr;
  bool ok_ = true, in_transaction_ = false;
};

/// Makes `file` with `driver` and `fill`. Throws CannotWrite, naming `path`.
void make_layer(const std::string& file, const std::string& path, const std::string& driver,
                const std::string& layer_name, OGRwkbGeometryType type, const Georef& georef,
                const std::function<void(LayerWriter&)>& fill) {
  const GdalMessages messages;
  LayerWriter writer(file, driver, layer_name, type, georef);
  try {
    if (writer.usable()) fill(writer);
  } catch (const LayerFailed&) {  // NOLINT(bugprone-empty-catch): writer.ok() says so
  }
  writer.close();
  VSIStatBufL found;
  if (messages.failed() || !writer.usable() || !writer.ok() || VSIStatL(file.c_str(), &found) != 0)
    throw CannotWrite(fmt::format("cannot write '{}' as {}: {}", path, driver, messages.words("no reason was given")),
                      path);
}

void write_layer(const std::string& path, const std::string& layer_name, OGRwkbGeometryType type, const Georef& georef,
                 bool overwrite, const std::function<void(LayerWriter&)>& fill) {
  register_gdal();
  const std::string driver = driver_of(path);
  AtomicFile file(path, overwrite);  // before the work, so that a name which cannot be written is said at once
  if (MemoryFile::serves(driver)) {
    const MemoryFile memory(fs::path(path).extension().string());
    make_layer(memory.name(), path, driver, layer_name, type, georef, fill);
    write_file(path, memory.bytes(), overwrite);
    return;
  }
  const CheckedFiles checked;
  const std::string name = CheckedFiles::serves(driver) ? checked.name(file.temporary()) : file.temporary();
  make_layer(name, path, driver, layer_name, type, georef, fill);
  if (checked.error() != 0)
    throw CannotWrite(fmt::format("cannot write '{}': {}", path, std::strerror(checked.error())), path);
  file.commit();
}

std::string stem_of(const std::string& path) {
  return fs::path(path).stem().string();
}

void append(OGRLinearRing& ring, const std::vector<Vec2>& points, const Georef& georef) {
  // Shells counter-clockwise, as RFC 7946 and OGC want them; GDAL turns them round for Shapefiles.
  ring.setNumPoints(static_cast<int>(points.size() + 1), FALSE);
  for (std::size_t i = 0; i <= points.size(); ++i) {
    const Vec2 p = georef.to_crs(points[i % points.size()]);
    ring.setPoint(static_cast<int>(i), p.x, p.y);
  }
}

void add_line(LayerWriter& writer, const ContourSet& set, const ContourLine& line, bool dxf, const Georef& georef,
              const VectorOptions& options) {
  const double height = set.levels[static_cast<std::size_t>(line.level)];
  const bool index = is_index_level(set.levels, line.level, options);
  OGRLineString geometry;
  const std::size_t n = line.end - line.begin, count = n + (line.closed ? 1 : 0);
  geometry.setNumPoints(static_cast<int>(count), FALSE);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec2 p = georef.to_crs(set.points[line.begin + i % n]);
    if (dxf)
      geometry.setPoint(static_cast<int>(i), p.x, p.y, height);
    else
      geometry.setPoint(static_cast<int>(i), p.x, p.y);
  }
  writer.add(geometry, [&](OGRFeature& feature) {
    if (dxf) {
      feature.SetField("Layer", index ? "contour_index" : "contour");
    } else {
      feature.SetField("elev", height);
      feature.SetField("index", index ? 1 : 0);
      feature.SetField("closed", line.closed ? 1 : 0);
    }
  });
}

}  // namespace

bool is_index_level(const std::vector<double>& levels, int level, const VectorOptions& options) {
  if (options.index_every <= 0) return false;
  const double place =
      options.interval > 0
          ? std::round((levels[static_cast<std::size_t>(level)] - options.index_base) / options.interval)
          : level;
  return std::fmod(place, options.index_every) == 0;
}

void write_contours(const Georef& georef, const std::string& path, const VectorOptions& options, const Context& context,
                    const std::function<void(const TakeContours&)>& trace) {
  const std::string driver = driver_of(path);
  const bool dxf = driver == "DXF";
  const std::string layer = driver == "ESRI Shapefile" ? stem_of(path) : dxf ? "entities" : "contours";
  write_layer(path, layer, dxf ? wkbLineString25D : wkbLineString, georef, options.overwrite, [&](LayerWriter& writer) {
    writer.field("elev", OFTReal);
    writer.field("index", OFTInteger);
    writer.field("closed", OFTInteger);
    std::size_t done = 0;
    trace([&](const ContourSet& set) {
      for (const ContourLine& line : set.lines) {
        if (++done % 1024 == 0) context.check();
        add_line(writer, set, line, dxf, georef, options);
        if (!writer.ok()) throw LayerFailed();
      }
    });
  });
}

void write_contours(const ContourSet& set, const Georef& georef, const std::string& path, const VectorOptions& options,
                    const Context& context) {
  write_contours(georef, path, options, context, [&](const TakeContours& take) { take(set); });
}

void write_bands(const BandSet& bands, const Georef& georef, const std::string& path, const VectorOptions& options,
                 const Context& context) {
  const std::string driver = driver_of(path);
  if (driver == "DXF")
    throw CannotWrite(fmt::format("'{}': DXF has no polygons: use .gpkg, .geojson or .shp", path), path);
  const std::string layer = driver == "ESRI Shapefile" ? stem_of(path) : "bands";
  write_layer(path, layer, wkbPolygon, georef, options.overwrite, [&](LayerWriter& writer) {
    writer.field("band", OFTInteger);
    writer.field("elev_min", OFTReal);
    writer.field("elev_max", OFTReal);
    for (const BandPolygon& polygon : bands.polygons) {
      context.check();
      OGRPolygon geometry;
      OGRLinearRing ring;
      append(ring, polygon.outer.points, georef);
      geometry.addRing(&ring);
      for (const BandRing& hole : polygon.holes) {
        OGRLinearRing inner;
        append(inner, hole.points, georef);
        geometry.addRing(&inner);
      }
      writer.add(geometry, [&](OGRFeature& feature) {
        feature.SetField("band", polygon.band);
        const auto band = static_cast<std::size_t>(polygon.band);
        if (band > 0) feature.SetField("elev_min", bands.levels[band - 1]);
        if (band < bands.levels.size()) feature.SetField("elev_max", bands.levels[band]);
      });
      if (!writer.ok()) return;
    }
  });
}

}  // namespace retalho
