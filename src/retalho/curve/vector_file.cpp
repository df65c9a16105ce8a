#include "retalho/curve/vector_file.h"

#include <cpl_error.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cstring>
#include <filesystem>
#include <memory>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/raster/checked_files.h"
#include "retalho/raster/gdal.h"
#include "retalho/raster/vector_layer.h"

namespace retalho {

namespace {

using Dataset = std::unique_ptr<GDALDataset, void (*)(GDALDataset*)>;

void add_line(const OGRLineString& line, bool ring, const std::string& name, std::vector<VectorLine>& out) {
  if (line.getNumPoints() < 2) return;
  VectorLine v{name, {}, line.Is3D() ? 3 : 2, ring || line.get_IsClosed() != 0};
  for (int i = 0; i < line.getNumPoints(); ++i)
    v.points.push_back({line.getX(i), line.getY(i), line.Is3D() ? line.getZ(i) : 0});
  if (v.closed && v.points.size() > 2 && v.points.front() == v.points.back()) v.points.pop_back();
  out.push_back(std::move(v));
}

void add_geometry(const OGRGeometry* geometry, const std::string& name, LineLayer& out) {
  if (!geometry) return;
  std::unique_ptr<OGRGeometry> linear;
  if (geometry->hasCurveGeometry()) {
    linear.reset(geometry->getLinearGeometry());
    geometry = linear.get();
  }
  switch (wkbFlatten(geometry->getGeometryType())) {
    case wkbLineString:
      add_line(*geometry->toLineString(), false, name, out.lines);
      break;
    case wkbPolygon:
      for (const auto* ring : *geometry->toPolygon()) add_line(*ring, true, name, out.lines);
      break;
    case wkbMultiLineString:
    case wkbMultiPolygon:
    case wkbGeometryCollection:
      for (const auto* part : *geometry->toGeometryCollection()) add_geometry(part, name, out);
      break;
    default:
      ++out.others;
  }
}

void add_layer(OGRLayer& layer, LineLayer& out, const Context& context) {
  std::size_t features = 0;
  for (const auto& feature : layer) {
    if (features++ % 4096 == 0) context.check();
    const int field = feature->GetFieldIndex("name");
    add_geometry(feature->GetGeometryRef(), field >= 0 ? feature->GetFieldAsString(field) : "", out);
  }
}

void check_lines(const LineLayer& lines, const std::string& path, const GdalMessages& messages) {
  if (messages.failed())
    throw CannotRead(fmt::format("'{}' is damaged or cut off: {}", path, messages.words("")), path);
  if (lines.lines.empty()) throw BadInput(fmt::format("'{}' holds no line and no polygon", path), path);
}

struct Format {
  const char* ending;
  const char* driver;
};
constexpr Format kFormats[] = {{".gpkg", "GPKG"}, {".geojson", "GeoJSON"}, {".shp", "ESRI Shapefile"}, {".dxf", "DXF"}};

std::string gdal_message() {
  const std::string message = CPLGetLastErrorMsg();
  return message.empty() ? "GDAL gives no reason" : message;
}

void write_lines(GDALDriver& driver, const std::vector<VectorLine>& lines, const std::string& file,
                 const std::string& path, bool geojson, bool attributes) {
  const Dataset data(driver.Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr), [](GDALDataset* d) { GDALClose(d); });
  if (!data) throw CannotWrite(fmt::format("cannot write: {}", gdal_message()), path);
  bool space = false;
  for (const VectorLine& l : lines) space = space || l.dimension == 3;
  char** layer_options = nullptr;
  if (geojson) layer_options = CSLSetNameValue(layer_options, "COORDINATE_PRECISION", "17");
  OGRLayer* layer = data->CreateLayer("curves", nullptr, space ? wkbLineString25D : wkbLineString, layer_options);
  CSLDestroy(layer_options);
  if (!layer) throw CannotWrite(fmt::format("cannot write: {}", gdal_message()), path);
  OGRFieldDefn field("name", OFTString);
  if (attributes && layer->CreateField(&field) != OGRERR_NONE)
    throw CannotWrite(fmt::format("cannot write: {}", gdal_message()), path);
  for (const VectorLine& l : lines) {
    const std::unique_ptr<OGRFeature> feature(OGRFeature::CreateFeature(layer->GetLayerDefn()));
    OGRLineString line;
    const auto add = [&](Vec3 p) { space ? line.addPoint(p.x, p.y, p.z) : line.addPoint(p.x, p.y); };
    for (const Vec3& p : l.points) add(p);
    if (l.closed && !(l.points.front() == l.points.back())) add(l.points.front());
    if (attributes) feature->SetField("name", l.name.c_str());
    feature->SetGeometry(&line);
    if (layer->CreateFeature(feature.get()) != OGRERR_NONE)
      throw CannotWrite(fmt::format("cannot write: {}", gdal_message()), path);
  }
}

}  // namespace

std::vector<VectorLine> read_vector_lines(const std::string& path) {
  const GdalMessages messages;
  const DatasetPtr data = open_vector(path, "lines", messages);
  LineLayer all;
  for (OGRLayer* layer : data->GetLayers()) add_layer(*layer, all, {});
  check_lines(all, path, messages);
  return std::move(all.lines);
}

LineLayer read_line_layer(const std::string& path, const std::string& layer_name, const char* option,
                          const Context& context) {
  const GdalMessages messages;
  const DatasetPtr data = open_vector(path, "lines", messages);
  OGRLayer& layer = choose_layer(*data, layer_name, path, option);
  LineLayer all;
  all.crs_wkt = layer_wkt(layer);
  add_layer(layer, all, context);
  check_lines(all, path, messages);
  return all;
}

void write_vector_lines(const std::vector<VectorLine>& lines, const std::string& path, bool overwrite) {
  register_gdal();
  const Format* format = nullptr;
  for (const Format& f : kFormats)
    if (path.ends_with(f.ending)) format = &f;
  if (!format) throw UsageError("a vector file's name must end in .gpkg, .geojson, .shp or .dxf", path);
  if (lines.empty()) throw UsageError("there is no line to write", path);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(format->driver);
  if (!driver) throw CannotWrite(fmt::format("this GDAL has no driver {}", format->driver), path);
  const std::string kind = format->driver;
  AtomicFile file(path, overwrite);
  const MemoryFile memory(format->ending);
  const CheckedFiles checked;
  const std::string name = MemoryFile::serves(kind)     ? memory.name()
                           : CheckedFiles::serves(kind) ? checked.name(file.temporary())
                                                        : file.temporary();
  {
    const GdalMessages messages;
    write_lines(*driver, lines, name, path, kind == "GeoJSON", kind != "DXF");
    if (messages.failed()) throw CannotWrite(fmt::format("cannot write: {}", messages.words("")), path);
  }
  if (checked.error() != 0)
    throw CannotWrite(fmt::format("cannot write '{}': {}", path, std::strerror(checked.error())), path);
  if (MemoryFile::serves(kind)) return write_file(path, memory.bytes(), overwrite);
  file.commit();
}

}  // namespace retalho
