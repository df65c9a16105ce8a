// Internal to visibility/: what an observer's options let it see, whatever stands in between.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "retalho/core/vec.h"
#include "retalho/visibility/viewshed.h"

namespace retalho::visibility_detail {

inline constexpr double kEarthRadius = 6371008.8;  ///< metres

/// Heights at squared distance d2 are lowered by this times d2.
inline double curvature_drop(bool earth_curvature, double refraction) {
  return earth_curvature ? (1 - refraction) / (2 * kEarthRadius) : 0;
}

/// Radius of the first Fresnel zone at `distance` of `length`, metres; 0 without a frequency (Hz).
inline double fresnel_radius(double frequency, double distance, double length) {
  constexpr double kLightSpeed = 299792458;
  if (!(frequency > 0)) return 0;
  return std::sqrt(std::max(0.0, kLightSpeed / frequency * distance * (length - distance) / std::max(length, 1e-300)));
}

class FieldOfView {
 public:
  explicit FieldOfView(const ViewshedOptions& options)
      : drop_(curvature_drop(options.earth_curvature, options.refraction)),
        radius2_(options.radius > 0 ? options.radius * options.radius : -1),
        low_(slope_of(options.lowest)),
        high_(slope_of(options.highest)),
        limited_(options.lowest > -90 || options.highest < 90) {
    const double span = options.azimuth_to - options.azimuth_from;
    all_round_ = span >= 360;
    from_ = std::fmod(std::fmod(options.azimuth_from, 360) + 360, 360);
    span_ = std::fmod(std::fmod(span, 360) + 360, 360);
  }

  double drop() const { return drop_; }
  double radius2() const { return radius2_; }  ///< negative: no limit
  /// Is what stands at `offset` (east, north; not zero) within the radius and the horizontal field?
  bool holds(Vec2 offset) const {
    if (radius2_ >= 0 && dot(offset, offset) > radius2_) return false;
    if (all_round_) return true;
    double azimuth = std::atan2(offset.x, offset.y) * 180 / std::numbers::pi - from_;
    azimuth -= 360 * std::floor(azimuth / 360);
    return azimuth <= span_;
  }
  /// Is what stands `rise` above the eye at that squared distance within the vertical field?
  bool holds_elevation(double rise, double distance2) const {
    if (!limited_) return true;
    const double slope = rise / std::sqrt(distance2);
    return slope >= low_ && slope <= high_;
  }

 private:
  static double slope_of(double degrees) {
    return std::tan(std::clamp(degrees, -89.999999, 89.999999) * std::numbers::pi / 180);
  }

  double drop_, radius2_, low_, high_, from_ = 0, span_ = 360;
  bool limited_, all_round_ = true;
};

}  // namespace retalho::visibility_detail
