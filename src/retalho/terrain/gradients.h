// The gradient at each vertex of a TIN, estimated from the heights (docs/mathematics.md, "Gradients").
//
// Every estimate is exact for planes; adding a plane to the heights adds its gradient. Quadratic is also exact for
// quadratics wherever its rings are large enough. All are deterministic for any number of threads, and linear in the
// heights.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// normals: of the sum of the facets' normals, that is the mean of the facets' gradients weighted by their projected
///   areas (the paper's eqs. 4-6). Error O(h).
/// quadratic: the least-squares quadratic through the vertex over its two rings (at most 256 neighbours), weights
///   1/distance, by orthogonal rotations. Error O(h^2). Where the rings do not determine a quadratic (fewer than five
///   neighbours, or neighbours near a conic through the vertex) a plane through the vertex is fitted instead.
/// network: Nielson's minimum-norm network, which minimises the bending of the cubic curves along the edges; solved to
///   a residual of 1e-12 by conjugate gradients, whose block-Jacobi condition is at most 3 on any mesh.
/// A vertex without triangles gets (0, 0). `kind` must be one of these three.
std::vector<Vec2> estimate_gradients(const Tin& tin, const EdgeTable& edges, GradientKind kind,
                                     const Context& context = {});

}  // namespace retalho
