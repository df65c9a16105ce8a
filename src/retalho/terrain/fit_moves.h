// The three ways to better a surface in the making without changing how many vertices it has or with more of them:
// insertion where its error lies, relocation, and exchange. Internal to terrain/.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "retalho/terrain/fit_state.h"

namespace retalho {

/// Inserts up to `count` vertices, each at the centroid of the squared errors of a triangle, the triangles with the
/// largest share of the objective first, none that touches another of this call. Returns how many.
std::size_t insert_in(FitState& state, std::span<const std::uint32_t> triangles, std::size_t count,
                      const Context& context);  // of these triangles only
std::size_t insert_at_centroids(FitState& state, std::size_t count, const Context& context);

/// One sweep over all vertices: each may step in one of 8 directions to where its star, with the vertex's own data
/// solved for, costs least. Then Delaunay again, a solve, and everything put back if the objective rose.
/// `reach`: the step as a share of sqrt(star area / 3); 0: none. Where vertices may be folded, each may become so or
/// cease to be. True if it helped.
bool relocate(FitState& state, double reach, const CgLimits& limits, const Context& context);

/// Where vertices may be folded: those become so or cease to be for which that pays, at the price that a gradient has.
void refold(FitState& state, const Context& context);

/// Removes up to `count` vertices off the outline whose stars cost least, no two of them neighbours.
void remove_cheapest(FitState& state, std::size_t count, const Context& context);

/// Removes the share of the vertices whose stars cost least, no two of them neighbours, and inserts as many at
/// centroids. Whether that helps shows after a relocation.
void exchange(FitState& state, double share, const CgLimits& limits, const Context& context);

}  // namespace retalho
