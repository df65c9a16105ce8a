#include "retalho/raster/geodetic.h"

#include <ogr_spatialref.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/raster/gdal.h"

namespace retalho {
namespace {

struct Destroy {
  void operator()(OGRCoordinateTransformation* t) const { OGRCoordinateTransformation::DestroyCT(t); }
};
using Transformation = std::unique_ptr<OGRCoordinateTransformation, Destroy>;

void transform(OGRCoordinateTransformation& by, std::span<Vec2> points) {
  const GdalMessages messages;  // of points that it cannot convert
  std::vector<double> x(points.size()), y(points.size());
  std::vector<int> ok(points.size(), 0);
  for (std::size_t k = 0; k < points.size(); ++k) {
    x[k] = points[k].x;
    y[k] = points[k].y;
  }
  by.Transform(static_cast<int>(points.size()), x.data(), y.data(), nullptr, ok.data());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < points.size(); ++k)
    points[k] = ok[k] != 0 && std::isfinite(x[k]) && std::isfinite(y[k]) ? Vec2{x[k], y[k]} : Vec2{kNan, kNan};
}

}  // namespace

struct Geodetic::Parts {
  Transformation there, back;
};

Geodetic::Geodetic(const std::string& crs_wkt) : parts_(std::make_unique<Parts>()) {
  if (crs_wkt.empty()) throw BadInput("a place on the globe needs a CRS, and this model has none");
  register_gdal();
  const GdalMessages messages;
  OGRSpatialReference crs, degrees;
  degrees.SetWellKnownGeogCS("WGS84");
  if (crs.importFromWkt(crs_wkt.c_str()) != OGRERR_NONE)
    throw BadInput("the CRS of this model is not understood: " + messages.words("no reason is known"));
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  degrees.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  parts_->there.reset(OGRCreateCoordinateTransformation(&crs, &degrees));
  parts_->back.reset(OGRCreateCoordinateTransformation(&degrees, &crs));
  if (!parts_->there || !parts_->back)
    throw BadInput("there is no way from the CRS of this model to WGS 84: " + messages.words("no reason is known"));
}
Geodetic::~Geodetic() = default;
Geodetic::Geodetic(Geodetic&&) noexcept = default;
Geodetic& Geodetic::operator=(Geodetic&&) noexcept = default;

void Geodetic::to_degrees(std::span<Vec2> points) const {
  transform(*parts_->there, points);
}

void Geodetic::from_degrees(std::span<Vec2> points) const {
  transform(*parts_->back, points);
}

EastNorthUp east_north_up(Vec2 degrees) {
  const double radians = std::numbers::pi / 180;
  const double sl = std::sin(degrees.x * radians), cl = std::cos(degrees.x * radians);
  const double sp = std::sin(degrees.y * radians), cp = std::cos(degrees.y * radians);
  return {{-sl, cl, 0}, {-sp * cl, -sp * sl, cp}, {cp * cl, cp * sl, sp}};
}

Vec3 earth_centred(Vec2 degrees, double height) {
  const Vec3 up = east_north_up(degrees).up;
  constexpr double a2 = kWgs84Equator * kWgs84Equator, b2 = kWgs84Pole * kWgs84Pole;
  const double scale = 1 / std::sqrt(a2 * (up.x * up.x + up.y * up.y) + b2 * up.z * up.z);
  return Vec3{a2 * scale * up.x, a2 * scale * up.y, b2 * scale * up.z} + height * up;
}

}  // namespace retalho
