// A vector file and its layers, opened through GDAL: for the readers of points (cloud/) and of lines (curve/).
#pragma once

#include <string>

#include "retalho/raster/gdal.h"

class GDALDataset;
class OGRLayer;

namespace retalho {

/// Throws CannotRead, which says that the file was wanted as `what`.
DatasetPtr open_vector(const std::string& path, const char* what, const GdalMessages& messages);
/// The named layer, or the only one. Throws BadInput; `option` is how the user names a layer.
OGRLayer& choose_layer(GDALDataset& dataset, const std::string& wanted, const std::string& path, const char* option);
/// Its CRS as WKT; empty when it has none.
std::string layer_wkt(OGRLayer& layer);

}  // namespace retalho
