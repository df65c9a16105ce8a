// GDAL behind one door, for the files of raster/ and cloud/ that call it: registered once, its errors caught, its
// datasets closed, its CRS put into our terms. No GDAL header is included here.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "retalho/raster/georef.h"

class GDALDataset;
class OGRSpatialReference;

namespace retalho {

/// Registers GDAL's drivers once; any number of threads may call it.
void register_gdal();

/// While it lives, GDAL's messages of this thread are kept here instead of being printed.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  bool failed() const { return !errors_.empty(); }
  const std::vector<std::string>& errors() const { return errors_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// The first error, else the first warning, else `otherwise`.
  std::string words(const std::string& otherwise) const;

  void keep(bool error, const char* message);  ///< called by GDAL's handler

 private:
  std::vector<std::string> errors_, warnings_;
};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const;
};
using DatasetPtr = std::unique_ptr<GDALDataset, CloseDataset>;

/// Fills crs_wkt, unit, geographic and scale_* of `georef`. `latitude` (in the CRS's own angular unit) is where metres
/// a degree are taken; used for geographic CRSs only. Returns the CRS's name ("EPSG:32611 WGS 84 / UTM zone 11N") and
/// adds what the user should know to `remarks`. `crs` may be null. Throws BadInput for a latitude at or past a pole.
std::string describe_crs(const OGRSpatialReference* crs, double latitude, Georef& georef,
                         std::vector<std::string>& remarks);

/// The same for a CRS as text: WKT, "EPSG:25832", a PROJ string. Throws BadInput when it is none.
std::string describe_crs_text(const std::string& crs, double latitude, Georef& georef,
                              std::vector<std::string>& remarks);

/// `path` for a message: itself, or "the VRT given as text" when it is one.
std::string name_for_message(const std::string& path);

}  // namespace retalho
