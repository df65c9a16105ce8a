// Triangles of triangular parametric patches, one watertight mesh of many.
#pragma once

#include <span>

#include "retalho/core/context.h"
#include "retalho/mesh/mesh.h"
#include "retalho/patch/surface.h"

namespace retalho {

/// The nodes and triangles of all patches as they are, (u, v) as texture coordinates, normals averaged over the
/// triangles at a node (by area). `normals` and `texture` may want a node of their own on each patch: with `weld` nodes
/// of different patches' sides that are the same to the last bit become one (their texture is then the first patch's).
TriangleMesh mesh_patches(std::span<const Patch> patches, bool weld = true);

/// One mesh of all surfaces, every node's triangle cut into n^2 with the least n of 1, 2, 4, ... 64 for which the
/// triangles' middles are within `tolerance` of the surface (0: n = 1). `deviation` gets what was reached, `factor` n.
/// `context` is asked for every few hundred triangles. Throws Interrupted.
TriangleMesh mesh_patch_surfaces(std::span<const Patch> patches, std::span<const PatchSurface> surfaces,
                                 double tolerance, double* deviation = nullptr, std::size_t* factor = nullptr,
                                 const Context& context = {});

}  // namespace retalho
