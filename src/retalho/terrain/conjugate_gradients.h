// Conjugate gradients with a preconditioner, the same bytes from any number of threads: sums are taken in chunks of a
// fixed size, in their order. Internal to terrain/.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "retalho/core/parallel.h"

namespace retalho {

/// Sum over [0, count) of sum(begin, end), in chunks.
template <class Sum>
double chunked_sum(std::size_t count, const Context& context, const Sum& sum) {
  constexpr std::size_t kGrain = 16384;
  if (count <= kGrain) return sum(std::size_t{0}, count);
  std::vector<double> parts((count + kGrain - 1) / kGrain);
  parallel_chunks(count, kGrain, context,
                  [&](std::size_t begin, std::size_t end) { parts[begin / kGrain] = sum(begin, end); });
  double total = 0;
  for (const double part : parts) total += part;
  return total;
}

inline double dot(const std::vector<double>& a, const std::vector<double>& b, const Context& context) {
  return chunked_sum(a.size(), context, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t k = begin; k < end; ++k) sum += a[k] * b[k];
    return sum;
  });
}

/// a += factor * b, or a = b + factor * a.
inline void add_scaled(std::vector<double>& a, double factor, const std::vector<double>& b, const Context& context) {
  parallel_chunks(a.size(), 65536, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) a[k] += factor * b[k];
  });
}
inline void scale_and_add(std::vector<double>& a, double factor, const std::vector<double>& b, const Context& context) {
  parallel_chunks(a.size(), 65536, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) a[k] = b[k] + factor * a[k];
  });
}

struct CgLimits {
  double tolerance = 1e-8;  ///< of the preconditioned residual's norm, relative to the right-hand side's
  int iterations = 500;
};

/// Improves `x`, a guess at the solution of A x = b, and returns the number of iterations. multiply(in, out) and
/// precondition(in, out) are symmetric and positive; every iterate is finite and no worse than the one before it.
template <class Multiply, class Precondition>
int conjugate_gradients(const Multiply& multiply, const Precondition& precondition, const std::vector<double>& b,
                        std::vector<double>& x, const CgLimits& limits, const Context& context) {
  const std::size_t n = b.size();
  std::vector<double> r(n), y(n), p(n), q(n);
  precondition(b, y);
  const double goal = limits.tolerance * limits.tolerance * dot(b, y, context);
  multiply(x, q);
  r = b;
  add_scaled(r, -1, q, context);
  precondition(r, y);
  p = y;
  double now = dot(r, y, context);
  int iteration = 0;
  for (; iteration < limits.iterations && now > goal; ++iteration) {
    context.check();
    multiply(p, q);
    const double bend = dot(p, q, context);
    if (!(bend > 0) || !std::isfinite(bend)) break;
    const double step = now / bend;
    add_scaled(x, step, p, context);
    add_scaled(r, -step, q, context);
    precondition(r, y);
    const double next = dot(r, y, context);
    scale_and_add(p, next / now, y, context);
    now = next;
  }
  return iteration;
}

}  // namespace retalho
