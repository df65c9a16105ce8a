// A terrain surface as triangles, to a tolerance against the true surface, watertight along shared edges.
#pragma once

#include "retalho/mesh/mesh.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct TerrainMeshOptions {
  double tolerance =
      0;  ///< largest vertical distance to the surface, height units; 0: a thousandth of the height range
};

/// Each patch is cut as finely as its ordinates' second differences ask; shared edges are cut by a rule that depends on
/// the edge alone, so neighbours meet vertex to vertex. Triangles whose centre is in the void are left out.
/// Normals are the true surface's.
TriangleMesh mesh_terrain(const Terrain& terrain, const TerrainMeshOptions& options = {}, const Context& context = {});

}  // namespace retalho
