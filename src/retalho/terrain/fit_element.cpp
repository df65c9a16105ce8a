#include "retalho/terrain/fit_element.h"

namespace retalho {
namespace {

template <std::size_t N>
struct Normal {
  std::array<double, N*(N + 1) / 2> a{};
  std::array<double, N> b{};
  double c = 0;

  void add(const std::array<double, N>& row, double value, double weight) {
    std::size_t at = 0;
    for (std::size_t j = 0; j < N; ++j) {
      const double w = weight * row[j];
      for (std::size_t i = 0; i <= j; ++i) a[at++] += w * row[i];
      b[j] += w * value;
    }
    c += weight * value * value;
  }
};

/// The bending of a piece, exactly: the second derivatives are constant (degree 2) or linear (degree 3).
template <class Element, std::size_t N>
void add_fairness(const FitBasis<Element>& basis, double weight, Normal<N>& normal) {
  constexpr int kDegree = FitBasis<Element>::kDegree;
  if constexpr (kDegree >= 2) {
    using Row = typename FitBasis<Element>::Row;
    for (std::size_t p = 0; p < FitBasis<Element>::kPieces; ++p) {
      const typename Element::Map map(basis.shape, static_cast<int>(p));
      const Barycentric dx = map(basis.macro.along_x(1)), dy = map(basis.macro.along_y());
      const auto xx = FitBasis<Element>::template derivative<kDegree - 1>(basis.slope[p][0], dx);
      const auto xy = FitBasis<Element>::template derivative<kDegree - 1>(basis.slope[p][0], dy);
      const auto yy = FitBasis<Element>::template derivative<kDegree - 1>(basis.slope[p][1], dy);
      const double share = weight * basis.area * piece_share(basis.shape, static_cast<int>(p));
      const auto add = [&](const auto& net, double factor) {
        if constexpr (kDegree == 2) {
          normal.add(net[0], 0, factor * share);
        } else {  // the integral of the square of a linear function: (sum of squares + square of the sum) / 12
          Row sum;
          for (std::size_t u = 0; u < sum.size(); ++u) sum[u] = net[0][u] + net[1][u] + net[2][u];
          for (const Row& row : net) normal.add(row, 0, factor * share / 12);
          normal.add(sum, 0, factor * share / 12);
        }
      };
      add(xx, 1);
      add(xy, 2);
      add(yy, 1);
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
      normal.add(Basis::blend(basis.value[p], bernstein<kDegree>(at)), z,
                 weights.cells.empty() ? 1.0 : weights.cells[cell]);
      if (!(weights.slope > 0)) continue;
      const std::optional<Vec2> slope = grid.slope(c, row);
      if (!slope) continue;
      const auto lower = bernstein<kDegree - 1>(at);
      normal.add(Basis::blend(basis.slope[p][0], lower), slope->x, weights.slope);
      normal.add(Basis::blend(basis.slope[p][1], lower), slope->y, weights.slope);
    }
  });
  if (weights.fairness > 0) add_fairness(basis, weights.fairness, normal);
  FitElement element;
  std::copy(normal.a.begin(), normal.a.end(), element.a.begin());
  std::copy(normal.b.begin(), normal.b.end(), element.b.begin());
  element.c = normal.c;
  return element;
}

}  // namespace

FitElement fit_element(SurfaceKind kind, const FitTriangle& triangle, const FitGrid& grid, const FitWeights& weights) {
  switch (kind) {
    case SurfaceKind::powell_sabin:
      return assemble<PowellSabinElement>(triangle, grid, weights);
    case SurfaceKind::clough_tocher:
      return assemble<CloughTocherElement>(triangle, grid, weights);
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
