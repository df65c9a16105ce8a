#include "retalho/terrain/fit_moves.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

using greedy::Cell;

struct Candidate {
  std::uint32_t triangle = kNone;
  Cell cell = 0;
  double score = 0;
  Vec3 at;
};

/// A vertex close to a long edge of the outline would leave a sliver there: then the nearest cell of that edge is
/// meant instead (as Ruppert 1995 does with encroached segments). Of a slanting edge none is: cells are not on it.
Cell keep_off_outline(const FitState& s, std::uint32_t t, Cell p) {
  constexpr double kWidest = -0.7;  // cosine of the widest angle under which `p` may see an edge of the outline
  const auto place = [&](Cell c) {
    return s.grid.place({static_cast<double>(greedy::column_of(c)), -static_cast<double>(greedy::row_of(c))});
  };
  const auto encroached = [&](std::uint32_t triangle) -> std::optional<Cell> {
    for (std::size_t k = 0; k < 3; ++k) {
      if (s.mesh.neighbors()[triangle][k] != kNone) continue;
      const auto& v = s.mesh.triangles()[triangle];
      const Cell a = s.mesh.cell(v[(k + 1) % 3]), b = s.mesh.cell(v[(k + 2) % 3]);
      const Vec2 pa = place(a) - place(p), pb = place(b) - place(p);
      if (s.on_frozen(a) && s.on_frozen(b)) continue;  // its cells are not to be had
      if (cross(pa, pb) == 0 || !(dot(pa, pb) < kWidest * norm(pa) * norm(pb))) continue;
      const bool level = greedy::row_of(a) == greedy::row_of(b);
      if (!level && greedy::column_of(a) != greedy::column_of(b)) continue;
      return level ? greedy::cell_at(greedy::column_of(p), greedy::row_of(a))
                   : greedy::cell_at(greedy::column_of(a), greedy::row_of(p));
    }
    return std::nullopt;
  };
  if (const auto on_edge = encroached(t)) return *on_edge;
  for (const std::uint32_t n : s.mesh.neighbors()[t])
    if (n != kNone)
      if (const auto on_edge = encroached(n)) return *on_edge;
  return p;
}

/// Where triangle `t` wants a vertex; kNone as its triangle where it wants none.
Candidate candidate(const FitState& s, std::uint32_t t) {
  double sum = 0, x = 0, y = 0, largest = 0;
  std::size_t worst = 0;
  const auto is_corner = [&](Cell cell) {
    const auto& v = s.mesh.triangles()[t];
    return std::any_of(v.begin(), v.end(), [&](std::uint32_t k) { return s.mesh.cell(k) == cell; });
  };
  const auto across = static_cast<std::size_t>(s.grid.columns);
  const auto cell_of = [&](std::size_t k) {
    return greedy::cell_at(static_cast<int>(k % across), static_cast<int>(k / across));
  };
  each_error(s.kind, s.triangle(t), s.corner_data(t), s.grid, s.weights.inside, [&](std::size_t k, double error) {
    const double weight = (s.cell_weights.empty() ? 1.0 : s.cell_weights[k]) * error * error;
    sum += weight;
    const Cell cell = cell_of(k);
    x += weight * greedy::column_of(cell);
    y += weight * greedy::row_of(cell);
    if (std::abs(error) > largest && !is_corner(cell) && !s.on_frozen(cell)) {
      largest = std::abs(error);
      worst = k;
    }
  });
  Candidate c;
  if (!(sum > 0) || !(largest > 0)) return c;
  c.triangle = t;
  c.cell = greedy::cell_at(static_cast<int>(std::lround(x / sum)), static_cast<int>(std::lround(y / sum)));
  if (is_corner(c.cell) || s.on_frozen(c.cell) || std::isnan(s.height(c.cell))) c.cell = cell_of(worst);
  c.score = sum * largest;
  c.cell = keep_off_outline(s, t, c.cell);
  if (s.on_frozen(c.cell)) return {};
  c.at = s.surface_at(t, c.cell);
  return c;
}

}  // namespace

std::size_t insert_in(FitState& state, std::span<const std::uint32_t> order, std::size_t count,
                      const Context& context) {
  const std::size_t look = order.size();
  std::vector<Candidate> candidates(look);
  parallel_chunks(look, 32, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) candidates[k] = candidate(state, order[k]);
  });
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::size_t done = 0;
  for (const Candidate& c : candidates) {
    if (done == count) break;
    if (c.triangle == kNone || state.mesh.is_changed(c.triangle)) continue;
    if (state.insert(c.cell, c.triangle, c.at)) ++done;
  }
  return done;
}

std::size_t insert_at_centroids(FitState& state, std::size_t count, const Context& context) {
  const std::vector<double> costs = state.costs(context);
  std::vector<std::uint32_t> order(costs.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return costs[a] != costs[b] ? costs[a] > costs[b] : a < b; });
  for (std::size_t look = 2 * count + 32;; look *= 4) {
    const std::size_t here = std::min(order.size(), look);
    const std::size_t done = insert_in(state, std::span(order).first(here), count, context);
    if (done > 0 || here == order.size()) return done;
  }
}

void remove_cheapest(FitState& state, std::size_t count, const Context& context) {
  const std::vector<double> costs = state.costs(context);
  const std::size_t n = state.mesh.vertex_count();
  std::vector<double> star_cost(n, 0.0);
  for (std::uint32_t t = 0; t < costs.size(); ++t)
    for (const std::uint32_t v : state.mesh.triangles()[t]) star_cost[v] += costs[t];
  std::vector<std::uint32_t> order(n), chosen;
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return star_cost[a] < star_cost[b]; });
  std::vector<std::uint8_t> blocked(n, 0);
  CellMesh::Star star;
  for (const std::uint32_t v : order) {
    if (chosen.size() == count) break;
    if (blocked[v] != 0) continue;
    state.mesh.star(v, star);
    if (!star.closed) continue;
    chosen.push_back(v);
    for (const std::uint32_t w : star.ring) blocked[w] = 1;
  }
  // From the highest number down: what takes a removed one's place is never itself to be removed.
  std::sort(chosen.rbegin(), chosen.rend());
  for (const std::uint32_t v : chosen) state.remove(v);
}

void exchange(FitState& state, double share, const CgLimits& limits, const Context& context) {
  const std::size_t n = state.mesh.vertex_count();
  remove_cheapest(state, static_cast<std::size_t>(share * static_cast<double>(n)), context);
  state.refresh(context);
  state.solve(limits, context);
  while (state.mesh.vertex_count() < n && insert_at_centroids(state, n - state.mesh.vertex_count(), context) > 0) {
    state.refresh(context);
    state.solve(limits, context);
  }
}

}  // namespace retalho
