// Points on shapes that are known exactly. Include as "tetraquad/shapes.h".
#pragma once

#include <cmath>
#include <numbers>

#include "retalho/cloud/cloud.h"
#include "support/support.h"

namespace retalho::test {

inline PointCloud sphere_points(std::size_t count, Vec3 centre, double radius, std::uint64_t stream = 3) {
  Random random(stream);
  PointCloud cloud;
  while (cloud.positions.size() < count) {
    const Vec3 d = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    if (norm(d) > 1 || norm(d) < 0.1) continue;
    cloud.normals.push_back(normalized(d));
    cloud.positions.push_back(centre + radius * cloud.normals.back());
  }
  return cloud;
}

inline constexpr double kTorusRing = 0.35, kTorusTube = 0.15;

inline PointCloud torus_points(std::size_t count, std::uint64_t stream) {
  Random random(stream);
  PointCloud cloud;
  while (cloud.positions.size() < count) {
    const double u = random.uniform(0, 2 * std::numbers::pi), v = random.uniform(0, 2 * std::numbers::pi);
    const double ring = kTorusRing + kTorusTube * std::cos(v);
    if (random.uniform(0, kTorusRing + kTorusTube) > ring) continue;  // even by area
    cloud.positions.push_back({ring * std::cos(u), ring * std::sin(u), kTorusTube * std::sin(v)});
    cloud.normals.push_back({std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)});
  }
  return cloud;
}

inline double torus_distance(Vec3 p) {
  return std::abs(std::hypot(std::hypot(p.x, p.y) - kTorusRing, p.z) - kTorusTube);
}

}  // namespace retalho::test
