// Least squares with few unknowns. Internal to the room patch.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace retalho {

/// The pseudo-inverse of an m x n matrix, n <= 9 <= or so, by Householder's QR. One object is used again and again.
class SmallFit {
 public:
  /// Starts a matrix with m rows and n columns; entry (i, j) is at(i, j).
  void resize(std::size_t m, std::size_t n) {
    m_ = m, n_ = n;
    a_.assign(m * n, 0.0);
  }
  double& at(std::size_t i, std::size_t j) { return a_[j * m_ + i]; }

  /// Factors. Returns ||R|| ||1/R|| in Frobenius' norm, at least the condition number; infinite for a matrix without
  /// full rank or with fewer rows than columns.
  double factor() {
    if (m_ < n_) return INFINITY;
    diagonal_.assign(n_, 0.0);
    for (std::size_t j = 0; j < n_; ++j) {
      double* v = &a_[j * m_];
      double sum = 0;
      for (std::size_t i = j; i < m_; ++i) sum += v[i] * v[i];
      const double length = std::sqrt(sum);
      if (!(length > 0)) return INFINITY;
      const double alpha = v[j] > 0 ? -length : length;
      diagonal_[j] = alpha;
      v[j] -= alpha;
      const double scale = 1 / (sum - alpha * (v[j] + alpha));  // 2 / (v . v)
      for (std::size_t k = j + 1; k < n_; ++k) {
        double* w = &a_[k * m_];
        double d = 0;
        for (std::size_t i = j; i < m_; ++i) d += v[i] * w[i];
        d *= scale;
        for (std::size_t i = j; i < m_; ++i) w[i] -= d * v[i];
      }
      scales_[j] = scale;
    }
    // 1/R, upper triangular, column by column.
    double norm_r = 0, norm_inverse = 0;
    for (std::size_t j = 0; j < n_; ++j) {
      for (std::size_t i = 0; i < n_; ++i) inverse_[i][j] = 0;
      inverse_[j][j] = 1 / diagonal_[j];
      for (std::size_t i = j; i-- > 0;) {
        double d = 0;
        for (std::size_t k = i + 1; k <= j; ++k) d += a_[k * m_ + i] * inverse_[k][j];
        inverse_[i][j] = -d / diagonal_[i];
      }
      norm_r += diagonal_[j] * diagonal_[j];
      for (std::size_t i = 0; i < j; ++i) norm_r += a_[j * m_ + i] * a_[j * m_ + i];
      for (std::size_t i = 0; i <= j; ++i) norm_inverse += inverse_[i][j] * inverse_[i][j];
    }
    const double condition = std::sqrt(norm_r * norm_inverse);
    return std::isfinite(condition) ? condition : INFINITY;
  }

  /// After factor(): row j of the pseudo-inverse into out[j * m ...]. n x m numbers.
  void pseudo_inverse(std::vector<double>& out) {
    out.assign(n_ * m_, 0.0);
    for (std::size_t j = 0; j < n_; ++j)  // Q [1/R^T]'s column j: start with row j of 1/R on top
      for (std::size_t k = 0; k < n_; ++k) out[j * m_ + k] = inverse_[j][k];
    for (std::size_t r = n_; r-- > 0;) {
      const double* v = &a_[r * m_];
      for (std::size_t j = 0; j < n_; ++j) {
        double* w = &out[j * m_];
        double d = 0;
        for (std::size_t i = r; i < m_; ++i) d += v[i] * w[i];
        d *= scales_[r];
        for (std::size_t i = r; i < m_; ++i) w[i] -= d * v[i];
      }
    }
  }

 private:
  std::size_t m_ = 0, n_ = 0;
  std::vector<double> a_, diagonal_;
  double scales_[10] = {}, inverse_[10][10] = {};
};

/// Vertices about a vertex, ring after ring, until there are enough.
class Rings {
 public:
  Rings(const std::vector<std::uint32_t>& first, const std::vector<std::uint32_t>& neighbors)
      : first_(first), neighbors_(neighbors), seen_(first.size(), 0) {}
  /// `start` and whole rings about it, nearest first, at least `count` beside the start where there are as many, and
  /// at most `rings`.
  const std::vector<std::uint32_t>& grow(const std::vector<std::uint32_t>& start, std::size_t count, int rings) {
    ++mark_;
    found_ = start;
    for (const std::uint32_t v : start) seen_[v] = mark_;
    std::size_t from = 0;
    for (int r = 0; r < rings && found_.size() < count + start.size(); ++r) {
      const std::size_t to = found_.size();
      for (; from < to; ++from)
        for (std::uint32_t k = first_[found_[from]]; k < first_[found_[from] + 1]; ++k)
          if (seen_[neighbors_[k]] != mark_) {
            seen_[neighbors_[k]] = mark_;
            found_.push_back(neighbors_[k]);
          }
      if (found_.size() == to) break;
    }
    return found_;
  }

 private:
  const std::vector<std::uint32_t>&first_, &neighbors_;
  std::vector<std::uint32_t> seen_, found_;
  std::uint32_t mark_ = 0;
};

}  // namespace retalho
