// Random curves and slow twins for the tests of this room.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "retalho/curve/curve.h"

namespace retalho::test {

inline Vec3 random_point(std::mt19937_64& random, int dimension = 3) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, dimension == 3 ? z : 0};
}

inline Curve random_curve(std::mt19937_64& random, int degree, int dimension, bool rational = false) {
  std::uniform_real_distribution<double> unit(0.2, 2);
  std::vector<Vec3> points;
  std::vector<double> weights;
  for (int i = 0; i <= degree; ++i) {
    points.push_back(random_point(random, dimension));
    if (rational) weights.push_back(unit(random));
  }
  Curve curve;
  curve.dimension = dimension;
  curve.append(points, 1, weights);
  return curve;
}

/// Distance of p from the segment a b.
inline double segment_distance(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  const double l = norm2(d);
  const double t = l > 0 ? std::clamp(dot(p - a, d) / l, 0.0, 1.0) : 0;
  return norm(p - a - t * d);
}

}  // namespace retalho::test
