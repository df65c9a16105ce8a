// Triangulations of scattered points: Delaunay of all of them, or of as many as a tolerance asks for.
//
// Promises: the triangulation is Delaunay (exact predicates) and covers the convex hull; points that repeat an (x, y)
// become one vertex with the mean height; the result depends on the set of points alone, not on their order. Vertices
// come along a Hilbert curve over the points' bounding box, so that neighbours in space are neighbours in memory;
// triangles begin with their smallest vertex and are sorted.
#pragma once

#include <cstddef>
#include <span>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"
#include "retalho/tin/tin.h"

namespace retalho {

struct ScatteredNotes {
  std::size_t points = 0;     ///< given
  std::size_t places = 0;     ///< different (x, y)
  std::size_t repeated = 0;   ///< points - places: merged into another one by the mean height
  double largest_spread = 0;  ///< largest difference of heights at one (x, y)
  double max_error = 0;       ///< of the flat TIN over all places; 0 when every place is a vertex
};

/// Delaunay triangulation of all points by incremental insertion in a biased randomized order (Amenta, Choi and Rote
/// 2003; the "random" bits are a fixed hash).
/// Throws BadInput: a coordinate that is not finite or beyond 1e100, fewer than three places, all on one line.
/// Cost: about 1 us a point, 60 bytes a point besides the result.
Tin triangulate_points(std::span<const Vec3> points, ScatteredNotes* notes = nullptr, const Context& context = {});

struct PointRefineOptions {
  double max_error = 0;      ///< height units; 0: until the TIN passes through every place (or the budget is used up)
  std::size_t vertices = 0;  ///< stop at this many vertices (never below the convex hull's); 0: no budget.
                             ///< With max_error > 0 as well, whichever comes first.
};

/// Greedy refinement (Garland and Heckbert 1995) over points: from the convex hull's corners, the place that is worst
/// served is inserted until every place is within `max_error` of the flat TIN. Order: largest error first, then the
/// earliest along the Hilbert curve. Errors are |z - z of the flat triangle| with the triangle's barycentric weights,
/// in double. Throws as triangulate_points.
Tin refine_points(std::span<const Vec3> points, const PointRefineOptions& options = {}, ScatteredNotes* notes = nullptr,
                  const Context& context = {});

}  // namespace retalho
