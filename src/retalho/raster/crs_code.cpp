#include "retalho/raster/crs_code.h"

#include <fmt/format.h>
#include <ogr_spatialref.h>

#include <cstdlib>
#include <string_view>

#include "retalho/core/error.h"
#include "retalho/raster/gdal.h"

namespace retalho {

std::string wkt_of_epsg(int code) {
  Georef georef;
  std::vector<std::string> remarks;
  describe_crs_text(fmt::format("EPSG:{}", code), 0, georef, remarks);
  return georef.crs_wkt;
}

int epsg_named_by(const std::string& wkt) {
  if (wkt.empty()) return 0;
  register_gdal();
  const GdalMessages messages;
  OGRSpatialReference crs;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) return 0;
  const char* authority = crs.GetAuthorityName(nullptr);
  const char* code = crs.GetAuthorityCode(nullptr);
  if (!authority || !code || std::string_view(authority) != "EPSG") return 0;
  return std::atoi(code);
}

int epsg_of(const std::string& wkt) {
  const int number = epsg_named_by(wkt);
  if (number == 0) return 0;
  try {
    return wkt_of_epsg(number) == wkt ? number : 0;
  } catch (const Error&) {
    return 0;
  }
}

}  // namespace retalho
