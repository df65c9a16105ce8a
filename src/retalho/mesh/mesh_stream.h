// A mesh as its writers take it: passes over its vertices and its triangles, whether it is in memory or on disk.
// Internal to the room.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "retalho/mesh/mesh.h"

namespace retalho {

/// Vertices one behind the other; normals and texture are empty where the mesh has none.
struct VertexBlock {
  std::span<const Vec3> positions, normals;
  std::span<const Vec2> texture;
};
using TriangleBlock = std::span<const std::array<std::uint32_t, 3>>;

struct MeshStream {
  std::uint64_t vertices = 0, triangles = 0;
  bool normals = false, texture = false;
  Vec3 low, high;  ///< the box of the positions
  Vec3 offset;
  std::string unit, crs_wkt;
  std::function<void(const std::function<void(const VertexBlock&)>& take)> each_vertex;
  std::function<void(const std::function<void(TriangleBlock)>& take)> each_triangle;
  std::function<Vec3(std::uint32_t vertex)> position;
};

/// Of a mesh in memory, which must outlive it.
MeshStream stream_of(const TriangleMesh& mesh);

/// Widens the box from `low` to `high` by a point.
void widen(Vec3& low, Vec3& high, Vec3 point);

}  // namespace retalho
