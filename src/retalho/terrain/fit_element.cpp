#include "retalho/terrain/fit_element.h"

#include "retalho/terrain/folds.h"

namespace retalho {
namespace {

/// A weighted row of the problem: weight (row . u - value)^2.
template <std::size_t N>
struct WeightedRow {
  std::array<double, N> row;
  double value = 0, weight = 0;
};

/// The upper triangle by columns, each column as long as fills pairs of numbers, so that the loops below become vector
/// instructions.
template <std::size_t N>
struct Normal {
  static constexpr std::size_t kPadded = N + N % 2;
  std::array<std::array<double, kPadded>, N> a{};
  std::array<double, kPadded> b{};
  double c = 0;

  /// `Count` rows in one pass over the sums.
  template <std::size_t Count>
  [[gnu::always_inline]] inline void add(const std::array<WeightedRow<N>, Count>& rows) {
    std::array<std::array<double, kPadded>, Count> r;
    for (std::size_t k = 0; k < Count; ++k) {
      r[k].back() = 0;
      std::copy(rows[k].row.begin(), rows[k].row.end(), r[k].begin());
      c += rows[k].weight * rows[k].value * rows[k].value;
    }
    add_column<0, Count>(r, rows);
    for (std::size_t i = 0; i < kPadded; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < Count; ++k) sum += rows[k].weight * rows[k].value * r[k][i];
      b[i] += sum;
    }
  }

 private:
  template <std::size_t Column, std::size_t Count>
  [[gnu::always_inline]] inline void add_column(const std::array<std::array<double, kPadded>, Count>& r,
                                                const std::array<WeightedRow<N>, Count>& rows) {
    if constexpr (Column < N) {
      constexpr std::size_t kLength = (Column + 2) / 2 * 2;
      std::array<double, Count> w;
      for (std::size_t k = 0; k < Count; ++k) w[k] = rows[k].weight * r[k][Column];
      for (std::size_t i = 0; i < kLength; ++i) {
        double sum = a[Column][i];
        for (std::size_t k = 0; k < Count; ++k) sum += w[k] * r[k][i];
        a[Column][i] = sum;
      }
      add_column<Column + 1, Count>(r, rows);
    }
  }
};

/// What of its bending counts for a triangle that is thinner than a cell, as those under the outline of data that are
/// not convex: a step of one cell bends it as the inverse square of its smallest height, and squared that would
/// outweigh the cells themselves. All of it for the others.
double bending_share(const FitTriangle& t, double area) {
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) longest = std::max(longest, norm(t.corner[(k + 1) % 3] - t.corner[k]));
  const double height = std::min(1.0, 2 * area / longest), squared = height * height;
  return squared * squared;
}

/// The bending of a piece, exactly: the second derivatives are constant (degree 2) or linear (degree 3).
template <class Element, std::size_t N>
void add_fairness(const FitBasis<Element>& basis, double weight, Normal<N>& normal) {
  constexpr int kDegree = FitBasis<Element>::kDegree;
  if constexpr (kDegree >= 2) {
    for (std::size_t p = 0; p < FitBasis<Element>::kPieces; ++p) {
      const typename Element::Map map(basis.shape, static_cast<int>(p));
      const Barycentric dx = map(basis.macro.along_x(1)), dy = map(basis.macro.along_y());
      const auto xx = FitBasis<Element>::template derivative<kDegree - 1>(basis.slope[p][0], dx);
      const auto xy = FitBasis<Element>::template derivative<kDegree - 1>(basis.slope[p][0], dy);
      const auto yy = FitBasis<Element>::template derivative<kDegree - 1>(basis.slope[p][1], dy);
      const double share = weight * basis.area * piece_share(basis.shape, static_cast<int>(p));
      if constexpr (kDegree == 2) {
        normal.template add<3>({{{xx[0], 0, share}, {xy[0], 0, 2 * share}, {yy[0], 0, share}}});
      } else {
        // The mean of the square of a linear function with corner values f_i: sum (f_i + sum f / 3)^2 / 12.
        const auto add = [&](const auto& net, double factor) {
          std::array<WeightedRow<N>, 3> rows;
          for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t u = 0; u < N; ++u) rows[k].row[u] = net[k][u] + (net[0][u] + net[1][u] + net[2][u]) / 3;
            rows[k].weight = factor * share / 12;
          }
          normal.template add<3>(rows);
        };
        add(xx, 1);
        add(xy, 2);
        add(yy, 1);
      }
    }
  }
}

template <class Element>
FitElement assemble(const FitTriangle& triangle, const FitGrid& grid, const FitWeights& weights) {
  using Basis = FitBasis<Element>;
  constexpr int kDegree = Basis::kDegree;
  const Basis basis(triangle);
  Normal<Basis::kUnknowns> normal;
  const RowGrid lattice = grid.lattice(), placed = grid.placed_lattice();
  const Barycentric along = basis.macro.along_x(grid.step.x);
  std::array<typename Element::Map, Basis::kPieces> maps;
  for (std::size_t p = 0; p < Basis::kPieces; ++p) maps[p] = typename Element::Map(basis.shape, static_cast<int>(p));
  CellSpans(triangle.at, weights.inside).each(lattice, [&](int row, int first, int last) {
    const Barycentric start = basis.macro.barycentric(placed.at(first, row));
    for (int c = first; c <= last; ++c) {
      const std::size_t cell = grid.cell(c, row);
      const double z = grid.z[cell];
      if (std::isnan(z)) continue;
      const int n = c - first;
      const Barycentric u{start.r + n * along.r, start.s + n * along.s, start.t + n * along.t};
      const auto p = static_cast<std::size_t>(basis.shape.piece(u));
      const Barycentric at = maps[p](u);
      const double weight = weights.cells.empty() ? 1.0 : weights.cells[cell];
      const typename Basis::Row value = Basis::blend(basis.value[p], bernstein<kDegree>(at));
      const std::optional<Vec2> slope = weights.slope > 0 ? grid.slope(c, row) : std::nullopt;
      if (!slope) {
        normal.template add<1>({{{value, z, weight}}});
        continue;
      }
      const auto lower = bernstein<kDegree - 1>(at);
      normal.template add<3>({{{value, z, weight},
                               {Basis::blend(basis.slope[p][0], lower), slope->x, weights.slope},
                               {Basis::blend(basis.slope[p][1], lower), slope->y, weights.slope}}});
    }
  });
  if (weights.fairness > 0) add_fairness(basis, weights.fairness * bending_share(triangle, basis.area), normal);
  FitElement element;
  for (std::size_t j = 0; j < Basis::kUnknowns; ++j) {
    for (std::size_t i = 0; i <= j; ++i) element.a[packed_index(i, j)] = normal.a[j][i];
    element.b[j] = normal.b[j];
  }
  element.c = normal.c;
  return element;
}

}  // namespace

FitElement fit_element(SurfaceKind kind, const FitTriangle& triangle, const FitGrid& grid, const FitWeights& weights) {
  switch (kind) {
    case SurfaceKind::powell_sabin:
      return assemble<PowellSabinElement>(triangle, grid, weights);
    case SurfaceKind::clough_tocher: {
      FitElement element = assemble<CloughTocherElement>(triangle, grid, weights);
      fold_element(triangle.corner, triangle.folded, element);
      return element;
    }
    default:
      return assemble<LinearElement>(triangle, grid, weights);
  }
}

double element_cost(SurfaceKind kind, const FitElement& element, const CornerData& data) {
  std::array<double, kMostUnknowns> u{};
  std::size_t count = 0;
  for (const Vec3& d : data) {
    u[count++] = d.x;
    if (kind == SurfaceKind::linear) continue;
    u[count++] = d.y;
    u[count++] = d.z;
  }
  double cost = element.c;
  for (std::size_t j = 0; j < count; ++j) {
    double sum = element.a[packed_index(j, j)] * u[j] - 2 * element.b[j];
    for (std::size_t i = 0; i < j; ++i) sum += 2 * element.a[packed_index(i, j)] * u[i];
    cost += sum * u[j];
  }
  return cost;
}

}  // namespace retalho
