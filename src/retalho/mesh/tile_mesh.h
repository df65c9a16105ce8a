// The mesh of a surface that comes tile by tile (terrain/tile_source.h), written as it is made: neither the surface nor
// the mesh is ever held whole.
#pragma once

#include <cstdint>
#include <string>

#include "retalho/core/context.h"
#include "retalho/mesh/mesh.h"
#include "retalho/terrain/tile_source.h"

namespace retalho {

/// What write_tile_mesh wrote.
struct TileMeshFacts {
  std::uint64_t vertices = 0, triangles = 0;
  MeshCheck check;
};

/// Writes the mesh of mesh_terrain on all tiles as one terrain, in write_mesh's formats: the same triangles in the same
/// order, vertices in the order in which the tiles use them, those on seams once. `tolerance`: above 0, height units.
/// Memory: tiles.at_once tiles, the meshes of twice as many (100 bytes a triangle), the vertices of the seams around
/// one row of tiles, and 12 MB; while it is made, 48 bytes a vertex and 12 a triangle lie on disk beside `path`. The
/// same bytes from any number of threads. Atomic. Throws as mesh_terrain and write_mesh do, and CannotRead where
/// neighbours have other heights on their seam.
TileMeshFacts write_tile_mesh(const TileSource& tiles, double tolerance, const std::string& path,
                              bool overwrite = false, const Context& context = {});

}  // namespace retalho
