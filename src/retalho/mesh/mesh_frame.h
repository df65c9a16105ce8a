// What a terrain's coordinates are to those who open its mesh, and what its meshers share. Internal to the room.
#pragma once

#include <string>

#include "retalho/core/vec.h"
#include "retalho/mesh/mesh.h"
#include "retalho/raster/georef.h"

namespace retalho {

/// TriangleMesh's fields of these names.
struct MeshFrame {
  Vec3 offset;
  std::string unit, crs_wkt;
};
MeshFrame mesh_frame(const Georef& georef);

/// Leaves out vertices of no triangle.
void drop_unused_vertices(TriangleMesh& mesh);

}  // namespace retalho
