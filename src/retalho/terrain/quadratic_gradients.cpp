// Least-squares quadratic over two rings. The matrix is turned into a triangle row by row with Givens rotations: the
// accuracy of an orthogonal factorisation, in a fixed 5 x 6 array, whatever the number of neighbours.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "retalho/core/parallel.h"
#include "retalho/terrain/gradient_estimates.h"

namespace retalho {
namespace {

constexpr std::size_t kMostNeighbors = 256;
/// Below this ratio of the smallest to the largest pivot (columns scaled to length one) the rings count as lying on a
/// conic.
constexpr double kRankTolerance = 1e-6;

/// The upper triangle of an N-column least-squares problem with its right-hand side as column N.
template <std::size_t N>
class RotatedRows {
 public:
  void add(std::array<double, N + 1> row) {
    for (std::size_t k = 0; k < N; ++k) {
      if (row[k] == 0) continue;
      auto& top = rows_[k];
      const double length = std::hypot(top[k], row[k]);
      const double c = top[k] / length, s = row[k] / length;
      for (std::size_t m = k; m <= N; ++m) {
        const double t = c * top[m] + s * row[m];
        row[m] = c * row[m] - s * top[m];
        top[m] = t;
      }
    }
  }

  /// Solves; false when the columns are not independent.
  bool solve(std::array<double, N>& x) const {
    constexpr int n = static_cast<int>(N);
    Eigen::Matrix<double, n, n> a = Eigen::Matrix<double, n, n>::Zero();
    Eigen::Matrix<double, n, 1> b, scale;
    for (std::size_t r = 0; r < N; ++r) {
      for (std::size_t c = r; c < N; ++c) a(static_cast<int>(r), static_cast<int>(c)) = rows_[r][c];
      b(static_cast<int>(r)) = rows_[r][N];
    }
    for (int c = 0; c < n; ++c) {
      scale(c) = a.col(c).norm();
      if (!(scale(c) > 0)) return false;
      a.col(c) /= scale(c);
    }
    Eigen::ColPivHouseholderQR<Eigen::Matrix<double, n, n>> qr;
    qr.setThreshold(kRankTolerance);
    qr.compute(a);
    if (qr.rank() < n) return false;
    const Eigen::Matrix<double, n, 1> y = qr.solve(b);
    for (int c = 0; c < n; ++c) x[static_cast<std::size_t>(c)] = y(c) / scale(c);
    return true;
  }

 private:
  std::array<std::array<double, N + 1>, N> rows_{};
};

/// Both rings of `v` without itself, ascending, no vertex twice; the first ring first when there are too many.
void collect_two_rings(const VertexRings& rings, std::uint32_t v, std::vector<std::uint32_t>& out) {
  out.clear();
  const auto begin = [&](std::uint32_t w) { return rings.neighbors.begin() + rings.begin[w]; };
  const auto end = [&](std::uint32_t w) { return rings.neighbors.begin() + rings.begin[w + 1]; };
  out.insert(out.end(), begin(v), end(v));
  if (out.size() > kMostNeighbors) out.resize(kMostNeighbors);
  const std::size_t first = out.size();
  for (std::size_t k = 0; k < first && out.size() < kMostNeighbors; ++k)
    for (auto w = begin(out[k]); w != end(out[k]) && out.size() < 4 * kMostNeighbors; ++w)
      if (*w != v) out.push_back(*w);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

Vec2 fit_at(const Tin& tin, std::uint32_t v, const std::vector<std::uint32_t>& around) {
  const Vec2 at = tin.points[v];
  double size = 0;
  for (const std::uint32_t w : around) size += norm(tin.points[w] - at);
  size /= static_cast<double>(around.size());
  RotatedRows<5> quadratic;
  RotatedRows<2> plane;
  for (const std::uint32_t w : around) {
    const Vec2 d = (tin.points[w] - at) / size;
    const double weight = 1 / norm(d);
    const double dz = weight * (tin.heights[w] - tin.heights[v]);
    quadratic.add({weight * d.x, weight * d.y, weight * d.x * d.x, weight * d.x * d.y, weight * d.y * d.y, dz});
    plane.add({weight * d.x, weight * d.y, dz});
  }
  std::array<double, 5> q{};
  if (around.size() >= 5 && quadratic.solve(q)) return Vec2{q[0], q[1]} / size;
  std::array<double, 2> p{};
  if (plane.solve(p)) return Vec2{p[0], p[1]} / size;
  return {};
}

}  // namespace

std::vector<Vec2> quadratic_gradients(const Tin& tin, const VertexRings& rings, const Context& context) {
  std::vector<Vec2> gradients(tin.vertex_count());
  parallel_chunks(gradients.size(), 1024, context, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> around;
    around.reserve(4 * kMostNeighbors);
    for (std::size_t v = begin; v < end; ++v) {
      collect_two_rings(rings, static_cast<std::uint32_t>(v), around);
      if (!around.empty()) gradients[v] = fit_at(tin, static_cast<std::uint32_t>(v), around);
    }
  });
  return gradients;
}

}  // namespace retalho
