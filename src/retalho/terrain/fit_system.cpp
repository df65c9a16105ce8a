#include "retalho/terrain/fit_system.h"

#include <algorithm>

#include "retalho/terrain/crease_unknowns.h"

namespace retalho {
namespace {

constexpr std::size_t kGrain = 1024;  // vertices
constexpr double kRidge = 1e-11;      // of the diagonal, towards the start: for directions that no data speak of

template <std::size_t N>
using Block = std::array<double, N * N>;

/// Adds a little to a diagonal block, and to the right-hand side what keeps `start` where nothing else speaks. Returns
/// what was added. An entry below `least` counts as that.
template <std::size_t N>
std::array<double, N> add_ridge(Block<N>& block, const double* start, double* right,
                                const std::array<double, N>& least = {}) {
  std::array<double, N> ridge{};
  for (std::size_t i = 0; i < N; ++i) {
    double& entry = block[i * N + i];
    ridge[i] = std::max(entry, least[i]) > 0 ? kRidge * std::max(entry, least[i]) : 1;
    entry += ridge[i];
    right[i] += ridge[i] * start[i];
  }
  return ridge;
}

/// Blocks of N unknowns a vertex: 1 or 3.
template <std::size_t N>
class BlockMatrix {
 public:
  BlockMatrix(const FitPattern& pattern, TriangleList triangles, std::span<const FitElement> elements,
              const Context& context)
      : pattern_(pattern), blocks_(pattern.vertex.size()), right_(pattern.vertices() * N, 0.0) {
    parallel_chunks(pattern.vertices(), kGrain, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) add_star(static_cast<std::uint32_t>(v), triangles, elements);
    });
  }

  /// Makes directions without data stay at `start`.
  void add_ridge(const std::vector<double>& start) {
    for (std::uint32_t v = 0; v < pattern_.vertices(); ++v)
      retalho::add_ridge<N>(blocks_[pattern_.slot(v, v)], &start[v * N], &right_[v * N]);
  }

  const Block<N>& block(std::uint32_t slot) const { return blocks_[slot]; }
  const std::vector<double>& right() const { return right_; }

  void multiply(const std::vector<double>& x, std::vector<double>& y, const Context& context) const {
    parallel_chunks(pattern_.vertices(), kGrain, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        std::array<double, N> sum{};
        for (std::uint32_t s = pattern_.begin[v]; s < pattern_.begin[v + 1]; ++s) {
          const Block<N>& b = blocks_[s];
          const double* in = &x[pattern_.vertex[s] * N];
          for (std::size_t i = 0; i < N; ++i)
            for (std::size_t j = 0; j < N; ++j) sum[i] += b[i * N + j] * in[j];
        }
        for (std::size_t i = 0; i < N; ++i) y[v * N + i] = sum[i];
      }
    });
  }

 private:
  void add_star(std::uint32_t v, TriangleList triangles, std::span<const FitElement> elements) {
    for (std::uint32_t k = pattern_.star_begin[v]; k < pattern_.star_begin[v + 1]; ++k) {
      const std::uint32_t t = pattern_.triangles[k];
      const auto& corners = triangles[t];
      const FitElement& e = elements[t];
      const std::size_t me = corners[0] == v ? 0 : corners[1] == v ? 1 : 2;
      for (std::size_t other = 0; other < 3; ++other) {
        Block<N>& b = blocks_[pattern_.slot(v, corners[other])];
        for (std::size_t i = 0; i < N; ++i)
          for (std::size_t j = 0; j < N; ++j) {
            const std::size_t row = me * N + i, column = other * N + j;
            b[i * N + j] += e.a[packed_index(std::min(row, column), std::max(row, column))];
          }
      }
      for (std::size_t i = 0; i < N; ++i) right_[v * N + i] += e.b[me * N + i];
    }
  }

  const FitPattern& pattern_;
  std::vector<Block<N>> blocks_;
  std::vector<double> right_;
};

/// Inverse of a symmetric positive 3 x 3 block; of its diagonal where rounding spoils it.
Block<3> inverse(const Block<3>& m) {
  const double a = m[0], b = m[1], c = m[2], d = m[4], e = m[5], f = m[8];
  const double aa = d * f - e * e, bb = c * e - b * f, cc = b * e - c * d;
  const double det = a * aa + b * bb + c * cc;
  if (!(det > 1e-10 * a * d * f)) return {1 / a, 0, 0, 0, 1 / d, 0, 0, 0, 1 / f};
  const double dd = a * f - c * c, ee = b * c - a * e, ff = a * d - b * b;
  return {aa / det, bb / det, cc / det, bb / det, dd / det, ee / det, cc / det, ee / det, ff / det};
}
Block<1> inverse(const Block<1>& m) {
  return {1 / m[0]};
}

/// Preconditioned by the diagonal blocks; what is pinned stays.
template <std::size_t N, class Multiply>
int solve_blocks(std::vector<Block<N>> jacobi, const Multiply& multiply, const std::vector<double>& right,
                 std::vector<double>& x, const CgLimits& limits, std::span<const std::uint8_t> pinned,
                 const Context& context) {
  const auto is_held = [&](std::size_t v, std::size_t i) {
    return !pinned.empty() && (pinned[v] & (i == 0 ? kHeldHeight : kHeldGradient)) != 0;
  };
  for (std::size_t v = 0; v < jacobi.size(); ++v) {
    Block<N>& d = jacobi[v];
    for (std::size_t i = 0; i < N; ++i) {  // the block of what is free
      if (!is_held(v, i)) continue;
      for (std::size_t j = 0; j < N; ++j) d[i * N + j] = d[j * N + i] = 0;
      d[i * N + i] = 1;
    }
    d = inverse(d);
  }
  const auto hold = [&](std::vector<double>& y) {
    if (pinned.empty()) return;
    for (std::size_t v = 0; v < jacobi.size(); ++v)
      for (std::size_t i = 0; i < N; ++i)
        if (is_held(v, i)) y[v * N + i] = 0;
  };
  const auto precondition = [&](const std::vector<double>& r, std::vector<double>& y) {
    parallel_chunks(jacobi.size(), kGrain * 4, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v)
        for (std::size_t i = 0; i < N; ++i) {
          double sum = 0;
          for (std::size_t j = 0; j < N; ++j) sum += jacobi[v][i * N + j] * r[v * N + j];
          y[v * N + i] = sum;
        }
    });
    hold(y);
  };
  return conjugate_gradients(multiply, precondition, right, x, limits, context);
}

/// The plain problem.
template <std::size_t N>
int solve_plain(const FitPattern& pattern, const BlockMatrix<N>& matrix, std::vector<double>& x,
                const FitSolveOptions& options, const Context& context) {
  std::vector<Block<N>> diagonal(pattern.vertices());
  for (std::uint32_t v = 0; v < pattern.vertices(); ++v) diagonal[v] = matrix.block(pattern.slot(v, v));
  const auto multiply = [&](const std::vector<double>& in, std::vector<double>& out) {
    matrix.multiply(in, out, context);
  };
  return solve_blocks<N>(std::move(diagonal), multiply, matrix.right(), x, options.limits, options.pinned, context);
}

/// Gradients as a linear function of the heights: u = P z.
class FacetMean {
 public:
  FacetMean(const FitPattern& pattern, TriangleList triangles, std::span<const Vec2> points)
      : pattern_(pattern), of_(pattern.vertex.size()), to_(pattern.vertex.size()) {
    for (std::uint32_t v = 0; v < pattern.vertices(); ++v) {
      double area2 = 0;
      for (std::uint32_t k = pattern.star_begin[v]; k < pattern.star_begin[v + 1]; ++k) {
        const auto& t = triangles[pattern.triangles[k]];
        area2 += cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
        for (std::size_t i = 0; i < 3; ++i) {
          const Vec2 opposite = points[t[(i + 2) % 3]] - points[t[(i + 1) % 3]];
          Vec2& at = of_[pattern.slot(v, t[i])];
          at = at + Vec2{-opposite.y, opposite.x};
        }
      }
      for (std::uint32_t s = pattern.begin[v]; s < pattern.begin[v + 1]; ++s)
        of_[s] = area2 > 0 ? of_[s] / area2 : Vec2{};
    }
    for (std::uint32_t v = 0; v < pattern.vertices(); ++v)
      for (std::uint32_t s = pattern.begin[v]; s < pattern.begin[v + 1]; ++s)
        to_[s] = of_[pattern.slot(pattern.vertex[s], v)];
  }

  void expand(const std::vector<double>& z, std::vector<double>& u, const Context& context) const {
    parallel_chunks(pattern_.vertices(), kGrain, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        Vec2 g;
        for (std::uint32_t s = pattern_.begin[v]; s < pattern_.begin[v + 1]; ++s)
          g = g + z[pattern_.vertex[s]] * of_[s];
        u[3 * v] = z[v];
        u[3 * v + 1] = g.x;
        u[3 * v + 2] = g.y;
      }
    });
  }
  void gather(const std::vector<double>& u, std::vector<double>& z, const Context& context) const {
    parallel_chunks(pattern_.vertices(), kGrain, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        double sum = u[3 * v];
        for (std::uint32_t s = pattern_.begin[v]; s < pattern_.begin[v + 1]; ++s) {
          const double* in = &u[3 * std::size_t{pattern_.vertex[s]}];
          sum += to_[s].x * in[1] + to_[s].y * in[2];
        }
        z[v] = sum;
      }
    });
  }
  /// Diagonal entry v of P'AP.
  double diagonal(const BlockMatrix<3>& a, std::uint32_t v) const {
    const auto column = [&](std::uint32_t slot) {
      return std::array<double, 3>{pattern_.vertex[slot] == v ? 1.0 : 0.0, to_[slot].x, to_[slot].y};
    };
    double sum = 0;
    for (std::uint32_t s = pattern_.begin[v]; s < pattern_.begin[v + 1]; ++s) {
      const auto left = column(s);
      for (std::uint32_t t = pattern_.begin[v]; t < pattern_.begin[v + 1]; ++t) {
        const std::uint32_t between = pattern_.slot(pattern_.vertex[s], pattern_.vertex[t]);
        if (between == kNone) continue;
        const auto right = column(t);
        const Block<3>& b = a.block(between);
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j) sum += left[i] * b[i * 3 + j] * right[j];
      }
    }
    return sum;
  }

 private:
  const FitPattern& pattern_;
  std::vector<Vec2> of_;  // slot (v, w): what z_w adds to the gradient of v
  std::vector<Vec2> to_;  // slot (v, w): what z_v adds to the gradient of w
};

int solve_heights(const FitPattern& pattern, const BlockMatrix<3>& matrix, const FacetMean& mean,
                  std::vector<double>& z, const FitSolveOptions& options, const Context& context) {
  const std::size_t n = pattern.vertices();
  std::vector<double> u(3 * n), au(3 * n), right(n), jacobi(n);
  mean.gather(matrix.right(), right, context);
  parallel_chunks(n, kGrain, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) jacobi[v] = mean.diagonal(matrix, static_cast<std::uint32_t>(v));
  });
  for (std::size_t v = 0; v < n; ++v) {
    const bool free = jacobi[v] > 0 && (options.pinned.empty() || (options.pinned[v] & kHeldHeight) == 0);
    jacobi[v] = free ? 1 / jacobi[v] : 0;
  }
  const auto precondition = [&](const std::vector<double>& r, std::vector<double>& y) {
    for (std::size_t v = 0; v < n; ++v) y[v] = jacobi[v] * r[v];
  };
  const auto multiply = [&](const std::vector<double>& in, std::vector<double>& out) {
    mean.expand(in, u, context);
    matrix.multiply(u, au, context);
    mean.gather(au, out, context);
  };
  return conjugate_gradients(multiply, precondition, right, z, options.limits, context);
}

}  // namespace

FitPattern::FitPattern(TriangleList list, std::size_t count, const Context& context) {
  star_begin.assign(count + 1, 0);
  for (const auto& t : list)
    for (const std::uint32_t v : t) ++star_begin[v + 1];
  for (std::size_t v = 0; v < count; ++v) star_begin[v + 1] += star_begin[v];
  triangles.resize(star_begin.back());
  std::vector<std::uint32_t> next(star_begin.begin(), star_begin.end() - 1);
  for (std::uint32_t t = 0; t < list.size(); ++t)
    for (const std::uint32_t v : list[t]) triangles[next[v]++] = t;
  const auto row_of = [&](std::size_t v, std::vector<std::uint32_t>& row) {
    row.assign(1, static_cast<std::uint32_t>(v));
    for (std::uint32_t k = star_begin[v]; k < star_begin[v + 1]; ++k)
      for (const std::uint32_t w : list[triangles[k]]) row.push_back(w);
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  };
  begin.assign(count + 1, 0);
  std::vector<std::uint32_t> row;
  for (std::size_t v = 0; v < count; ++v) {
    row_of(v, row);
    begin[v + 1] = begin[v] + static_cast<std::uint32_t>(row.size());
    vertex.insert(vertex.end(), row.begin(), row.end());
  }
  context.check();
}

std::uint32_t FitPattern::slot(std::uint32_t row, std::uint32_t column) const {
  for (std::uint32_t s = begin[row]; s < begin[row + 1]; ++s)
    if (vertex[s] == column) return s;
  return kNone;
}

int solve_fit(SurfaceKind kind, TriangleList triangles, std::span<const FitElement> elements,
              std::span<const Vec2> points, std::vector<Vec3>& data, const FitSolveOptions& options,
              const Context& context) {
  const std::size_t n = data.size();
  const FitPattern pattern(triangles, n, context);
  std::vector<double> x;
  int iterations = 0;
  if (kind == SurfaceKind::linear) {
    x.resize(n);
    for (std::size_t v = 0; v < n; ++v) x[v] = data[v].x;
    BlockMatrix<1> matrix(pattern, triangles, elements, context);
    matrix.add_ridge(x);
    iterations = solve_plain<1>(pattern, matrix, x, options, context);
    for (std::size_t v = 0; v < n; ++v) data[v].x = x[v];
    return iterations;
  }
  BlockMatrix<3> matrix(pattern, triangles, elements, context);
  x.resize(3 * n);
  if (options.heights_only) {
    const FacetMean mean(pattern, triangles, points);
    std::vector<double> z(n);
    for (std::size_t v = 0; v < n; ++v) z[v] = data[v].x;
    mean.expand(z, x, context);
    matrix.add_ridge(x);
    iterations = solve_heights(pattern, matrix, mean, z, options, context);
    mean.expand(z, x, context);
  } else {
    for (std::size_t v = 0; v < n; ++v) {
      x[3 * v] = data[v].x;
      x[3 * v + 1] = data[v].y;
      x[3 * v + 2] = data[v].z;
    }
    matrix.add_ridge(x);
    iterations = solve_plain<3>(pattern, matrix, x, options, context);
  }
  for (std::size_t v = 0; v < n; ++v) data[v] = {x[3 * v], x[3 * v + 1], x[3 * v + 2]};
  return iterations;
}

int solve_creased(const CreasedUnknowns& unknowns, std::span<const FitElement> elements, std::vector<Vec3>& data,
                  const FitSolveOptions& options, const Context& context) {
  const std::size_t n = unknowns.nodes();
  const FitPattern pattern(unknowns.triangles(), unknowns.corners(), context);
  const BlockMatrix<3> matrix(pattern, unknowns.triangles(), elements, context);
  std::vector<double> x(3 * n), u(3 * unknowns.corners()), au(u.size()), right(x.size()), ridge(x.size());
  std::vector<std::uint8_t> pinned(n, 0);
  for (std::uint32_t k = 0; k < n; ++k) {
    x[3 * k] = data[k].x;
    x[3 * k + 1] = data[k].y;
    x[3 * k + 2] = data[k].z;
    if (!options.pinned.empty() && unknowns.vertex(k) != kNone) pinned[k] = options.pinned[unknowns.vertex(k)];
    if (k >= unknowns.vertices()) pinned[k] |= kHeldHeight;
  }
  unknowns.gather(matrix.right(), right, context);
  std::vector<Block<3>> diagonal = unknowns.diagonal(elements);
  // The cells of a small sector may all lie where its gradient has no effect but by rounding: what counts as an effect
  // goes by the others'.
  std::array<double, 3> mean{};
  for (const Block<3>& block : diagonal)
    for (std::size_t i = 0; i < 3; ++i) mean[i] += block[4 * i] / static_cast<double>(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto added = add_ridge<3>(diagonal[k], &x[3 * k], &right[3 * k], mean);
    std::copy(added.begin(), added.end(), &ridge[3 * k]);
  }
  const auto multiply = [&](const std::vector<double>& in, std::vector<double>& out) {
    unknowns.expand(in, u, context);
    matrix.multiply(u, au, context);
    unknowns.gather(au, out, context);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += ridge[k] * in[k];
  };
  const int iterations = solve_blocks<3>(std::move(diagonal), multiply, right, x, options.limits, pinned, context);
  for (std::size_t k = 0; k < n; ++k) data[k] = {x[3 * k], x[3 * k + 1], x[3 * k + 2]};
  return iterations;
}

}  // namespace retalho
