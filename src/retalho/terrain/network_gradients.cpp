// Minimum-norm network (Nielson 1983): along each edge (i, j) of length L and direction d a cubic Hermite curve; its
// bending energy, summed over all edges, is least where for every vertex i
//     sum_j (1/L) d d' (2 g_i + g_j) = sum_j (3 (z_j - z_i) / L^2) d.
// Scaled by the diagonal blocks the matrix has its eigenvalues in [1/2, 3/2] on any mesh, so conjugate gradients gain
// a factor of 3.7 a step whatever the size.
#include <array>
#include <cmath>

#include "retalho/core/parallel.h"
#include "retalho/terrain/gradient_estimates.h"

namespace retalho {
namespace {

constexpr std::size_t kGrain = 4096;  // vertices a chunk: fixes the order of the sums
constexpr double kResidual = 1e-12;
constexpr int kMostSteps = 60;  // 3.7^-22 = 1e-12.5; rounding may ask for a few more

struct Symmetric {
  double xx = 0, xy = 0, yy = 0;
  Vec2 operator*(Vec2 v) const { return {xx * v.x + xy * v.y, xy * v.x + yy * v.y}; }
};

/// The inverse; for a block without two directions (an isolated vertex) the zero matrix, which keeps the gradient at 0.
Symmetric inverse(const Symmetric& m) {
  const double det = m.xx * m.yy - m.xy * m.xy;
  const double trace = m.xx + m.yy;
  if (!(det > 1e-300 + 1e-15 * 1e-15 * trace * trace)) return {};
  return {m.yy / det, -m.xy / det, m.xx / det};
}

struct System {
  const VertexRings& rings;
  std::vector<Symmetric> diagonal, preconditioner;
  std::vector<Symmetric> side;  // (1/L) d d', one for each entry of rings.neighbors
  std::vector<Vec2> right;
};

System assemble(const Tin& tin, const VertexRings& rings, const Context& context) {
  const std::size_t n = tin.vertex_count();
  System s{rings, std::vector<Symmetric>(n), std::vector<Symmetric>(n), std::vector<Symmetric>(rings.neighbors.size()),
           std::vector<Vec2>(n)};
  parallel_chunks(n, kGrain, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::uint32_t k = rings.begin[i]; k < rings.begin[i + 1]; ++k) {
        const std::uint32_t j = rings.neighbors[k];
        const Vec2 e = tin.points[j] - tin.points[i];
        const double length = norm(e), cube = length * length * length;
        const Symmetric block{e.x * e.x / cube, e.x * e.y / cube, e.y * e.y / cube};
        s.side[k] = block;
        s.diagonal[i].xx += 2 * block.xx;
        s.diagonal[i].xy += 2 * block.xy;
        s.diagonal[i].yy += 2 * block.yy;
        s.right[i] = s.right[i] + 3 * (tin.heights[j] - tin.heights[i]) / cube * e;
      }
      s.preconditioner[i] = inverse(s.diagonal[i]);
    }
  });
  return s;
}

/// Sums `term(i)` over all vertices, chunk by chunk in order: the same bits from any number of threads.
template <class Term>
double ordered_sum(std::size_t n, std::vector<double>& partial, const Context& context, const Term& term) {
  parallel_chunks(n, kGrain, context, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += term(i);
    partial[begin / kGrain] = sum;
  });
  double sum = 0;
  for (const double p : partial) sum += p;
  return sum;
}

}  // namespace

std::vector<Vec2> network_gradients(const Tin& tin, const VertexRings& rings, const Context& context) {
  const std::size_t n = tin.vertex_count();
  const System s = assemble(tin, rings, context);
  std::vector<double> partial((n + kGrain - 1) / kGrain);
  std::vector<Vec2> x(n), residual = s.right, direction(n), image(n);
  double rho = ordered_sum(n, partial, context, [&](std::size_t i) {
    direction[i] = s.preconditioner[i] * residual[i];
    return dot(residual[i], direction[i]);
  });
  const double goal = rho * kResidual * kResidual;
  for (int step = 0; step < kMostSteps && rho > goal && rho > 0; ++step) {
    const double curvature = ordered_sum(n, partial, context, [&](std::size_t i) {
      Vec2 sum = s.diagonal[i] * direction[i];
      for (std::uint32_t k = rings.begin[i]; k < rings.begin[i + 1]; ++k)
        sum = sum + s.side[k] * direction[rings.neighbors[k]];
      image[i] = sum;
      return dot(sum, direction[i]);
    });
    if (!(curvature > 0)) break;
    const double alpha = rho / curvature;
    const double next = ordered_sum(n, partial, context, [&](std::size_t i) {
      x[i] = x[i] + alpha * direction[i];
      residual[i] = residual[i] - alpha * image[i];
      const Vec2 z = s.preconditioner[i] * residual[i];
      image[i] = z;  // kept for the next direction
      return dot(residual[i], z);
    });
    const double beta = next / rho;
    parallel_chunks(n, kGrain, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) direction[i] = image[i] + beta * direction[i];
    });
    rho = next;
  }
  return x;
}

}  // namespace retalho
