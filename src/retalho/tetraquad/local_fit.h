// Quadrics without a system of equations: at each vertex the quadratic that fits the points around it, by weighted
// least squares, turned into the vertex's quadric by the quasi-interpolant's factors 1, 2/3, 1/3 (docs/tetraquad.md).
// Internal to the room.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tetraquad/samples.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// Overwrites the quadrics of the vertices that are marked. `sizes`: of each vertex, in lattice units (empty: 1).
/// Points within one size count, or from further away where there are fewer than 12. The same from any number of
/// threads. Cost: about 10 us a vertex and 0.2 us a point of its neighbourhood, of which at most 600 are taken.
void fit_locally(const SampleBins& bins, const TetMesh& mesh, const std::vector<char>& marked,
                 std::span<const double> sizes, std::vector<Quadric>& quadrics, const Context& context);

/// Of each vertex the geometric mean of its tetrahedra's sizes; empty for a grid, where all are 1.
std::vector<double> vertex_sizes(const TetMesh& mesh);

/// What a fit on another mesh says at these vertices; those where it says nothing are marked in the result. On a mesh
/// bisected further the surface stays what it was: the vertex in the middle of an edge gets the mean of the quadrics at
/// its ends, which changes no value. Else the quasi-interpolant of the other surface.
std::vector<char> start_from(const TetraQuad& other, const TetMesh& mesh, std::vector<Quadric>& quadrics);

}  // namespace retalho
