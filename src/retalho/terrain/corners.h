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

  TriangleCorners() = default;
  TriangleCorners(const Terrain& terrain, std::uint32_t triangle) : vertex(terrain.tin.triangles[triangle]) {
    for (std::size_t k = 0; k < 3; ++k) {
      point[k] = terrain.tin.points[vertex[k]];
      height[k] = terrain.tin.heights[vertex[k]];
      gradient[k] = terrain.gradients.empty() ? Vec2{} : terrain.gradients[vertex[k]];
    }
  }
};

}  // namespace retalho
