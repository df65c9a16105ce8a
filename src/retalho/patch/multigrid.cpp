#include "retalho/patch/multigrid.h"

#include <Eigen/Dense>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"

namespace retalho {
namespace {

struct Vec2f {
  float x = 0, y = 0;
};

constexpr std::size_t kCoarsest = 400;
constexpr std::uint32_t kNone32 = 0xffffffffU;

/// A square or rectangular sparse matrix by rows, single precision.
struct Matrix {
  std::vector<std::uint32_t> first = {0}, columns;
  std::vector<float> values;
  std::size_t rows() const { return first.size() - 1; }
};

struct Level {
  Matrix a;                     ///< off-diagonal entries
  std::vector<float> diagonal;  ///< and the diagonal
  Matrix p;                     ///< to the next, coarser level
  Matrix pt;                    ///< its transpose
  std::vector<Vec2f> x, r;
};

/// Groups of strongly connected unknowns.
std::vector<std::uint32_t> aggregate(const Level& level, std::size_t& count) {
  const Matrix& a = level.a;
  const std::size_t n = a.rows();
  std::vector<float> bound(n);
  for (std::size_t i = 0; i < n; ++i) {
    float largest = 0;
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) largest = std::max(largest, -a.values[k]);
    bound[i] = 0.1F * largest;
  }
  const auto strong = [&](std::size_t i, std::uint32_t k) { return -a.values[k] >= bound[i] && a.values[k] < 0; };
  std::vector<std::uint32_t> group(n, kNone32);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (group[i] != kNone32) continue;
    bool free = true;
    for (std::uint32_t k = a.first[i]; free && k < a.first[i + 1]; ++k)
      free = !strong(i, k) || group[a.columns[k]] == kNone32;
    if (!free) continue;
    group[i] = next;
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k)
      if (strong(i, k)) group[a.columns[k]] = next;
    ++next;
  }
  std::vector<std::uint32_t> second = group;
  for (std::size_t i = 0; i < n; ++i) {
    if (group[i] != kNone32) continue;
    float best = 0;
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k)
      if (group[a.columns[k]] != kNone32 && -a.values[k] > best) {
        best = -a.values[k];
        second[i] = group[a.columns[k]];
      }
  }
  for (std::size_t i = 0; i < n; ++i)
    if (second[i] == kNone32) second[i] = next++;
  count = next;
  return second;
}

Matrix transpose(const Matrix& a, std::size_t columns) {
  Matrix t;
  t.first.assign(columns + 1, 0);
  for (const std::uint32_t c : a.columns) ++t.first[c + 1];
  for (std::size_t i = 0; i < columns; ++i) t.first[i + 1] += t.first[i];
  t.columns.resize(a.columns.size());
  t.values.resize(a.values.size());
  std::vector<std::uint32_t> at(t.first.begin(), t.first.end() - 1);
  for (std::uint32_t i = 0; i < a.rows(); ++i)
    for (std::uint32_t k = a.first[i]; k < a.first[i + 1]; ++k) {
      const std::uint32_t place = at[a.columns[k]]++;
      t.columns[place] = i;
      t.values[place] = a.values[k];
    }
  return t;
}

/// (1 - w A / D) applied to the groups' indicator functions; weak entries count as diagonal.
Matrix prolongation(const Level& level, const std::vector<std::uint32_t>& group, std::size_t groups) {
  constexpr float kRelax = 0.66F;
  Matrix p;
  const std::size_t n = level.a.rows();
  p.first.reserve(n + 1);
  std::vector<std::uint32_t> place(groups, kNone32);
  for (std::size_t i = 0; i < n; ++i) {
    const auto start = static_cast<std::uint32_t>(p.columns.size());
    const float scale = kRelax / level.diagonal[i];
    p.columns.push_back(group[i]);
    p.values.push_back(1 - kRelax);
    place[group[i]] = start;
    for (std::uint32_t k = level.a.first[i]; k < level.a.first[i + 1]; ++k) {
      const std::uint32_t g = group[level.a.columns[k]];
      if (place[g] == kNone32) {
        place[g] = static_cast<std::uint32_t>(p.columns.size());
        p.columns.push_back(g);
        p.values.push_back(0);
      }
      p.values[place[g]] -= scale * level.a.values[k];
    }
    for (std::size_t k = start; k < p.columns.size(); ++k) place[p.columns[k]] = kNone32;
    p.first.push_back(static_cast<std::uint32_t>(p.columns.size()));
  }
  return p;
}

/// P^T A P.
Level coarser(const Level& fine, std::size_t count) {
  Level level;
  std::vector<std::uint32_t> place(count, kNone32), touched;
  std::vector<float> sum(count, 0);
  level.a.first.reserve(count + 1);
  level.diagonal.resize(count);
  for (std::uint32_t c = 0; c < count; ++c) {
    touched.clear();
    const auto add_row = [&](std::uint32_t row, float scale) {
      for (std::uint32_t k = fine.p.first[row]; k < fine.p.first[row + 1]; ++k) {
        const std::uint32_t column = fine.p.columns[k];
        if (place[column] != c) {
          place[column] = c;
          touched.push_back(column);
          sum[column] = 0;
        }
        sum[column] += scale * fine.p.values[k];
      }
    };
    for (std::uint32_t k = fine.pt.first[c]; k < fine.pt.first[c + 1]; ++k) {
      const std::uint32_t row = fine.pt.columns[k];
      const float weight = fine.pt.values[k];
      add_row(row, weight * fine.diagonal[row]);
      for (std::uint32_t e = fine.a.first[row]; e < fine.a.first[row + 1]; ++e)
        add_row(fine.a.columns[e], weight * fine.a.values[e]);
    }
    std::sort(touched.begin(), touched.end());
    level.diagonal[c] = 1;
    for (const std::uint32_t column : touched) {
      if (column == c) {
        level.diagonal[c] = sum[column];
      } else if (sum[column] != 0) {
        level.a.columns.push_back(column);
        level.a.values.push_back(sum[column]);
      }
    }
    level.a.first.push_back(static_cast<std::uint32_t>(level.a.columns.size()));
  }
  return level;
}

class Multigrid {
 public:
  Multigrid(const ConvexSystem& system, const Context& context) {
    Level finest;
    finest.a.first = system.first;
    finest.a.columns = system.columns;
    finest.a.values.resize(system.values.size());
    for (std::size_t k = 0; k < system.values.size(); ++k) finest.a.values[k] = -static_cast<float>(system.values[k]);
    finest.diagonal.assign(system.size(), 1);
    levels_.push_back(std::move(finest));
    while (levels_.back().a.rows() > kCoarsest) {
      context.check();
      Level& fine = levels_.back();
      std::size_t count = 0;
      const auto group = aggregate(fine, count);
      if (10 * count > 8 * group.size()) break;
      fine.p = prolongation(fine, group, count);
      fine.pt = transpose(fine.p, count);
      levels_.push_back(coarser(levels_.back(), count));
    }
    for (Level& level : levels_) {
      level.x.resize(level.a.rows());
      level.r.resize(level.a.rows());
    }
    const Level& last = levels_.back();
    small_ = last.a.rows() <= 4 * kCoarsest;
    if (!small_) return;
    Eigen::MatrixXd dense =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(last.a.rows()), static_cast<Eigen::Index>(last.a.rows()));
    for (std::size_t i = 0; i < last.a.rows(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      dense(row, row) = static_cast<double>(last.diagonal[i]);
      for (std::uint32_t k = last.a.first[i]; k < last.a.first[i + 1]; ++k)
        dense(row, static_cast<Eigen::Index>(last.a.columns[k])) = static_cast<double>(last.a.values[k]);
    }
    inverse_ = dense.partialPivLu().inverse().cast<float>();
  }

  /// One V-cycle from zero. `scale` keeps the numbers of single precision in range.
  void apply(const std::vector<Vec2>& b, std::vector<Vec2>& x) {
    double largest = 0;
    for (const Vec2& v : b) largest = std::max({largest, std::abs(v.x), std::abs(v.y)});
    const double scale = largest > 0 ? largest : 1;
    Level& top = levels_.front();
    for (std::size_t i = 0; i < b.size(); ++i)
      top.r[i] = {static_cast<float>(b[i].x / scale), static_cast<float>(b[i].y / scale)};
    cycle(0);
    x.resize(b.size());
    for (std::size_t i = 0; i < b.size(); ++i)
      x[i] = {scale * static_cast<double>(top.x[i].x), scale * static_cast<double>(top.x[i].y)};
  }

 private:
  static void relax(Level& level, std::size_t i) {
    float x = level.r[i].x, y = level.r[i].y;
    for (std::uint32_t k = level.a.first[i]; k < level.a.first[i + 1]; ++k) {
      const float w = level.a.values[k];
      const Vec2f v = level.x[level.a.columns[k]];
      x -= w * v.x;
      y -= w * v.y;
    }
    const float d = level.diagonal[i];
    level.x[i] = {x / d, y / d};
  }

  void cycle(std::size_t l) {
    Level& level = levels_[l];
    const std::size_t n = level.a.rows();
    if (l + 1 == levels_.size()) {
      solve_last(level);
      return;
    }
    std::fill(level.x.begin(), level.x.end(), Vec2f{});
    for (std::size_t i = 0; i < n; ++i) relax(level, i);
    Level& coarse = levels_[l + 1];
    std::fill(coarse.r.begin(), coarse.r.end(), Vec2f{});
    for (std::size_t i = 0; i < n; ++i) {  // the residual, sent down as it comes
      float x = level.r[i].x - level.diagonal[i] * level.x[i].x, y = level.r[i].y - level.diagonal[i] * level.x[i].y;
      for (std::uint32_t k = level.a.first[i]; k < level.a.first[i + 1]; ++k) {
        const float w = level.a.values[k];
        const Vec2f v = level.x[level.a.columns[k]];
        x -= w * v.x;
        y -= w * v.y;
      }
      for (std::uint32_t k = level.p.first[i]; k < level.p.first[i + 1]; ++k) {
        Vec2f& c = coarse.r[level.p.columns[k]];
        c.x += level.p.values[k] * x;
        c.y += level.p.values[k] * y;
      }
    }
    cycle(l + 1);
    for (std::size_t i = 0; i < n; ++i)
      for (std::uint32_t k = level.p.first[i]; k < level.p.first[i + 1]; ++k) {
        const Vec2f c = coarse.x[level.p.columns[k]];
        level.x[i].x += level.p.values[k] * c.x;
        level.x[i].y += level.p.values[k] * c.y;
      }
    for (std::size_t i = n; i-- > 0;) relax(level, i);
  }

  void solve_last(Level& level) {
    const std::size_t n = level.a.rows();
    if (!small_) {  // aggregation came to a stop early: a few sweeps
      std::fill(level.x.begin(), level.x.end(), Vec2f{});
      for (int sweep = 0; sweep < 8; ++sweep) {
        for (std::size_t i = 0; i < n; ++i) relax(level, i);
        for (std::size_t i = n; i-- > 0;) relax(level, i);
      }
      return;
    }
    using Block = Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>;
    const Eigen::Map<const Block> r(&level.r[0].x, static_cast<Eigen::Index>(n), 2);
    Eigen::Map<Block>(&level.x[0].x, static_cast<Eigen::Index>(n), 2).noalias() = inverse_ * r;
  }

  std::vector<Level> levels_;
  Eigen::MatrixXf inverse_;
  bool small_ = true;
};

void multiply(const ConvexSystem& s, const std::vector<Vec2>& x, std::vector<Vec2>& y) {
  for (std::size_t i = 0; i < s.size(); ++i) {
    Vec2 sum = x[i];
    for (std::uint32_t k = s.first[i]; k < s.first[i + 1]; ++k) sum = sum - s.values[k] * x[s.columns[k]];
    y[i] = sum;
  }
}

Vec2 products(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  Vec2 sum;
  for (std::size_t i = 0; i < a.size(); ++i) sum = {sum.x + a[i].x * b[i].x, sum.y + a[i].y * b[i].y};
  return sum;
}

double largest_entry(const std::vector<Vec2>& a) {
  double largest = 0;
  for (const Vec2& v : a) largest = std::max({largest, std::abs(v.x), std::abs(v.y)});
  return largest;
}

double quotient(double a, double b) {
  const double q = a / b;
  return std::isfinite(q) ? q : 0;
}

}  // namespace

int solve_iterative(const ConvexSystem& system, const std::vector<Vec2>& b, std::vector<Vec2>& x,
                    const Context& context) {
  constexpr int kMost = 120;
  const std::size_t n = system.size();
  Multigrid multigrid(system, context);
  x.assign(n, {});
  std::vector<Vec2> r = b, p(n), v(n), s_hat(n), p_hat(n), t(n);
  const std::vector<Vec2> shadow = b;
  const double goal = 1e-13 * largest_entry(b);
  Vec2 rho_old{1, 1}, alpha{1, 1}, omega{1, 1};
  for (int iteration = 1; iteration <= kMost; ++iteration) {
    context.check();
    const Vec2 rho = products(shadow, r);
    const Vec2 beta{quotient(rho.x, rho_old.x) * quotient(alpha.x, omega.x),
                    quotient(rho.y, rho_old.y) * quotient(alpha.y, omega.y)};
    for (std::size_t i = 0; i < n; ++i)
      p[i] = {r[i].x + beta.x * (p[i].x - omega.x * v[i].x), r[i].y + beta.y * (p[i].y - omega.y * v[i].y)};
    multigrid.apply(p, p_hat);
    multiply(system, p_hat, v);
    const Vec2 sv = products(shadow, v);
    alpha = {quotient(rho.x, sv.x), quotient(rho.y, sv.y)};
    for (std::size_t i = 0; i < n; ++i) r[i] = {r[i].x - alpha.x * v[i].x, r[i].y - alpha.y * v[i].y};
    multigrid.apply(r, s_hat);
    multiply(system, s_hat, t);
    const Vec2 ts = products(t, r), tt = products(t, t);
    omega = {quotient(ts.x, tt.x), quotient(ts.y, tt.y)};
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = {x[i].x + alpha.x * p_hat[i].x + omega.x * s_hat[i].x,
              x[i].y + alpha.y * p_hat[i].y + omega.y * s_hat[i].y};
      r[i] = {r[i].x - omega.x * t[i].x, r[i].y - omega.y * t[i].y};
      largest = std::max({largest, std::abs(r[i].x), std::abs(r[i].y)});
    }
    rho_old = rho;
    if (!(largest < 1e6)) break;  // it has run away
    if (largest > goal) continue;
    multiply(system, x, t);  // the true residual
    for (std::size_t i = 0; i < n; ++i) t[i] = b[i] - t[i];
    if (largest_entry(t) <= 30 * goal) return iteration;
  }
  solve_direct(system, b, x);
  return 0;
}

void solve_direct(const ConvexSystem& system, const std::vector<Vec2>& b, std::vector<Vec2>& x) {
  const auto n = static_cast<int>(system.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(system.values.size() + system.size());
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1.0);
    for (std::uint32_t k = system.first[static_cast<std::size_t>(i)]; k < system.first[static_cast<std::size_t>(i) + 1];
         ++k)
      entries.emplace_back(i, static_cast<int>(system.columns[k]), -system.values[k]);
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  matrix.makeCompressed();
  Eigen::SparseLU<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> lu;
  lu.compute(matrix);
  if (lu.info() != Eigen::Success)
    throw Error(Error::Kind::internal, "the system of the parameters could not be factored");
  Eigen::MatrixXd right(n, 2);
  for (int i = 0; i < n; ++i) {
    right(i, 0) = b[static_cast<std::size_t>(i)].x;
    right(i, 1) = b[static_cast<std::size_t>(i)].y;
  }
  Eigen::MatrixXd u = lu.solve(right);
  for (int step = 0; step < 2; ++step) {
    const Eigen::MatrixXd residual = right - matrix * u;
    u += lu.solve(residual);
  }
  x.resize(system.size());
  for (int i = 0; i < n; ++i) x[static_cast<std::size_t>(i)] = {u(i, 0), u(i, 1)};
}

}  // namespace retalho
