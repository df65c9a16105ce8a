// Points of vector layers through GDAL.
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cmath>

#include "retalho/cloud/formats.h"
#include "retalho/core/error.h"
#include "retalho/raster/vector_layer.h"

namespace retalho {
namespace {

std::string numeric_fields(OGRFeatureDefn& definition) {
  std::string list;
  for (int k = 0; k < definition.GetFieldCount(); ++k) {
    const OGRFieldType type = definition.GetFieldDefn(k)->GetType();
    if (type == OFTInteger || type == OFTInteger64 || type == OFTReal)
      list += fmt::format("{}'{}'", list.empty() ? "" : ", ", definition.GetFieldDefn(k)->GetNameRef());
  }
  return list.empty() ? "none" : list;
}

int height_field(OGRFeatureDefn& definition, const std::string& name, const std::string& path) {
  if (name.empty()) return -1;
  const int index = definition.GetFieldIndex(name.c_str());
  if (index < 0)
    throw BadInput(
        fmt::format("'{}' has no attribute '{}'; its numeric attributes: {}", path, name, numeric_fields(definition)),
        path, name);
  const OGRFieldType type = definition.GetFieldDefn(index)->GetType();
  if (type != OFTInteger && type != OFTInteger64 && type != OFTReal)
    throw BadInput(fmt::format("'{}': the attribute '{}' is not a number; numeric ones: {}", path, name,
                               numeric_fields(definition)),
                   path, name);
  return index;
}

class Collector {
 public:
  Collector(PointCloud& cloud, PointNotes& notes) : cloud_(cloud), notes_(notes) {}

  /// `height`: the attribute's value, or null to take the geometry's z.
  void add(const OGRGeometry& geometry, const double* height) {
    switch (wkbFlatten(geometry.getGeometryType())) {
      case wkbPoint: {
        const OGRPoint& p = *geometry.toPoint();
        if (!p.IsEmpty()) point(p.getX(), p.getY(), p.getZ(), p.Is3D(), height);
        return;
      }
      case wkbLineString:
      case wkbCircularString: {
        const OGRSimpleCurve& line = *geometry.toSimpleCurve();
        for (int k = 0; k < line.getNumPoints(); ++k)
          point(line.getX(k), line.getY(k), line.getZ(k), line.Is3D(), height);
        return;
      }
      case wkbMultiPoint:
      case wkbMultiLineString:
      case wkbGeometryCollection: {
        for (const OGRGeometry* part : *geometry.toGeometryCollection()) add(*part, height);
        return;
      }
      default:
        ++others_;
    }
  }

  std::size_t flat() const { return flat_; }
  std::size_t others() const { return others_; }

 private:
  void point(double x, double y, double z, bool has_z, const double* height) {
    if (!height && !has_z) {
      ++flat_;
      return;
    }
    if (height) z = *height;
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z))
      cloud_.positions.push_back({x, y, z});
    else
      ++notes_.skipped;
  }

  PointCloud& cloud_;
  PointNotes& notes_;
  std::size_t flat_ = 0, others_ = 0;
};

}  // namespace

void read_vector_points(const std::string& path, const PointOptions& options, PointCloud& cloud, PointNotes& notes,
                        std::string& crs_wkt, const Context& context) {
  const GdalMessages messages;
  const DatasetPtr dataset = open_vector(path, "points", messages);
  OGRLayer& layer = choose_layer(*dataset, options.layer, path, "--layer");
  OGRFeatureDefn& definition = *layer.GetLayerDefn();
  const int field = height_field(definition, options.height_field, path);
  notes.format = dataset->GetDriverName();
  crs_wkt = layer_wkt(layer);

  Collector collector(cloud, notes);
  std::size_t features = 0, without_height = 0;
  for (OGRFeatureUniquePtr feature(layer.GetNextFeature()); feature; feature.reset(layer.GetNextFeature())) {
    if (features++ % 4096 == 0) context.check();
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (!geometry) continue;
    if (field >= 0 && !feature->IsFieldSetAndNotNull(field)) {
      ++without_height;
      continue;
    }
    const double height = field >= 0 ? feature->GetFieldAsDouble(field) : 0;
    collector.add(*geometry, field >= 0 ? &height : nullptr);
  }
  if (messages.failed())
    throw CannotRead(fmt::format("'{}' is damaged or cut off: {} (feature {})", path, messages.words(""), features),
                     path, fmt::format("feature {}", features));
  notes.skipped += without_height;
  if (collector.flat() > 0)
    throw BadInput(
        fmt::format(
            "'{}': {} points have no z: name the attribute that holds the height (--height-field); numeric ones: {}",
            path, collector.flat(), numeric_fields(definition)),
        path);
  if (without_height > 0)
    notes.remarks.push_back(
        fmt::format("{} features without a value of '{}' are left out", without_height, options.height_field));
  if (collector.others() > 0)
    notes.remarks.push_back(
        fmt::format("{} geometries that are neither points nor lines are left out", collector.others()));
  notes.columns = field >= 0 ? fmt::format("height from the attribute '{}'", options.height_field)
                             : "height from the geometries' z";
  for (const std::string& warning : messages.warnings()) notes.remarks.push_back("GDAL: " + warning);
}

}  // namespace retalho
