// What the elements of every kind start from: the three corners of a triangle with their data.
#pragma once

#include <array>
#include <cstdint>

#include "retalho/terrain/terrain.h"

namespace retalho {

struct TriangleCorners {
  std::array<std::uint32_t, 3> vertex{0, 1, 2};
  std::array<Vec2, 3> point;
  std::array<double, 3> height{};
  std::array<Vec2, 3> gradient;
  /// With `creased`: the derivatives along edge k, from corner k + 1 towards corner k + 2 and from k + 2 towards k + 1
  /// (times the edge's length), the same on both sides of a crease. `gradient` then agrees with them.
  bool creased = false;
  std::array<std::array<double, 2>, 3> along{};

  TriangleCorners() = default;
  TriangleCorners(const Terrain& terrain, std::uint32_t triangle) : vertex(terrain.tin.triangles[triangle]) {
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = terrain.tin.points[vertex[k]];
      height[k] = terrain.tin.heights[vertex[k]];
      gradient[k] = terrain.gradients.empty() ? Vec2{} : terrain.gradients[gradient_of(terrain, triangle, k)];
    }
    if (!terrain.corner_gradients.empty()) set_creased(terrain, triangle);
  }

 private:
  void set_creased(const Terrain& terrain, std::uint32_t triangle);
};

}  // namespace retalho
