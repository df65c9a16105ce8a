// Conjugate gradients for systems whose Cholesky factors do not fit into memory. Internal to the room.
#pragma once

#include <cstddef>
#include <span>

#include "retalho/core/context.h"
#include "retalho/tetraquad/block_matrix.h"

namespace retalho {

struct CgOptions {
  double tolerance = 1e-5;  ///< of the preconditioned residual against the right-hand side's
  int most = 5000;          ///< iterations
};
struct CgNotes {
  int iterations = 0;
  double residual = 0;  ///< reached, in the measure of `tolerance`
};

/// Solves A x = right from the `x` given, preconditioned by one symmetric sweep of block Gauss-Seidel with 10 x 10
/// diagonal blocks. A consistent singular matrix will do. Memory beside the matrix: 130 numbers a vertex. Throws Error
/// (internal) when a diagonal block is not positive definite.
CgNotes solve_cg(const BlockMatrix& matrix, std::span<const double> right, std::span<double> x,
                 const CgOptions& options = {}, const Context& context = {});

}  // namespace retalho
