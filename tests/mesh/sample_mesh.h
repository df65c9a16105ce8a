// Small meshes for the tests of this room.
#pragma once

#include <cmath>

#include "retalho/mesh/mesh.h"

namespace retalho::test {

/// A sheet of `columns` x `rows` vertices over [0, 1] x [0, 1], z = f(x, y), counter-clockwise from above.
template <typename Height>
TriangleMesh sheet(std::uint32_t columns, std::uint32_t rows, Height f) {
  TriangleMesh mesh;
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t c = 0; c < columns; ++c) {
      const double x = c / (columns - 1.0), y = r / (rows - 1.0);
      mesh.positions.push_back({x, y, f(x, y)});
      mesh.normals.push_back(normalized(Vec3{x - 0.5, y - 0.5, 1}));
      mesh.texture.push_back({x, y});
    }
  for (std::uint32_t r = 0; r + 1 < rows; ++r)
    for (std::uint32_t c = 0; c + 1 < columns; ++c) {
      const std::uint32_t v = r * columns + c;
      mesh.triangles.push_back({v, v + 1, v + columns + 1});
      mesh.triangles.push_back({v, v + columns + 1, v + columns});
    }
  return mesh;
}

inline TriangleMesh wavy_sheet() {
  TriangleMesh mesh = sheet(7, 5, [](double x, double y) { return std::sin(5 * x) * 0.1 + y / 3; });
  mesh.offset = {4512345.625, 5.0e6 + 1.0 / 3, 0};
  return mesh;
}

/// A closed shape: no open edge at all.
inline TriangleMesh tetrahedron() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

}  // namespace retalho::test
