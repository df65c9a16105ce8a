// A TetraQuad surface as triangles whose vertices lie on it, and how a triangle mesh hangs together as a surface.
#pragma once

#include "retalho/mesh/mesh.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

struct TetraQuadMeshOptions {
  double tolerance = 0;  ///< largest distance of the triangles to the surface; 0: none, three divisions
  int divisions = 0;     ///< of a tetrahedron's edge, 1 to 16; 0: as few as the tolerance asks for
};

struct TetraQuadMeshNotes {
  double deviation = 0;  ///< largest |C| / |grad C| found at the triangles' centres and sides' middles
  int divisions = 0;
};

/// The zero set as flat triangles, counter-clockwise seen from where the function is positive.
///
/// Every tetrahedron is cut into divisions^3 parts, in which the surface is cut off along the edges' roots; a node's
/// sign and an edge's root are found once and shared. Promises: vertices lie on the surface to 1e-9 of the grid's step;
/// no cracks and no edges of more than two triangles, whatever the surface; edges of one triangle only where the
/// surface leaves the tetrahedra; normals are the function's gradients; the same bytes on every run. The tolerance is
/// kept at four points a triangle (no bound between them); where 16 divisions do not suffice, the notes say what they
/// gave. Throws UsageError for a tolerance below 0 or not finite, divisions out of range.
TriangleMesh mesh_tetraquad(const TetraQuadField& field, const TetraQuadMeshOptions& options = {},
                            TetraQuadMeshNotes* notes = nullptr, const Context& context = {});

/// A mesh as a surface. Meant for meshes without non-manifold edges.
struct MeshTopology {
  std::size_t components = 0;  ///< parts joined by vertices
  std::size_t open_edges = 0;  ///< of one triangle
  std::size_t borders = 0;     ///< closed loops of those
  std::int64_t genus = 0;      ///< handles of all components together, borders closed by discs
};
MeshTopology topology_of(const TriangleMesh& mesh);

}  // namespace retalho
