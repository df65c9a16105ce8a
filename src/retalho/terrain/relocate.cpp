// Relocation of vertices (fit_moves.h).
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "retalho/core/parallel.h"
#include "retalho/terrain/fit_moves.h"
#include "retalho/terrain/fit_tolerance.h"

namespace retalho {
namespace {

using greedy::Cell;

constexpr double kLeastArea = 0.5;       // cells
constexpr double kLeastFullness = 0.05;  // area over the square of the longest side

/// What a star costs when its vertex's data are the best for it.
struct Trial {
  double cost = INFINITY;
  Vec3 data;
  std::vector<FitElement> elements;
};

/// `limit`: a trial that is sure to cost more is given up early: part of the star, with the best data for that part
/// alone, costs no more than all of it. `as_is`: where and as the vertex is, the elements are known.
Trial try_star(const FitState& s, std::uint32_t vertex, const std::vector<std::uint32_t>& triangles, Vec2 at,
               bool folded, bool as_is, double limit) {
  const bool flat = s.kind == SurfaceKind::linear;
  const std::size_t per = flat ? 1 : 3;
  Trial trial;
  trial.cost = folded ? 0 : s.gradient_price;
  Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * (flat || folded ? 1.0 : 0.0);
  a(0, 0) = 0;
  Eigen::Vector3d b = Eigen::Vector3d::Zero(), u = b;
  bool sound = false;
  for (const std::uint32_t t : triangles) {
    const auto& v = s.mesh.triangles()[t];
    const std::size_t me = v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
    if (as_is) {
      trial.elements.push_back(s.elements[t]);
    } else {
      FitTriangle triangle = s.triangle(t, vertex, at);
      const auto bit = static_cast<std::uint8_t>(1U << me);
      triangle.folded = static_cast<std::uint8_t>(folded ? triangle.folded | bit : triangle.folded & ~bit);
      trial.elements.push_back(fit_element(s.kind, triangle, s.grid, s.weights));
    }
    const FitElement& e = trial.elements.back();
    CornerData rest = s.corner_data(t);
    rest[me] = {};
    trial.cost += element_cost(s.kind, e, rest);
    for (std::size_t i = 0; i < per; ++i) {
      const std::size_t row = me * per + i;
      double right = e.b[row];
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 3> other{rest[k].x, rest[k].y, rest[k].z};
        for (std::size_t j = 0; j < per; ++j) {
          const std::size_t column = k * per + j;
          const double entry = e.a[packed_index(std::min(row, column), std::max(row, column))];
          if (k == me)
            a(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) += entry;
          else
            right -= entry * other[j];
        }
      }
      b(static_cast<Eigen::Index>(i)) += right;
    }
    const Eigen::LDLT<Eigen::Matrix3d> factors(a);
    u = factors.solve(b);
    sound = factors.info() == Eigen::Success && u.allFinite() && factors.isPositive();
    if (sound && trial.cost - b.dot(u) > limit) return {};
  }
  if (!sound) return {};
  trial.cost -= b.dot(u);
  trial.data = {u(0), u(1), u(2)};
  return trial;
}

struct Move {
  bool wanted = false, fold = false;
  Cell to = 0;
  Vec3 data;
  std::vector<FitElement> elements;
};

class Sweep {
 public:
  Sweep(FitState& state, double reach) : state_(state), reach_(reach) {}

  /// The vertices that have moved.
  std::vector<std::uint32_t> run(const Context& context) {
    std::vector<std::uint32_t> moved;
    for (const auto& color : colors(context)) {
      std::vector<Move> moves(color.size());
      parallel_chunks(color.size(), 4, context, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) moves[k] = best_move(color[k]);
      });
      for (std::size_t k = 0; k < color.size(); ++k) {
        if (!moves[k].wanted) continue;
        moved.push_back(color[k]);
        state_.mesh.displace(color[k], moves[k].to);
        state_.data[color[k]] = moves[k].data;
        if (!state_.folded.empty()) state_.folded[color[k]] = moves[k].fold ? 1 : 0;
        CellMesh::Star star;
        state_.mesh.star(color[k], star);
        for (std::size_t i = 0; i < star.triangles.size(); ++i)
          state_.elements[star.triangles[i]] = moves[k].elements[i];
      }
    }
    return moved;
  }

 private:
  /// Vertices that are no neighbours of each other, so that their stars share no triangle.
  std::vector<std::vector<std::uint32_t>> colors(const Context& context) const {
    const std::size_t n = state_.mesh.vertex_count();
    const FitPattern pattern(state_.mesh.triangles(), n, context);
    std::vector<std::uint32_t> color(n, kNone);
    std::vector<std::vector<std::uint32_t>> result;
    std::vector<std::uint8_t> taken;
    for (std::uint32_t v = 0; v < n; ++v) {
      taken.assign(result.size() + 1, 0);
      for (std::uint32_t k = pattern.begin[v]; k < pattern.begin[v + 1]; ++k)
        if (const std::uint32_t c = color[pattern.vertex[k]]; c != kNone) taken[c] = 1;
      const auto c = static_cast<std::size_t>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
      if (c == result.size()) result.emplace_back();
      color[v] = static_cast<std::uint32_t>(c);
      result[c].push_back(v);
    }
    return result;
  }

  Move best_move(std::uint32_t v) const {
    const CellMesh& mesh = state_.mesh;
    Move move;
    if (state_.pinned[v] != 0 || state_.on_frozen(mesh.cell(v))) return move;
    CellMesh::Star star;
    mesh.star(v, star);
    double area = 0;
    for (const std::uint32_t t : star.triangles) area += area_of(state_.triangle(t));
    const bool folded = state_.is_folded(v), either = !state_.folded.empty();
    const Trial now = try_star(state_, v, star.triangles, mesh.at(v), folded, true, INFINITY);
    double best = now.cost * (1 - 1e-6);
    if (!(best > 0)) return move;
    const Cell here = mesh.cell(v);
    const auto attempt = [&](Cell to, Vec2 at, bool fold) {
      Trial trial = try_star(state_, v, star.triangles, at, fold, false, best);
      if (!(trial.cost < best)) return;
      best = trial.cost;
      move = {true, fold, to, trial.data, std::move(trial.elements)};
    };
    if (either) attempt(here, mesh.at(v), !folded);
    if (!(reach_ > 0)) return move;
    const double step = reach_ * std::sqrt(area / 3);
    std::vector<Cell> tried{here};
    for (int direction = 0; direction < 8; ++direction) {
      const double angle = direction * (std::numbers::pi / 4);
      const auto column = greedy::column_of(here) + std::lround(step / state_.grid.step.x * std::cos(angle)),
                 row = greedy::row_of(here) + std::lround(step / state_.grid.step.y * std::sin(angle));
      if (column < 0 || row < 0 || column >= state_.grid.columns || row >= state_.grid.rows) continue;
      const Cell to = greedy::cell_at(static_cast<int>(column), static_cast<int>(row));
      if (std::find(tried.begin(), tried.end(), to) != tried.end()) continue;
      tried.push_back(to);
      if (std::isnan(state_.height(to)) || state_.on_frozen(to) || !mesh.can_move(v, to)) continue;
      const Vec2 at{static_cast<double>(column), -static_cast<double>(row)};
      if (!sound(v, star.triangles, at)) continue;
      attempt(to, at, folded);
      if (either) attempt(to, at, !folded);
    }
    return move;
  }

  static double area_of(const FitTriangle& t) {
    return cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]) / 2;
  }

  bool sound(std::uint32_t v, const std::vector<std::uint32_t>& triangles, Vec2 at) const {
    return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
      const FitTriangle triangle = state_.triangle(t, v, at);
      const auto& c = triangle.corner;
      const double area = area_of(triangle);
      const double longest = std::max({norm2(c[1] - c[0]), norm2(c[2] - c[1]), norm2(c[0] - c[2])});
      return area >= kLeastArea && area >= kLeastFullness * longest;
    });
  }

  FitState& state_;
  double reach_;
};

}  // namespace

namespace {

/// What the triangles around each vertex cost.
std::vector<double> star_costs(const FitState& state, const Context& context) {
  const std::vector<double> costs = state.costs(context);
  std::vector<double> result(state.mesh.vertex_count(), 0.0);
  for (std::uint32_t v = 0; v < result.size(); ++v) result[v] = state.is_folded(v) ? 0 : state.gradient_price;
  for (std::size_t t = 0; t < costs.size(); ++t)
    for (const std::uint32_t v : state.mesh.triangles()[t]) result[v] += costs[t];
  return result;
}

}  // namespace

void refold(FitState& state, const Context& context) {
  if (state.folded.empty()) return;
  relocate(state, 0, kRoughSolve, context);
}

bool relocate(FitState& state, double reach, const CgLimits& limits, const Context& context) {
  constexpr double kWorse = 1.02;
  const FitSnapshot before(state);
  const double cost_before = state.cost(context);
  const std::vector<double> stars_before = star_costs(state, context);
  std::vector<std::uint32_t> moved = Sweep(state, reach).run(context);
  // Flips and the neighbours' moves may have spoilt what each move promised: such vertices go back.
  for (int attempt = 0; !moved.empty() && attempt < 3; ++attempt) {
    state.mesh.restore();
    state.refresh(context);
    state.solve(limits, context);
    const std::vector<double> stars = star_costs(state, context);
    std::vector<std::uint32_t> back;
    for (const std::uint32_t v : moved)
      if (stars[v] > kWorse * stars_before[v] && state.mesh.can_move(v, before.mesh.cell(v))) back.push_back(v);
    if (back.empty()) break;
    for (const std::uint32_t v : back) {
      if (!state.mesh.can_move(v, before.mesh.cell(v))) continue;
      state.mesh.displace(v, before.mesh.cell(v));
      state.data[v] = before.data[v];
      if (!state.folded.empty()) state.folded[v] = before.folded[v];
    }
    std::erase_if(moved, [&](std::uint32_t v) {
      return state.mesh.cell(v) == before.mesh.cell(v) && (state.folded.empty() || state.folded[v] == before.folded[v]);
    });
  }
  state.mesh.restore();
  state.refresh(context);
  state.solve(limits, context);
  if (state.cost(context) < cost_before) return true;
  before.restore(state, context);
  return false;
}

}  // namespace retalho
