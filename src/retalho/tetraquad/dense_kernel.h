// Products of small dense matrices, compiled for several widths of vector registers; all give the same bytes, since
// every number is the same sum of fused products in the same order. Internal to the room.
#pragma once

#include <cstddef>

namespace retalho {

/// C = A B' (replace) or C -= A B', everything column-major; A: m x k, B: n x k, C: m x n. With `lower`, what lies
/// above C's diagonal is not worked out (it may be overwritten). C may be A: all of A is read first.
struct DenseProduct {
  const double* a;
  std::size_t m, lda;
  const double* b;
  std::size_t n, ldb;
  std::size_t k;
  double* c;
  std::size_t ldc;
  bool lower, replace;
  double* work;  ///< (m + n + 64) k numbers
};

using DenseKernel = void (*)(const DenseProduct& p);
void dense_product_generic(const DenseProduct& p);
#if defined(__x86_64__)
void dense_product_avx2(const DenseProduct& p);
void dense_product_avx512(const DenseProduct& p);
#endif
/// The widest that this machine has.
DenseKernel dense_kernel();

}  // namespace retalho
