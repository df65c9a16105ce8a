// The energy that a fitted TetraQuad minimises, as a matrix and a right-hand side. Internal to the room.
//
// In lattice coordinates, F = C / step, everything without a dimension:
// Adaptive meshes: lengths are measured by each tetrahedron's own size h (TetMesh::size): w and F^2 are divided by h^2,
// the face terms multiplied by h^(2m-4), the bending divided by h, and unknowns are scaled by their vertex's mean size.
//
//   w sum_k [ F(p_k)^2 + alpha |grad F(p_k) - n_k|^2 ]  +  sum_faces sum_m gamma_m INT [d^m F/dn^m]^2 dA
//   + mu sum_tets INT |Hess F|^2 dV  +  eps |Q|^2,     w = cells that hold points / points
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tetraquad/block_cg.h"
#include "retalho/tetraquad/block_matrix.h"
#include "retalho/tetraquad/half_faces.h"
#include "retalho/tetraquad/samples.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// A value that is wanted at a place, without a normal.
struct Guide {
  std::uint32_t tet = 0;
  Vec3 place;
  double value = 0;   ///< in lattice units
  double weight = 1;  ///< against a tetrahedron's share of the points
};

struct EnergyWeights {
  double point = 1;   ///< w: the area that holds points, in steps^2, over their number
  double normal = 1;  ///< alpha
  std::array<double, 3> jump{};
  double bending = 0;
  double ridge = 0;  ///< of the mean of the diagonal
};

struct Energy {
  BlockMatrix matrix;
  std::vector<double> right;
  double ridge = 0;           ///< as added to the diagonal
  std::vector<double> sizes;  ///< adaptive: of each vertex; the unknowns are value / h, gradient, Hessian * h
};

/// Blocks that depend on a tetrahedron's or a face pair's shape only are made once a shape. Cost: about 2 us a sample,
/// 3 us a tetrahedron; no memory that grows with the samples.
Energy assemble_energy(const TetMesh& mesh, const HalfFaces& faces, const SampleRuns& samples,
                       const EnergyWeights& weights, const Context& context = {}, std::span<const Guide> guides = {});

/// What unknown `n` of a vertex is multiplied by to be the quadric's coefficient.
double unit_of(const Energy& energy, std::size_t vertex, std::size_t n);

/// By conjugate gradients from the quadrics given.
CgNotes solve_energy_by_cg(const Energy& energy, std::vector<Quadric>& quadrics, double tolerance,
                           const Context& context);

/// Solves for the quadrics of all vertices.
void solve_energy(Energy energy, std::vector<Quadric>& quadrics, std::size_t* factor_numbers, const Context& context);

}  // namespace retalho
