#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <limits>
#include <memory>

#include "retalho/cloud/breaklines.h"
#include "retalho/cloud/vector_layer.h"
#include "retalho/core/error.h"

namespace retalho {
namespace {

void add_line(const OGRSimpleCurve& line, BreaklineFile& file) {
  std::vector<Vec3> points;
  points.reserve(static_cast<std::size_t>(line.getNumPoints()));
  for (int k = 0; k < line.getNumPoints(); ++k)
    points.push_back(
        {line.getX(k), line.getY(k), line.Is3D() ? line.getZ(k) : std::numeric_limits<double>::quiet_NaN()});
  if (points.size() > 1) file.lines.push_back(std::move(points));
}

void add(const OGRGeometry* geometry, BreaklineFile& file) {
  std::unique_ptr<OGRGeometry> flattened;
  if (geometry->hasCurveGeometry()) {
    flattened.reset(geometry->getLinearGeometry());
    geometry = flattened.get();
  }
  switch (wkbFlatten(geometry->getGeometryType())) {
    case wkbLineString:
      return add_line(*geometry->toLineString(), file);
    case wkbPolygon:
      for (const OGRLinearRing* ring : *geometry->toPolygon()) add_line(*ring, file);
      return;
    case wkbMultiLineString:
    case wkbMultiPolygon:
    case wkbGeometryCollection:
      for (const OGRGeometry* part : *geometry->toGeometryCollection()) add(part, file);
      return;
    default:
      ++file.others;
  }
}

}  // namespace

BreaklineFile read_breaklines(const std::string& path, const std::string& layer_name, const Context& context) {
  const GdalMessages messages;
  const DatasetPtr dataset = open_vector(path, "breaklines", messages);
  OGRLayer& layer = choose_layer(*dataset, layer_name, path, "--breakline-layer");
  BreaklineFile file;
  file.crs_wkt = layer_wkt(layer);
  std::size_t features = 0;
  for (OGRFeatureUniquePtr feature(layer.GetNextFeature()); feature; feature.reset(layer.GetNextFeature())) {
    if (features++ % 4096 == 0) context.check();
    if (const OGRGeometry* geometry = feature->GetGeometryRef()) add(geometry, file);
  }
  if (messages.failed())
    throw CannotRead(fmt::format("'{}' is damaged or cut off: {} (feature {})", path, messages.words(""), features),
                     path, fmt::format("feature {}", features));
  if (file.lines.empty())
    throw BadInput(fmt::format("'{}' holds no line: breaklines are lines or polygons", path), path);
  return file;
}

}  // namespace retalho
