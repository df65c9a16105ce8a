// The products of dense fronts: every width of registers gives the twin's bits.
#include "retalho/tetraquad/dense_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "support/support.h"

namespace retalho {
namespace {

std::vector<DenseKernel> kernels() {
  std::vector<DenseKernel> all = {dense_product_generic};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) all.push_back(dense_product_avx2);
  if (__builtin_cpu_supports("avx512f")) all.push_back(dense_product_avx512);
#endif
  return all;
}

TEST(DenseKernel, EveryWidthGivesTheBitsOfFusedSumsOneAfterTheOther) {
  test::Random random(2026);
  for (int round = 0; round < 200; ++round) {
    const auto size = [&](std::size_t most) { return random.index(most) + 1; };
    const std::size_t m = size(70), k = size(64), lda = m + size(5) - 1;
    const bool lower = random.chance(0.5), replace = random.chance(0.5);
    const std::size_t n = lower ? m : size(40), ldb = n + size(5) - 1, ldc = m + size(5) - 1;
    std::vector<double> a(lda * k), b(ldb * k), before(ldc * n);
    for (auto* numbers : {&a, &b, &before})
      for (double& x : *numbers) x = random.uniform(-1, 1);
    std::vector<double> truth = before;
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < m; ++i) {
        double sum = 0;
        for (std::size_t s = 0; s < k; ++s) sum = std::fma(a[s * lda + i], b[s * ldb + j], sum);
        truth[j * ldc + i] = replace ? sum : truth[j * ldc + i] - sum;
      }
    for (const DenseKernel kernel : kernels()) {
      std::vector<double> c = before, work((m + n + 64) * k);
      kernel({a.data(), m, lda, b.data(), n, ldb, k, c.data(), ldc, lower, replace, work.data()});
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = lower ? j : 0; i < ldc; ++i)
          ASSERT_EQ(std::memcmp(&c[j * ldc + i], i < m ? &truth[j * ldc + i] : &before[j * ldc + i], sizeof(double)), 0)
              << m << " x " << n << " x " << k << ", row " << i << ", column " << j << " (round " << round << ")";
    }
  }
}

}  // namespace
}  // namespace retalho
