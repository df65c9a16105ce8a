// Triangles of triangular parametric patches, one watertight mesh of many.
#pragma once

#include <span>

#include "retalho/mesh/mesh.h"
#include "retalho/patch/patch.h"

namespace retalho {

/// The nodes and triangles of all patches as they are, (u, v) as texture coordinates, normals averaged over the
/// triangles at a node (by area). `normals` and `texture` may want a node of their own on each patch: with `weld` nodes
/// of different patches' sides that are the same to the last bit become one (their texture is then the first patch's).
TriangleMesh mesh_patches(std::span<const Patch> patches, bool weld = true);

}  // namespace retalho
