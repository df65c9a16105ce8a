// A terrain's surface as triangles that are small where the eye is near: the picture's level of detail.
//
// Each triangle of the TIN is cut into n^2, n a power of two, and each of its edges into a number of pieces that the
// edge alone decides (its own bend, its own distance from the eye), at most the n of its triangles: where a triangle is
// finer than its edge, its vertices there fall onto the edge's. So neighbours have the same vertices along what they
// share, whatever their levels are, and no crack opens.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/mesh/mesh.h"
#include "retalho/terrain/evaluate.h"

namespace retalho::viewer {

/// How far the edges and triangles of a TIN may be from its surface, in height units: by the largest second derivative
/// along an edge (L^2 / 8 of it) and along the three edges in a triangle (a sixth). Second derivatives are taken near
/// the corners of the polynomial pieces, where those of cubics are largest. Made once for a model: about 1 us a
/// triangle.
struct SurfaceBends {
  std::vector<float> edges, triangles;
};
SurfaceBends measure_bends(const TerrainEvaluator& evaluator, const Context& context = {});

struct DetailOptions {
  Vec3 eye;             ///< local coordinates; z in the picture's heights, which are `stretch` times the terrain's
  Vec3 forward = {};    ///< where it looks, as the eye is given: what lies behind it is coarse; zero: all around
  double stretch = 1;   ///< above 0
  double angle = 1e-3;  ///< the error that is wanted, as a share of the distance from the eye (about half a pixel)
  std::size_t budget = 10000;  ///< triangles: a larger angle is worked to where this one makes more
};

struct DetailNotes {
  double angle = 0;     ///< that was worked to
  int finest = 1;       ///< pieces along an edge of the triangle that is cut finest
  std::size_t cut = 0;  ///< triangles that are cut at all
};

/// The mesh, with the surface's normals. Triangles whose middle has no data are left out; there are at least as many as
/// the TIN has, whatever the budget. The same bytes on every run. Cost: about 0.3 us a triangle, on one thread.
TriangleMesh detail_mesh(const TerrainEvaluator& evaluator, const SurfaceBends& bends, const DetailOptions& options,
                         DetailNotes* notes = nullptr, const Context& context = {});

}  // namespace retalho::viewer
