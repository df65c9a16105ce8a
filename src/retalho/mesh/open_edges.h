// The parts of check_mesh that meshes in parts need one by one. Internal to the room.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/mesh/mesh.h"

namespace retalho {

/// An open edge as its triangle runs along it.
struct OpenEdge {
  Vec3 a, b;
};
/// How many of them have another one that runs back along them.
std::size_t count_cracks(std::vector<OpenEdge> edges);

/// For each vertex the number of its part, from 0, by its first vertex; kNoPart: of no triangle.
inline constexpr std::uint32_t kNoPart = 0xffffffffU;
std::vector<std::uint32_t> parts_of(const TriangleMesh& mesh, std::size_t& count);

}  // namespace retalho
