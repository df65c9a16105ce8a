#include "retalho/tetraquad/dense_front.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "retalho/tetraquad/dense_kernel.h"

namespace retalho {
namespace {

constexpr std::size_t kPanel = 64;

/// Cholesky of the w x w corner (lower), and the inverse of its factor (column-major, lower, the rest zero).
bool factor_corner(double* a, std::size_t n, std::size_t w, double* inverse) {
  for (std::size_t k = 0; k < w; ++k) {
    double* column = a + k * n;
    if (!(column[k] > 0)) return false;
    column[k] = std::sqrt(column[k]);
    const double scale = 1 / column[k];
    for (std::size_t i = k + 1; i < w; ++i) column[i] *= scale;
    for (std::size_t j = k + 1; j < w; ++j) {
      double* next = a + j * n;
      for (std::size_t i = j; i < w; ++i) next[i] -= column[i] * column[j];
    }
  }
  std::fill(inverse, inverse + w * w, 0.0);
  for (std::size_t k = 0; k < w; ++k) {
    double* x = inverse + k * w;
    x[k] = 1 / a[k * n + k];
    for (std::size_t j = k; j < w; ++j) {
      if (j > k) x[j] /= a[j * n + j];
      for (std::size_t i = j + 1; i < w; ++i) x[i] -= a[j * n + i] * x[j];
    }
  }
  return true;
}

}  // namespace

DenseKernel dense_kernel() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return dense_product_avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return dense_product_avx2;
#endif
  return dense_product_generic;
}

bool factor_front(double* a, std::size_t n, std::size_t pivots) {
  static const DenseKernel multiply = dense_kernel();
  std::vector<double> inverse(kPanel * kPanel), work((2 * n + 64) * kPanel);
  for (std::size_t k = 0; k < pivots; k += kPanel) {
    const std::size_t width = std::min(kPanel, pivots - k), below = n - k - width;
    double* corner = a + k * n + k;
    if (!factor_corner(corner, n, width, inverse.data())) return false;
    if (below == 0) break;
    double* left = corner + width;
    double* rest = left + width * n;
    multiply({left, below, n, inverse.data(), width, width, width, left, n, false, true, work.data()});
    multiply({left, below, n, left, below, n, width, rest, n, true, false, work.data()});
  }
  return true;
}

}  // namespace retalho
