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
  std::vector<Vec3> positions;                          ///< local coordinates; add `offset` for the CRS's
  std::vector<Vec3> normals;                            ///< unit, one a vertex; may be empty
  std::vector<Vec2> texture;                            ///< texture coordinates, one a vertex; may be empty
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise seen from outside (above)
  Vec3 offset;          ///< written into formats with double coordinates, and said in the others
  std::string unit;     ///< of the coordinates: "metre", "foot", "US survey foot"; empty: not known
  std::string crs_wkt;  ///< of positions + offset; empty: none, or they are not coordinates of a CRS
};

/// How a mesh hangs together, by its vertex indices alone; positions only tell a crack from a border.
struct MeshCheck {
  std::size_t open_edges = 0;         ///< edges of one triangle only: boundary_edges + cracks
  std::size_t boundary_edges = 0;     ///< open, with nothing on the other side: the model's border, or a hole's
  std::size_t cracks = 0;             ///< open, though seen from above another open edge runs back along it: two sides
                                      ///< that should share their vertices and do not (a vertical edge: the same ends)
  std::size_t nonmanifold_edges = 0;  ///< edges of more than two triangles, or of two that run along it the same way
  std::size_t degenerate_triangles = 0;  ///< a vertex named twice, or no area
  std::size_t components = 0;            ///< parts that share no vertex (vertices of no triangle are not counted)
  /// No cracks: water on the surface runs off over the border only.
  bool watertight() const { return cracks == 0 && nonmanifold_edges == 0; }
};
/// Throws BadInput for an index out of range. Cost: a sort of the edges, about 0.3 us a triangle.
MeshCheck check_mesh(const TriangleMesh& mesh);

/// By extension: .ply (binary little-endian: double positions with `offset` added, float normals and texture), .obj
/// (text, all digits, `offset` added), .stl (binary, float, without `offset`, which its header tells), .glb (binary
/// glTF 2.0: float positions about the box's centre, which is the node's translation; a root node turns z-up into
/// glTF's y-up; `offset` in the root's extras), .xml and .landxml (LandXML 1.2, a TIN
/// surface: northing, easting, height, `offset` added, with unit and CRS). Normals and texture coordinates go along
/// where the format has a place for them. Atomic. Throws CannotWrite, UsageError (extension), BadInput (array lengths,
/// indices, positions not finite).
void write_mesh(const TriangleMesh& mesh, const std::string& path, bool overwrite = false);

/// The bytes that write_mesh gives a file of this extension (".glb"). Throws as write_mesh does.
std::string encode_mesh(const TriangleMesh& mesh, const std::string& extension);

/// Is the extension one that write_mesh knows?
bool is_mesh_name(const std::string& path);

/// A triangle mesh from .ply (ASCII or binary, either byte order) or .obj (`v`, `vt`, `vn`, `f`; a corner's normal and
/// texture are kept when every vertex is used with one of each). Polygons are fanned from their first corner. `offset`
/// is zero. Throws CannotRead (missing, cut short, not such a file), BadInput (an index out of range, a face of fewer
/// than three corners), naming the line or the element.
TriangleMesh read_mesh(const std::string& path);

}  // namespace retalho
