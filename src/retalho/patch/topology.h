// Who touches whom in a list of triangles. Internal to the room patch.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace retalho {

inline constexpr std::uint32_t kNoTriangle = 0xffffffffU;

using Triangle = std::array<std::uint32_t, 3>;

/// The triangles of each vertex, as one list with starts: those of vertex i are [first[i], first[i + 1]).
struct VertexTriangles {
  std::vector<std::uint32_t> first, triangles;
  std::span<const std::uint32_t> of(std::size_t vertex) const {
    return std::span(triangles).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};
VertexTriangles vertex_triangles(std::span<const Triangle> triangles, std::size_t vertices);

/// The triangle across the edge opposite each corner, kNoTriangle at the border. Asks for consistent orientation: an
/// edge that two triangles run along the same way has no neighbour there.
std::vector<Triangle> triangle_neighbors(std::span<const Triangle> triangles);

/// The vertices that share an edge with each vertex, ascending, as one list with starts.
struct VertexNeighbors {
  std::vector<std::uint32_t> first, vertices;
  std::span<const std::uint32_t> of(std::size_t vertex) const {
    return std::span(vertices).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};
VertexNeighbors vertex_neighbors(std::span<const Triangle> triangles, std::size_t vertices);

}  // namespace retalho
