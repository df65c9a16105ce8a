// Symmetric sparse matrices of 10 x 10 blocks, one block row a vertex, and their factors. Internal to the room.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "retalho/core/context.h"

namespace retalho {

inline constexpr std::size_t kBlock = 10;

/// Blocks (v, w) with w >= v, row by row; the diagonal block is the first of its row and full.
class BlockMatrix {
 public:
  BlockMatrix() = default;
  /// `pairs`: which blocks there are, in any order, doubles allowed; diagonal ones need not be named.
  BlockMatrix(std::size_t rows, std::vector<std::array<std::uint32_t, 2>> pairs);

  std::size_t rows() const { return start_.empty() ? 0 : start_.size() - 1; }
  std::span<const std::uint32_t> columns(std::size_t row) const {
    return {column_.data() + start_[row], column_.data() + start_[row + 1]};
  }
  /// 100 numbers, row-major: entry (i, j) couples unknown 10 v + i with 10 w + j.
  double* block(std::size_t row, std::size_t n) { return value_.data() + 100 * (start_[row] + n); }
  const double* block(std::size_t row, std::size_t n) const { return value_.data() + 100 * (start_[row] + n); }
  /// Adds `factor(i, j)` at (i, j) of block (v, w), transposed where w < v.
  template <typename Value>
  void add(std::uint32_t v, std::uint32_t w, const Value& value) {
    double* at = find(v < w ? v : w, v < w ? w : v);
    for (std::size_t i = 0; i < kBlock; ++i)
      for (std::size_t j = 0; j < kBlock; ++j) at[10 * i + j] += v <= w ? value(i, j) : value(j, i);
  }
  /// Adds to the diagonal.
  void add_ridge(double value);
  double mean_diagonal() const;
  /// y = A x.
  void multiply(std::span<const double> x, std::span<double> y) const;

 private:
  double* find(std::uint32_t row, std::uint32_t column);
  std::vector<std::size_t> start_;
  std::vector<std::uint32_t> column_;
  std::vector<double> value_;
};

/// Cholesky factors by the multifrontal method: an order of minimum degree on the blocks, a dense front for each
/// supernode. Cost for a surface of n vertices: about n^1.5 flops, n log n numbers.
class BlockCholesky {
 public:
  /// Throws Error (internal) when the matrix is not positive definite.
  explicit BlockCholesky(const BlockMatrix& matrix, const Context& context = {});
  ~BlockCholesky();
  BlockCholesky(BlockCholesky&&) noexcept;
  BlockCholesky& operator=(BlockCholesky&&) noexcept;

  /// Overwrites the right-hand side with the solution.
  void solve(std::span<double> x) const;
  std::size_t numbers() const;  ///< stored in the factors

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Solves with the factors of A + ridge, then takes the ridge's pull off by a proximal step: what A determines comes
/// out as A says, what it leaves open stays small.
void solve_past_ridge(const BlockCholesky& factors, double ridge, std::span<double> x);

}  // namespace retalho
