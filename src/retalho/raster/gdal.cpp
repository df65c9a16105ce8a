#include "retalho/raster/gdal.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <fmt/format.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <numbers>
#include <string_view>
#include <thread>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr std::size_t kKept = 20;  // messages kept of each kind: a damaged file can cause one a block

void CPL_STDCALL handle(CPLErr level, CPLErrorNum, const char* message) {
  if (level == CE_Debug || level == CE_None) return;
  static_cast<GdalMessages*>(CPLGetErrorHandlerUserData())->keep(level >= CE_Failure, message);
}

struct CplFree {
  void operator()(char* text) const { CPLFree(text); }
};

std::string to_wkt(const OGRSpatialReference& crs) {
  for (const char* format : {"FORMAT=WKT2_2019", "FORMAT=WKT1_GDAL"}) {
    char* text = nullptr;
    const char* const options[] = {format, nullptr};
    const OGRErr outcome = crs.exportToWkt(&text, options);
    const std::unique_ptr<char, CplFree> owner(text);
    if (outcome == OGRERR_NONE && text && *text) return text;
  }
  return {};
}

/// The WKT of an EPSG code; empty: PROJ knows none. What PROJ writes depends on what the thread has asked it before
/// (once a GeoTIFF was read, datum ensembles become datums), so a thread is asked that has not asked anything. Kept, as
/// it takes some milliseconds and never changes.
std::string standard_wkt(int code) {
  static std::mutex mutex;
  static std::map<int, std::string> known;
  const std::lock_guard lock(mutex);
  if (const auto found = known.find(code); found != known.end()) return found->second;
  std::string& text = known[code];
  std::thread fresh([&] {
    const GdalMessages quiet;
    OGRSpatialReference crs;
    if (crs.importFromEPSG(code) == OGRERR_NONE) text = to_wkt(crs);
  });
  fresh.join();
  return text;
}

/// The CRS as text, by its EPSG code where it has one and is what the code says: the same text from every file, thread
/// and order of work.
std::string canonical_wkt(const OGRSpatialReference& crs) {
  const char* authority = crs.GetAuthorityName(nullptr);
  const char* code = crs.GetAuthorityCode(nullptr);
  if (authority && code && std::string_view(authority) == "EPSG") {
    const std::string text = standard_wkt(std::atoi(code));
    OGRSpatialReference standard;
    if (!text.empty() && standard.importFromWkt(text.c_str()) == OGRERR_NONE && crs.IsSame(&standard) != 0) return text;
  }
  return to_wkt(crs);
}

std::string unit_name(double factor, const char* name) {
  if (factor == 1.0) return "metre";
  if (std::abs(factor / 0.3048 - 1) < 1e-9) return "foot";
  if (std::abs(factor / (1200.0 / 3937.0) - 1) < 1e-9) return "US survey foot";
  return name && *name ? name : fmt::format("{} m", factor);
}

/// "EPSG:32611 WGS 84 / UTM zone 11N"; a CRS without a code gets that of the standard CRS that it equals, if any.
std::string crs_title(const OGRSpatialReference& crs) {
  const auto title = [](const OGRSpatialReference& known) -> std::string {
    const char* authority = known.GetAuthorityName(nullptr);
    const char* code = known.GetAuthorityCode(nullptr);
    return authority && code ? fmt::format("{}:{} {}", authority, code, known.GetName()) : std::string();
  };
  if (std::string named = title(crs); !named.empty()) return named;
  const std::unique_ptr<OGRSpatialReference> copy(crs.Clone());
  const char* code = copy->AutoIdentifyEPSG() == OGRERR_NONE ? copy->GetAuthorityCode(nullptr) : nullptr;
  OGRSpatialReference standard;
  if (code && standard.importFromEPSG(std::atoi(code)) == OGRERR_NONE) return title(standard);
  return crs.GetName() ? crs.GetName() : "unnamed CRS";
}

}  // namespace

void register_gdal() {
  static std::once_flag once;
  std::call_once(once, [] { GDALAllRegister(); });
}

GdalMessages::GdalMessages() {
  CPLPushErrorHandlerEx(handle, this);
}
GdalMessages::~GdalMessages() {
  CPLPopErrorHandler();
}

void GdalMessages::keep(bool error, const char* message) {
  std::vector<std::string>& list = error ? errors_ : warnings_;
  if (list.size() < kKept && std::find(list.begin(), list.end(), message) == list.end()) list.emplace_back(message);
}

std::string GdalMessages::words(const std::string& otherwise) const {
  if (!errors_.empty()) return errors_.front();
  return warnings_.empty() ? otherwise : warnings_.front();
}

void CloseDataset::operator()(GDALDataset* dataset) const {
  GDALClose(dataset);
}

std::string describe_crs(const OGRSpatialReference* crs, double latitude, Georef& georef,
                         std::vector<std::string>& remarks) {
  if (!crs || crs->IsEmpty()) return {};
  georef.crs_wkt = canonical_wkt(*crs);
  georef.geographic = crs->IsGeographic() != 0;
  const char* name = nullptr;
  if (!georef.geographic) {
    georef.unit = unit_name(crs->GetLinearUnits(&name), name);
    return crs_title(*crs);
  }
  // Radii of curvature of the ellipsoid: along the meridian and across it (closed forms; no series needed).
  const double radians = crs->GetAngularUnits(&name);
  const double phi = latitude * radians;
  if (!(std::abs(phi) < std::numbers::pi / 2 * (1 - 1e-9)))
    throw BadInput(
        fmt::format("the CRS '{}' is in degrees, but the middle of the data lies at latitude {}: "
                    "give the right CRS (gdal_translate -a_srs), or project the data (gdalwarp -t_srs)",
                    crs->GetName(), latitude));
  OGRErr outcome = OGRERR_NONE;
  const double a = crs->GetSemiMajor(&outcome);
  const double inverse = crs->GetInvFlattening(&outcome);
  const double f = inverse > 0 ? 1 / inverse : 0;
  const double e2 = f * (2 - f), s = std::sin(phi), w2 = 1 - e2 * s * s;
  georef.scale_y = radians * a * (1 - e2) / (w2 * std::sqrt(w2));
  georef.scale_x = radians * a / std::sqrt(w2) * std::cos(phi);
  georef.unit = "metre";
  remarks.push_back(
      fmt::format("geographic CRS: distances are metres by the latitude {:.6g} of the middle "
                  "({:.7g} m a degree east, {:.7g} m north)",
                  phi * 180 / std::numbers::pi, georef.scale_x / radians * std::numbers::pi / 180,
                  georef.scale_y / radians * std::numbers::pi / 180));
  return crs_title(*crs);
}

std::string describe_crs_text(const std::string& crs, double latitude, Georef& georef,
                              std::vector<std::string>& remarks) {
  register_gdal();
  const GdalMessages messages;
  OGRSpatialReference known;
  if (known.SetFromUserInput(crs.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) != OGRERR_NONE)
    throw BadInput(fmt::format("'{}' is not a CRS: give a code as EPSG:25832, or WKT ({})", crs.substr(0, 80),
                               messages.words("unknown")));
  return describe_crs(&known, latitude, georef, remarks);
}

std::string name_for_message(const std::string& path) {
  return path.find("<VRTDataset") != std::string::npos ? "the VRT given as text" : path;
}

}  // namespace retalho
