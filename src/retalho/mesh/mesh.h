// Triangle meshes out of any surface, and the formats that other tools open.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"

namespace retalho {

struct TriangleMesh {
  std::vector<Vec3> positions;  ///< local coordinates; add `offset` for the CRS's
  std::vector<Vec3> normals;    ///< unit, one a vertex; may be empty
  std::vector<Vec2> texture;    ///< texture coordinates, one a vertex; may be empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside (above)
  Vec3 offset;                  ///< written into formats with double coordinates, and said in the others
};

struct MeshCheck {
  std::size_t open_edges = 0, nonmanifold_edges = 0, degenerate_triangles = 0, components = 0;
  bool watertight() const { return open_edges == 0 && nonmanifold_edges == 0; }
};
MeshCheck check_mesh(const TriangleMesh& mesh);

/// By extension: .ply (binary, double), .obj, .stl (binary), .glb. Atomic. Throws CannotWrite, UsageError (extension).
void write_mesh(const TriangleMesh& mesh, const std::string& path, bool overwrite = false);

}  // namespace retalho
