#include "retalho/raster/vector_layer.h"

#include <cpl_conv.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <filesystem>

#include "retalho/core/error.h"

namespace retalho {
namespace {

std::string layer_names(GDALDataset& dataset) {
  std::string list;
  for (int k = 0; k < dataset.GetLayerCount(); ++k)
    list += fmt::format("{}'{}'", k ? ", " : "", dataset.GetLayer(k)->GetName());
  return list;
}

}  // namespace

OGRLayer& choose_layer(GDALDataset& dataset, const std::string& wanted, const std::string& path, const char* option) {
  if (!wanted.empty()) {
    if (OGRLayer* layer = dataset.GetLayerByName(wanted.c_str())) return *layer;
    throw BadInput(fmt::format("'{}' has no layer '{}': it has {}", path, wanted, layer_names(dataset)), path, wanted);
  }
  if (dataset.GetLayerCount() == 0) throw BadInput(fmt::format("'{}' holds no layer", path), path);
  if (dataset.GetLayerCount() > 1)
    throw BadInput(fmt::format("'{}' holds {} layers: say which one ({}): {}", path, dataset.GetLayerCount(), option,
                               layer_names(dataset)),
                   path);
  return *dataset.GetLayer(0);
}

std::string layer_wkt(OGRLayer& layer) {
  const OGRSpatialReference* crs = layer.GetSpatialRef();
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  if (!crs || crs->exportToWkt(&text, options) != OGRERR_NONE) {
    CPLFree(text);
    return {};
  }
  std::string wkt(text);
  CPLFree(text);
  return wkt;
}

DatasetPtr open_vector(const std::string& path, const char* what, const GdalMessages& messages) {
  register_gdal();
  std::error_code ec;
  if (!path.starts_with("/vsi") && path.find(':') == std::string::npos && !std::filesystem::exists(path, ec))
    throw CannotRead(fmt::format("'{}' does not exist", path), path);
  DatasetPtr dataset(static_cast<GDALDataset*>(
      GDALOpenEx(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR, nullptr, nullptr, nullptr)));
  if (!dataset)
    throw CannotRead(fmt::format("cannot read '{}' as {}: {}", path, what, messages.words("GDAL does not open it")),
                     path);
  return dataset;
}

}  // namespace retalho
