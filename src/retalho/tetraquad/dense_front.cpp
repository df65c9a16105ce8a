#include "retalho/tetraquad/dense_front.h"

#include <Eigen/Dense>
#include <algorithm>

namespace retalho {

bool factor_front(double* a, std::size_t n, std::size_t pivots) {
  using Matrix = Eigen::Map<Eigen::MatrixXd>;
  const auto size = static_cast<Eigen::Index>(n), columns = static_cast<Eigen::Index>(pivots);
  Matrix front(a, size, size);
  constexpr Eigen::Index panel = 64;
  for (Eigen::Index k = 0; k < columns; k += panel) {
    const Eigen::Index width = std::min(panel, columns - k), below = size - k - width;
    Eigen::Ref<Eigen::MatrixXd> corner = front.block(k, k, width, width);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(corner);
    if (llt.info() != Eigen::Success) return false;
    if (below == 0) break;
    auto left = front.block(k + width, k, below, width);
    corner.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(left);
    front.block(k + width, k + width, below, below).selfadjointView<Eigen::Lower>().rankUpdate(left, -1);
  }
  return true;
}

}  // namespace retalho
