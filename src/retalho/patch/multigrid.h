// Sparse systems of convex combinations, u_i - sum of a_ij u_j = b_i, with two right-hand sides: BiCGSTAB,
// preconditioned by smoothed-aggregation multigrid (Vanek, Mandel, Brezina 1996) in single precision; small and
// stubborn ones by Eigen's sparse LU. Internal to the room patch.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"

namespace retalho {

/// Rows without their diagonal, which is 1: u_i - sum over k in [first[i], first[i + 1]) of values[k] u_columns[k].
struct ConvexSystem {
  std::vector<std::uint32_t> first = {0}, columns;
  std::vector<double> values;
  std::size_t size() const { return first.size() - 1; }
};

/// Solves for both components of x, to a residual of 1e-13 of the right-hand side's largest entry or as near as
/// rounding allows. Returns the iterations, 0 for the direct solver.
int solve_iterative(const ConvexSystem& system, const std::vector<Vec2>& b, std::vector<Vec2>& x,
                    const Context& context);
/// By LU with refinement, to the last digits.
void solve_direct(const ConvexSystem& system, const std::vector<Vec2>& b, std::vector<Vec2>& x);

}  // namespace retalho
