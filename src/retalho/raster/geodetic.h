// WGS 84 and the globe: from a CRS to longitudes and latitudes and back (by PROJ, behind GDAL), and from there to
// earth-centred coordinates. For formats of globes.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "retalho/core/vec.h"

namespace retalho {

/// Longitude and latitude, degrees on WGS 84, of coordinates of a CRS, and back. One thread at a time.
class Geodetic {
 public:
  /// Throws BadInput for a text that is no CRS on the earth, or for none.
  explicit Geodetic(const std::string& crs_wkt);
  ~Geodetic();
  Geodetic(Geodetic&&) noexcept;
  Geodetic& operator=(Geodetic&&) noexcept;

  /// In place; x: longitude, easting; y: latitude, northing, whatever order the CRS itself has. Points that cannot be
  /// converted become NaN.
  void to_degrees(std::span<Vec2> points) const;
  void from_degrees(std::span<Vec2> points) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

inline constexpr double kWgs84Equator = 6378137.0, kWgs84Pole = 6356752.3142451793;  ///< semi-axes, metres

/// Earth-centred coordinates (metres; x through longitude 0, z through the north pole) of a place at a height over the
/// ellipsoid.
Vec3 earth_centred(Vec2 degrees, double height);

/// Unit vectors at a place, in earth-centred coordinates.
struct EastNorthUp {
  Vec3 east, north, up;
};
EastNorthUp east_north_up(Vec2 degrees);

}  // namespace retalho
