#include "retalho/terrain/crease_choice.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>

#include "retalho/core/parallel.h"
#include "retalho/terrain/crease_unknowns.h"
#include "retalho/terrain/creases.h"
#include "retalho/terrain/fit_moves.h"
#include "retalho/terrain/fit_tolerance.h"

namespace retalho {
namespace {

constexpr std::size_t kNumbersAVertex = 5;
constexpr int kMostAtVertex = 6;  // creases
constexpr int kRounds = 12;

/// The star of a vertex, its triangles counter-clockwise, each with what it asks of the vertex's height and of the
/// gradient that it has there, counted from where they are.
class FoldedStar {
 public:
  struct Part {
    Eigen::Matrix3d matrix;
    Eigen::Vector3d right;
    Eigen::Matrix2d before, after;  ///< what half of a slope along its first and its second edge makes of the gradient
  };
  std::vector<Part> parts;
  std::vector<std::uint32_t> edges;  ///< between a triangle and the next
  std::vector<char> folds;           ///< of each: is it a crease

  /// How much the objective falls when the vertex's own numbers are solved for, all else held.
  double saving(const std::vector<char>& fold) const {
    const std::size_t count = parts.size();
    const auto creases = static_cast<int>(std::count(fold.begin(), fold.end(), 1));
    const int sectors = std::max(1, creases), n = 1 + 2 * sectors;
    using Matrix =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 1 + 2 * kMostAtVertex, 1 + 2 * kMostAtVertex>;
    using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 1 + 2 * kMostAtVertex, 1>;
    using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 1 + 2 * kMostAtVertex>;
    Matrix a = Matrix::Zero(n, n);
    Vector b = Vector::Zero(n);
    int sector = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const bool first = sectors > 1 && fold[(k + count - 1) % count] != 0, second = sectors > 1 && fold[k] != 0;
      Rows rows = Rows::Zero(3, n);
      rows(0, 0) = 1;
      const auto add = [&](int of, const Eigen::Matrix2d& m) {
        rows.block<2, 2>(1, 1 + 2 * ((of + sectors) % sectors)) += m;
      };
      add(sector, Eigen::Matrix2d::Identity());
      if (first) {
        add(sector, -parts[k].before);
        add(sector - 1, parts[k].before);
      }
      if (second) {
        add(sector, -parts[k].after);
        add(sector + 1, parts[k].after);
      }
      a += rows.transpose() * parts[k].matrix * rows;
      b += rows.transpose() * parts[k].right;
      sector += second ? 1 : 0;
    }
    // What has an effect by rounding alone stays where it is.
    const double least = 1e-9 * (a.diagonal().tail(n - 1).maxCoeff() + 1e-300);
    for (int k = 0; k < n; ++k) a(k, k) += k == 0 ? 1e-9 * a(0, 0) + 1e-300 : least;
    const Vector x = a.ldlt().solve(b);
    const double value = b.dot(x);
    return std::isfinite(value) ? value : 0;
  }
};

struct Addition {
  std::uint32_t vertex = kNone;
  std::vector<std::uint32_t> edges;
  double gain = 0;
  std::size_t numbers = 0;
  double rate() const { return gain / static_cast<double>(numbers); }
};

class Choice {
 public:
  Choice(const FitState& state, const Context& context)
      : s_(state), context_(context), edges_(table_of(state, tin_)), crease_(edges_.vertices.size(), 0) {
    at_.assign(tin_.vertex_count(), 0);
    for (std::uint32_t v = 0; v < tin_.vertex_count(); ++v) border_.push_back(s_.mesh.on_border(v) ? 1 : 0);
    update();
    solve(kRoughSolve);
  }

  CreaseChoice run(std::size_t budget, double price) {
    std::size_t numbers = 0;
    for (int round = 0; round < kRounds; ++round) {
      context_.check();
      const std::size_t added = add_round(budget - numbers, price);
      if (added == 0) break;
      numbers += added;
      update();
      solve(kRoughSolve);
    }
    CreaseChoice result;
    for (std::size_t e = 0; e < crease_.size(); ++e)
      if (crease_[e] != 0) result.edges.push_back(edges_.vertices[e]);
    result.numbers = numbers;
    result.cost = cost();
    return result;
  }

 private:
  static EdgeTable table_of(const FitState& s, Tin& tin) {
    tin.triangles = s.mesh.triangles();
    tin.neighbors = s.mesh.neighbors();
    for (std::uint32_t v = 0; v < s.mesh.vertex_count(); ++v) tin.points.push_back(s.grid.place(s.mesh.at(v)));
    return build_edges(tin);
  }

  /// Sectors of the creases as they are; a new sector starts with the gradient that its lowest corner had.
  void update() {
    std::vector<std::uint32_t> creases;
    for (std::uint32_t e = 0; e < crease_.size(); ++e)
      if (crease_[e] != 0) creases.push_back(e);
    std::size_t nodes = 0;
    const auto sectors = crease_sectors(tin_, edges_, creases, &nodes);
    std::vector<Vec3> data(nodes);
    std::vector<char> set(nodes, 0);
    for (std::size_t t = 0; t < sectors.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t n = sectors[t][k];
        if (set[n] != 0) continue;
        set[n] = 1;
        data[n] = sectors_.empty() ? s_.data[tin_.triangles[t][k]] : data_[sectors_[t][k]];
        data[n].x = sectors_.empty() ? data[n].x : data_[tin_.triangles[t][k]].x;
      }
    sectors_ = sectors;
    data_ = std::move(data);
    unknowns_.emplace(tin_.triangles, tin_.neighbors, sectors_, tin_.points);
  }

  void solve(const CgLimits& limits) {
    FitSolveOptions options;
    options.limits = limits;
    solve_creased(*unknowns_, s_.elements, data_, options, context_);
  }

  double cost() const {
    double sum = 0;
    for (std::uint32_t t = 0; t < tin_.triangle_count(); ++t)
      sum += element_cost(s_.kind, s_.elements[t], unknowns_->at(t, data_));
    return sum;
  }

  FoldedStar star_of(std::uint32_t vertex) const {
    CellMesh::Star star;
    s_.mesh.star(vertex, star);
    FoldedStar result;
    for (const std::uint32_t t : star.triangles) {
      const auto& v = tin_.triangles[t];
      const std::size_t k = v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2, i = (k + 1) % 3, j = (k + 2) % 3;
      const Vec2 to_i = tin_.points[v[i]] - tin_.points[vertex], to_j = tin_.points[v[j]] - tin_.points[vertex];
      const double area2 = cross(to_i, to_j);
      FoldedStar::Part part;
      part.before = Eigen::Vector2d(to_j.y, -to_j.x) * Eigen::RowVector2d(to_i.x, to_i.y) / (2 * area2);
      part.after = Eigen::Vector2d(-to_i.y, to_i.x) * Eigen::RowVector2d(to_j.x, to_j.y) / (2 * area2);
      const CornerData now = unknowns_->at(t, data_);
      std::array<double, 9> u{};
      for (std::size_t c = 0; c < 3; ++c) {
        u[3 * c] = now[c].x;
        u[3 * c + 1] = now[c].y;
        u[3 * c + 2] = now[c].z;
      }
      const FitElement& e = s_.elements[t];
      const auto entry = [&](std::size_t a, std::size_t b) {
        return e.a[packed_index(std::min(a, b), std::max(a, b))];
      };
      for (std::size_t a = 0; a < 3; ++a) {
        double right = e.b[3 * k + a];
        for (std::size_t b = 0; b < 9; ++b) right -= entry(3 * k + a, b) * u[b];
        part.right(static_cast<Eigen::Index>(a)) = right;
        for (std::size_t b = 0; b < 3; ++b)
          part.matrix(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = entry(3 * k + a, 3 * k + b);
      }
      result.parts.push_back(part);
      result.edges.push_back(edges_.of_triangle[t][i]);  // opposite corner i: from j to the vertex
      result.folds.push_back(crease_[result.edges.back()]);
    }
    return result;
  }

  /// Numbers that another crease at an edge's far end costs there.
  std::size_t numbers_beyond(std::uint32_t edge, std::uint32_t vertex) const {
    const auto [a, b] = edges_.vertices[edge];
    const std::uint32_t far = a == vertex ? b : a;
    return border_[far] != 0 || at_[far] > 0 ? 2 : 0;
  }

  Addition best_addition(std::uint32_t vertex) const {
    Addition best;
    if (border_[vertex] != 0 || at_[vertex] >= kMostAtVertex) return best;
    const FoldedStar star = star_of(vertex);
    const double now = star.saving(star.folds);
    const auto consider = [&](std::initializer_list<std::size_t> added) {
      std::vector<char> fold = star.folds;
      Addition a;
      a.vertex = vertex;
      a.numbers = 2;  // one sector more
      for (const std::size_t k : added) {
        if (fold[k] != 0) return;
        fold[k] = 1;
        a.edges.push_back(star.edges[k]);
        a.numbers += 1 + numbers_beyond(star.edges[k], vertex);  // which edge it is, and sectors there
      }
      a.gain = star.saving(fold) - now;
      if (best.vertex == kNone || a.rate() > best.rate()) best = a;
    };
    const std::size_t count = star.parts.size();
    for (std::size_t k = 0; k < count; ++k) {
      if (at_[vertex] > 0) {
        consider({k});
        continue;
      }
      for (std::size_t other = 0; other < k; ++other) consider({other, k});
    }
    return best;
  }

  std::size_t add_round(std::size_t budget, double price) {
    const std::size_t n = tin_.vertex_count();
    std::vector<Addition> additions(n);
    parallel_chunks(n, 64, context_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) additions[v] = best_addition(static_cast<std::uint32_t>(v));
    });
    std::erase_if(additions, [&](const Addition& a) { return a.vertex == kNone || !(a.rate() >= price); });
    std::stable_sort(additions.begin(), additions.end(),
                     [](const Addition& a, const Addition& b) { return a.rate() > b.rate(); });
    std::vector<char> blocked(n, 0);
    std::size_t numbers = 0;
    CellMesh::Star star;
    for (const Addition& a : additions) {
      if (numbers + a.numbers > budget || blocked[a.vertex] != 0) continue;
      s_.mesh.star(a.vertex, star);
      if (std::any_of(star.ring.begin(), star.ring.end(), [&](std::uint32_t v) { return blocked[v] != 0; })) continue;
      blocked[a.vertex] = 1;
      for (const std::uint32_t v : star.ring) blocked[v] = 1;
      for (const std::uint32_t e : a.edges) {
        crease_[e] = 1;
        for (const std::uint32_t v : edges_.vertices[e]) ++at_[v];
      }
      numbers += a.numbers;
    }
    return numbers;
  }

  const FitState& s_;
  const Context& context_;
  Tin tin_;
  EdgeTable edges_;
  std::vector<char> crease_, border_;
  std::vector<int> at_;  // creases at each vertex
  std::vector<std::array<std::uint32_t, 3>> sectors_;
  std::vector<Vec3> data_;  // of each node
  std::optional<CreasedUnknowns> unknowns_;
};

}  // namespace

CreaseChoice choose_creases(const FitState& state, std::size_t numbers, double price, const Context& context) {
  return Choice(state, context).run(numbers, price);
}

CreaseChoice trade_for_creases(FitState& state, const Context& context) {
  // RMSE falls by about the power 3/4 of the numbers, the objective by 3/2: what the last number was worth.
  constexpr double kPower = 1.5;
  const std::size_t vertices = state.mesh.vertex_count(), numbers = kNumbersAVertex * vertices;
  const double before = state.cost(context), price = kPower * before / static_cast<double>(numbers);
  const CreaseChoice wanted = choose_creases(state, numbers, price, context);
  if (wanted.numbers == 0) return {};
  const FitSnapshot as_it_was(state);
  remove_cheapest(state, (wanted.numbers + kNumbersAVertex - 1) / kNumbersAVertex, context);
  state.refresh(context);
  state.solve(kRoughSolve, context);
  CreaseChoice chosen = choose_creases(state, numbers - kNumbersAVertex * state.mesh.vertex_count(), price, context);
  if (chosen.numbers > 0 && chosen.cost < before) return chosen;
  as_it_was.restore(state, context);
  return {};
}

}  // namespace retalho
