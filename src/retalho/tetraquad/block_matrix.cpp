#include "retalho/tetraquad/block_matrix.h"

#include <algorithm>
#include <stdexcept>

namespace retalho {

BlockMatrix::BlockMatrix(std::size_t rows, std::vector<std::array<std::uint32_t, 2>> pairs) {
  for (auto& pair : pairs)
    if (pair[0] > pair[1]) std::swap(pair[0], pair[1]);
  for (std::uint32_t v = 0; v < rows; ++v) pairs.push_back({v, v});
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  start_.assign(rows + 1, 0);
  column_.reserve(pairs.size());
  for (const auto& [v, w] : pairs) {
    ++start_[v + 1];
    column_.push_back(w);
  }
  for (std::size_t v = 0; v < rows; ++v) start_[v + 1] += start_[v];
  value_.assign(100 * column_.size(), 0.0);
}

double* BlockMatrix::find(std::uint32_t row, std::uint32_t column) {
  const auto first = column_.begin() + static_cast<std::ptrdiff_t>(start_[row]);
  const auto last = column_.begin() + static_cast<std::ptrdiff_t>(start_[row + 1]);
  const auto at = std::lower_bound(first, last, column);
  if (at == last || *at != column) throw std::logic_error("BlockMatrix: no such block");
  return value_.data() + 100 * static_cast<std::size_t>(at - column_.begin());
}

void BlockMatrix::add_ridge(double value) {
  for (std::size_t v = 0; v < rows(); ++v)
    for (std::size_t i = 0; i < kBlock; ++i) block(v, 0)[11 * i] += value;
}

double BlockMatrix::mean_diagonal() const {
  double sum = 0;
  for (std::size_t v = 0; v < rows(); ++v)
    for (std::size_t i = 0; i < kBlock; ++i) sum += block(v, 0)[11 * i];
  return rows() == 0 ? 0 : sum / static_cast<double>(kBlock * rows());
}

void BlockMatrix::multiply(std::span<const double> x, std::span<double> y) const {
  std::fill(y.begin(), y.end(), 0.0);
  for (std::size_t v = 0; v < rows(); ++v) {
    const auto row = columns(v);
    const double* xv = x.data() + kBlock * v;
    double* yv = y.data() + kBlock * v;
    for (std::size_t n = 0; n < row.size(); ++n) {
      const double* a = block(v, n);
      const double* xw = x.data() + kBlock * row[n];
      double* yw = y.data() + kBlock * row[n];
      for (std::size_t i = 0; i < kBlock; ++i) {
        double sum = 0;
        for (std::size_t j = 0; j < kBlock; ++j) sum += a[10 * i + j] * xw[j];
        yv[i] += sum;
        if (n > 0)
          for (std::size_t j = 0; j < kBlock; ++j) yw[j] += a[10 * i + j] * xv[i];
      }
    }
  }
}

void solve_past_ridge(const BlockCholesky& factors, double ridge, std::span<double> x) {
  factors.solve(x);
  std::vector<double> step(x.begin(), x.end());
  for (double& value : step) value *= ridge;
  factors.solve(step);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] += step[k];
}

}  // namespace retalho
