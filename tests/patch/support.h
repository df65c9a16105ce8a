// Sides and surfaces that the tests of this room share.
#pragma once

#include <cmath>
#include <random>

#include "retalho/curve/curve.h"
#include "retalho/patch/sides.h"

namespace retalho::test {

inline SideCurve bezier_side(std::vector<Vec3> points) {
  const int degree = static_cast<int>(points.size()) - 1;
  return SideCurve(make_bezier(points, degree, 3));
}

/// The ten control points of a cubic Bézier triangle whose centre has quadratic precision, and its three sides.
struct CubicTriangle {
  std::array<std::array<Vec3, 4>, 4> b;  ///< b[i][j] stands for (i, j, 3 - i - j)
  explicit CubicTriangle(std::mt19937_64& random) {
    std::normal_distribution<double> normal(0, 0.1);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; i + j < 4; ++j) {
        const double x = normal(random), y = normal(random), z = normal(random);
        b[i][j] = {static_cast<double>(i) / 3 + x, static_cast<double>(j) / 3 + y, z};
      }
    b[1][1] = (b[2][1] + b[1][2] + b[0][2] + b[0][1] + b[1][0] + b[2][0]) / 4 - (b[3][0] + b[0][3] + b[0][0]) / 6;
  }
  PatchSides sides() const {
    return {bezier_side({b[3][0], b[2][1], b[1][2], b[0][3]}), bezier_side({b[0][3], b[0][2], b[0][1], b[0][0]}),
            bezier_side({b[0][0], b[1][0], b[2][0], b[3][0]})};
  }
  Vec3 at(Vec2 uv) const {
    const double u = uv.x, v = uv.y, w = 1 - u - v;
    constexpr std::array<double, 4> factorial = {1, 1, 2, 6};
    Vec3 sum;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; i + j < 4; ++j)
        sum = sum + 6 / (factorial[i] * factorial[j] * factorial[3 - i - j]) * std::pow(u, i) * std::pow(v, j) *
                        std::pow(w, 3 - i - j) * b[i][j];
    return sum;
  }
};

/// A point of the parameter triangle, by area.
inline Vec2 random_parameters(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double a = unit(random), b = unit(random);
  return a + b > 1 ? Vec2{1 - a, 1 - b} : Vec2{a, b};
}

/// A straight triangle of height 0.9 whose first side is bent inwards by a parabola of this depth.
inline PatchSides bent_triangle(double depth) {
  return {bezier_side({{0, 0, 0}, {0.5, 2 * depth, 0}, {1, 0, 0}}), bezier_side({{1, 0, 0}, {0.5, 0.9, 0}}),
          bezier_side({{0.5, 0.9, 0}, {0, 0, 0}})};
}

}  // namespace retalho::test
