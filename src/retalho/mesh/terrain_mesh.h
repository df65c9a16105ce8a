// A terrain surface as triangles, to a tolerance against the true surface, watertight along shared edges.
#pragma once

#include "retalho/mesh/mesh.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct TerrainMeshOptions {
  double tolerance =
      0;  ///< largest vertical distance to the surface, height units; 0: a thousandth of the height range
};

/// The tolerance that mesh_terrain works to: the one asked for, or a thousandth of the range of the vertices' heights.
/// Throws UsageError for one that is negative, not a number, or too small for doubles to tell (under 1e-12 of the
/// heights).
double mesh_tolerance(const Terrain& terrain, const TerrainMeshOptions& options);
/// The same for vertices from `low` to `high`.
double mesh_tolerance(double low, double high, const TerrainMeshOptions& options);

/// The surface as flat triangles whose vertices lie on it.
///
/// Promises: every triangle is within the tolerance of the surface, by a bound on the ordinates and not by samples; no
/// cracks (check_mesh), since an edge between patches is halved as often as its own ordinates ask and both sides take
/// the same vertices; counter-clockwise from above; the same bytes from any number of threads. Triangles whose centre
/// is in the void are left out, and so are vertices of no triangle. Normals are the true surface's; of a linear one,
/// which has none at its vertices, the mean of the triangles around, weighted by area. `offset` is the model's origin
/// in its CRS, or zero where local coordinates are not CRS coordinates less the origin (degrees).
///
/// Order: the TIN's vertices, then the cuts of its edges in build_edges' order, then those inside of triangles.
/// Cost: about 0.4 us a triangle on one thread, 100 bytes a triangle. Throws BadInput for more than 1.4e9 triangles.
TriangleMesh mesh_terrain(const Terrain& terrain, const TerrainMeshOptions& options = {}, const Context& context = {});

}  // namespace retalho
