#include "retalho/tetraquad/block_cg.h"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "retalho/core/error.h"

namespace retalho {
namespace {

using Block = Eigen::Matrix<double, 10, 10, Eigen::RowMajor>;
using Ten = Eigen::Matrix<double, 10, 1>;

/// (D + L) D^-1 (D + L'), with D the diagonal blocks and L' what stands to their right.
class GaussSeidel {
 public:
  explicit GaussSeidel(const BlockMatrix& matrix) : matrix_(matrix), inverse_(matrix.rows()) {
    for (std::size_t v = 0; v < matrix.rows(); ++v) {
      const Eigen::LLT<Block> factor(Eigen::Map<const Block>(matrix.block(v, 0)));
      if (factor.info() != Eigen::Success)
        throw Error(Error::Kind::internal, "conjugate gradients: a diagonal block is not positive definite");
      inverse_[v] = factor.solve(Block::Identity());
    }
  }

  /// z = M^-1 r.
  void apply(std::span<const double> r, std::span<double> z) const {
    std::copy(r.begin(), r.end(), z.begin());
    for (std::size_t v = 0; v < matrix_.rows(); ++v) {
      const auto columns = matrix_.columns(v);
      Eigen::Map<Ten> own(z.data() + kBlock * v);
      own = (inverse_[v] * own).eval();
      for (std::size_t n = 1; n < columns.size(); ++n)
        Eigen::Map<Ten>(z.data() + kBlock * columns[n]).noalias() -=
            Eigen::Map<const Block>(matrix_.block(v, n)).transpose() * own;
    }
    for (std::size_t v = matrix_.rows(); v-- > 0;) {
      const auto columns = matrix_.columns(v);
      Ten pull = Ten::Zero();
      for (std::size_t n = 1; n < columns.size(); ++n)
        pull.noalias() +=
            Eigen::Map<const Block>(matrix_.block(v, n)) * Eigen::Map<const Ten>(z.data() + kBlock * columns[n]);
      Eigen::Map<Ten>(z.data() + kBlock * v).noalias() -= inverse_[v] * pull;
    }
  }

 private:
  const BlockMatrix& matrix_;
  std::vector<Block> inverse_;
};

double dot(std::span<const double> a, std::span<const double> b) {
  const auto n = static_cast<Eigen::Index>(a.size());
  return Eigen::Map<const Eigen::VectorXd>(a.data(), n).dot(Eigen::Map<const Eigen::VectorXd>(b.data(), n));
}

}  // namespace

CgNotes solve_cg(const BlockMatrix& matrix, std::span<const double> right, std::span<double> x,
                 const CgOptions& options, const Context& context) {
  const std::size_t size = right.size();
  const GaussSeidel sweep(matrix);
  std::vector<double> r(size), z(size), p(size), q(size);
  sweep.apply(right, z);
  const double whole = dot(right, z);
  CgNotes notes;
  if (!(whole > 0)) {
    std::fill(x.begin(), x.end(), 0.0);
    return notes;
  }
  matrix.multiply(x, q);
  for (std::size_t k = 0; k < size; ++k) r[k] = right[k] - q[k];
  sweep.apply(r, z);
  p = z;
  double rho = dot(r, z);
  while (true) {
    notes.residual = std::sqrt(std::max(0.0, rho) / whole);
    if (notes.residual <= options.tolerance || notes.iterations >= options.most) return notes;
    context.check();
    matrix.multiply(p, q);
    const double curvature = dot(p, q);
    if (!(curvature > 0)) return notes;  // what is left is rounding
    const double step = rho / curvature;
    for (std::size_t k = 0; k < size; ++k) {
      x[k] += step * p[k];
      r[k] -= step * q[k];
    }
    sweep.apply(r, z);
    const double next = dot(r, z);
    for (std::size_t k = 0; k < size; ++k) p[k] = z[k] + next / rho * p[k];
    rho = next;
    ++notes.iterations;
  }
}

}  // namespace retalho
