// BlockCholesky by SuiteSparse's CHOLMOD: compiled in place of block_cholesky.cpp with -DRETALHO_SUITESPARSE=ON.
#include <cholmod.h>

#include <algorithm>
#include <cstdint>
#include <new>

#include "retalho/core/error.h"
#include "retalho/tetraquad/block_matrix.h"

namespace retalho {

struct BlockCholesky::Parts {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;

  Parts() {
    cholmod_l_start(&common);
    common.print = 0;     // what goes wrong is thrown, not printed
    common.final_ll = 1;  // L L^T, which notices a matrix that is not positive definite; L D L^T does not
  }
  ~Parts() {
    cholmod_l_free_factor(&factor, &common);
    cholmod_l_finish(&common);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
};

namespace {

[[noreturn]] void fail(const cholmod_common& common) {
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  throw Error(Error::Kind::internal, "the fit's matrix is not positive definite: raise the smoothness or the ridge");
}

/// The lower triangle, column by column: unknown 10 v + i meets 10 w + j of every block (v, w), w >= v.
cholmod_sparse* lower_triangle(const BlockMatrix& matrix, cholmod_common& common) {
  std::size_t numbers = 0;
  for (std::size_t v = 0; v < matrix.rows(); ++v) numbers += 100 * matrix.columns(v).size() - 45;
  const std::size_t n = kBlock * matrix.rows();
  cholmod_sparse* sparse = cholmod_l_allocate_sparse(n, n, numbers, 1, 1, -1, CHOLMOD_REAL, &common);
  if (sparse == nullptr) fail(common);
  auto* const start = static_cast<std::int64_t*>(sparse->p);
  auto* const row = static_cast<std::int64_t*>(sparse->i);
  auto* const value = static_cast<double*>(sparse->x);
  std::int64_t at = 0;
  for (std::size_t v = 0; v < matrix.rows(); ++v) {
    const auto columns = matrix.columns(v);
    for (std::size_t i = 0; i < kBlock; ++i) {
      start[kBlock * v + i] = at;
      for (std::size_t b = 0; b < columns.size(); ++b)
        for (std::size_t j = b == 0 ? i : 0; j < kBlock; ++j) {
          row[at] = static_cast<std::int64_t>(kBlock * columns[b] + j);
          value[at++] = matrix.block(v, b)[kBlock * i + j];
        }
    }
  }
  start[n] = at;
  return sparse;
}

}  // namespace

BlockCholesky::BlockCholesky(const BlockMatrix& matrix, const Context& context) : parts_(std::make_unique<Parts>()) {
  static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));
  context.check();
  cholmod_common& common = parts_->common;
  cholmod_sparse* sparse = lower_triangle(matrix, common);
  parts_->factor = cholmod_l_analyze(sparse, &common);
  context.report("factorise", 0.1);
  if (parts_->factor != nullptr) cholmod_l_factorize(sparse, parts_->factor, &common);
  cholmod_l_free_sparse(&sparse, &common);
  context.check();
  if (parts_->factor == nullptr || common.status != CHOLMOD_OK || parts_->factor->minor < parts_->factor->n)
    fail(common);
  context.report("factorise", 1);
}

BlockCholesky::~BlockCholesky() = default;
BlockCholesky::BlockCholesky(BlockCholesky&&) noexcept = default;
BlockCholesky& BlockCholesky::operator=(BlockCholesky&&) noexcept = default;

std::size_t BlockCholesky::numbers() const {
  const cholmod_factor& factor = *parts_->factor;
  return factor.is_super != 0 ? factor.xsize : factor.nzmax;
}

void BlockCholesky::solve(std::span<double> x) const {
  cholmod_common& common = parts_->common;
  cholmod_dense right{};
  right.nrow = right.nzmax = right.d = x.size();
  right.ncol = 1;
  right.x = x.data();
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* solution = cholmod_l_solve(CHOLMOD_A, parts_->factor, &right, &common);
  if (solution == nullptr) fail(common);
  std::copy_n(static_cast<const double*>(solution->x), x.size(), x.begin());
  cholmod_l_free_dense(&solution, &common);
}

}  // namespace retalho
