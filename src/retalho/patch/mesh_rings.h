// Neighbours of each vertex in their cyclic order, and what hinders a mesh from being a disk. Internal to the room
// patch.
#pragma once

#include <span>
#include <vector>

#include "retalho/core/vec.h"
#include "retalho/patch/topology.h"

namespace retalho {

struct MeshRings {
  std::vector<std::uint32_t> first, neighbors;  ///< counter-clockwise; at the border from the next border vertex on
  std::vector<std::uint8_t> border;
  std::span<const std::uint32_t> of(std::size_t v) const {
    return std::span(neighbors).subspan(first[v], first[v + 1] - first[v]);
  }
};

/// Throws BadInput for all that is wrong at an edge or a vertex (parameterize.h, check_disk).
MeshRings mesh_rings(std::span<const Vec3> positions, std::span<const Triangle> triangles);

/// The one border of a disk. Throws BadInput: several parts, no border, holes, handles.
std::vector<std::uint32_t> disk_border(const MeshRings& rings, std::span<const Vec3> positions, std::size_t triangles);

}  // namespace retalho
