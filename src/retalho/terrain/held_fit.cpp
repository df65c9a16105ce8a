#include "retalho/terrain/held_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/parallel.h"
#include "retalho/terrain/fit_state.h"
#include "retalho/terrain/fit_tolerance.h"
#include "retalho/terrain/folds.h"
#include "retalho/tin/cell_delaunay.h"

namespace retalho {

struct HeldFit::Parts {
  HeldFitOptions options;
  Context context;
  CellTriangulation triangulation;
  FitState state;
  std::vector<Vec2> points;  // in units of the fit, by the mesh's numbers

  Parts(const Raster& raster, std::span<const greedy::Cell> vertices, const HeldFitOptions& o, const Context& c,
        std::span<const std::uint8_t> folded)
      : options(o),
        context(c),
        triangulation(triangulate_cells(vertices)),
        state(raster, o.surface, triangulation.mesh, c) {
    for (std::uint32_t v = 0; v < state.mesh.vertex_count(); ++v) points.push_back(state.grid.place(state.mesh.at(v)));
    if (options.surface != SurfaceKind::linear) {
      state.weights.slope = options.slope_weight;
      state.weights.fairness = options.fairness;
    }
    if (!folded.empty())
      for (std::uint32_t v = 0; v < state.mesh.vertex_count(); ++v)
        state.folded.push_back(folded[triangulation.vertex[v]]);
    state.refresh(context, true);
  }

  StarErrors star_errors(std::uint32_t vertex, double height, Vec2 gradient, bool folded, double tolerance) const;

  void solve(const CgLimits& limits) {
    FitSolveOptions how;
    how.limits = limits;
    how.pinned = state.pinned;
    how.heights_only = options.heights_only;
    solve_fit(state.kind, state.mesh.triangles(), state.elements, points, state.data, how, context);
  }
};

HeldFit::HeldFit(const Raster& raster, std::span<const greedy::Cell> vertices, const HeldFitOptions& options,
                 const Context& context, std::span<const std::uint8_t> folded)
    : parts_(std::make_unique<Parts>(raster, vertices, options, context, folded)) {}
HeldFit::~HeldFit() = default;
HeldFit::HeldFit(HeldFit&&) noexcept = default;
HeldFit& HeldFit::operator=(HeldFit&&) noexcept = default;

double HeldFit::height(std::uint32_t vertex) const {
  return parts_->state.data[parts_->triangulation.number[vertex]].x + parts_->state.grid.reference;
}

Vec2 HeldFit::gradient(std::uint32_t vertex) const {
  const Vec3& u = parts_->state.data[parts_->triangulation.number[vertex]];
  return {u.y, u.z};
}

bool HeldFit::is_folded(std::uint32_t vertex) const {
  return parts_->state.is_folded(parts_->triangulation.number[vertex]);
}

void HeldFit::set(std::uint32_t vertex, double height, Vec2 gradient) {
  parts_->state.data[parts_->triangulation.number[vertex]] = {height - parts_->state.grid.reference, gradient.x,
                                                              gradient.y};
}

HeldFit::StarErrors HeldFit::star_errors(std::uint32_t vertex, double height, Vec2 gradient, double tolerance) const {
  return parts_->star_errors(vertex, height, gradient, is_folded(vertex), tolerance);
}

HeldFit::StarErrors HeldFit::star_errors_folded(std::uint32_t vertex, double height, double tolerance) const {
  return parts_->star_errors(vertex, height, {}, true, tolerance);
}

void HeldFit::fold(std::uint32_t vertex, double height) {
  set(vertex, height, {});
  parts_->state.folded[parts_->triangulation.number[vertex]] = 1;
}

HeldFit::StarErrors HeldFit::Parts::star_errors(std::uint32_t vertex, double height, Vec2 gradient, bool folded,
                                                double tolerance) const {
  const FitState& s = state;
  const std::uint32_t me = triangulation.number[vertex];
  CellMesh::Star star;
  s.mesh.star(me, star);
  StarErrors sum;
  for (const std::uint32_t t : star.triangles) {
    CornerData corners = s.corner_data(t);
    for (std::size_t k = 0; k < 3; ++k)
      if (s.mesh.triangles()[t][k] == me) corners[k] = {height - s.grid.reference, gradient.x, gradient.y};
    FitTriangle triangle = s.triangle(t);
    for (std::size_t k = 0; k < 3; ++k)
      if (folded && triangle.vertex[k] == me) triangle.folded |= static_cast<std::uint8_t>(1U << k);
    fold_corners(triangle.corner, triangle.folded, corners);
    each_error(s.kind, triangle, corners, s.grid, s.weights.inside, [&](std::size_t, double error) {
      const double relative = std::abs(error) / tolerance;
      sum.squares += relative * relative;
      if (relative > 1) sum.excess += (relative - 1) * (relative - 1);
    });
  }
  return sum;
}

void HeldFit::hold_height(std::uint32_t vertex, double height) {
  const std::uint32_t v = parts_->triangulation.number[vertex];
  parts_->state.data[v].x = height - parts_->state.grid.reference;
  parts_->state.pinned[v] |= kHeldHeight;
}

void HeldFit::hold_gradient(std::uint32_t vertex, Vec2 gradient) {
  const std::uint32_t v = parts_->triangulation.number[vertex];
  parts_->state.data[v].y = gradient.x;
  parts_->state.data[v].z = gradient.y;
  parts_->state.pinned[v] |= kHeldGradient;
}

void HeldFit::release() {
  std::fill(parts_->state.pinned.begin(), parts_->state.pinned.end(), std::uint8_t{0});
}

void HeldFit::release(std::uint32_t vertex) {
  parts_->state.pinned[parts_->triangulation.number[vertex]] = 0;
}

void HeldFit::solve(double tolerance, int iterations) {
  parts_->solve({tolerance, iterations});
}

const std::vector<float>& HeldFit::cell_weights() const {
  return parts_->state.cell_weights;
}

void HeldFit::set_cell_weights(std::vector<float> weights) {
  parts_->state.cell_weights = std::move(weights);
  parts_->state.refresh(parts_->context, true);
}

bool HeldFit::reweigh(double tolerance) {
  FitState& s = parts_->state;
  if (s.cell_weights.empty()) s.cell_weights.assign(s.grid.z.size(), 1.0F);
  return retalho::reweigh(s, tolerance, parts_->context);
}

std::vector<double> HeldFit::errors() const {
  const FitState& s = parts_->state;
  std::vector<double> result(s.grid.z.size(), std::numeric_limits<double>::quiet_NaN());
  parallel_chunks(s.mesh.triangle_count(), 64, parts_->context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto t = static_cast<std::uint32_t>(k);
      each_error(s.kind, s.triangle(t), s.corner_data(t), s.grid, s.weights.inside,
                 [&](std::size_t cell, double error) { result[cell] = error; });
    }
  });
  return result;
}

std::vector<std::uint32_t> HeldFit::neighbors(std::uint32_t vertex) const {
  CellMesh::Star star;
  parts_->state.mesh.star(parts_->triangulation.number[vertex], star);
  for (std::uint32_t& v : star.ring) v = parts_->triangulation.vertex[v];
  return star.ring;
}

std::vector<std::uint32_t> HeldFit::vertices_over(double tolerance) const {
  const FitState& s = parts_->state;
  std::vector<std::uint8_t> over(s.mesh.triangle_count(), 0);
  parallel_chunks(over.size(), 64, parts_->context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto t = static_cast<std::uint32_t>(k);
      each_error(s.kind, s.triangle(t), s.corner_data(t), s.grid, s.weights.inside, [&](std::size_t, double error) {
        if (std::abs(error) > tolerance) over[k] = 1;
      });
    }
  });
  std::vector<std::uint32_t> list;
  for (std::size_t t = 0; t < over.size(); ++t)
    if (over[t] != 0)
      for (const std::uint32_t v : s.mesh.triangles()[t]) list.push_back(parts_->triangulation.vertex[v]);
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

std::vector<greedy::Cell> HeldFit::worst_cells(double tolerance) const {
  const FitState& s = parts_->state;
  struct Worst {
    double error = 0;
    greedy::Cell cell = 0;
  };
  std::vector<Worst> worst(s.mesh.triangle_count());
  const auto across = static_cast<std::size_t>(s.grid.columns);
  parallel_chunks(worst.size(), 64, parts_->context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto t = static_cast<std::uint32_t>(k);
      const auto& corners = s.mesh.triangles()[t];
      each_error(s.kind, s.triangle(t), s.corner_data(t), s.grid, s.weights.inside, [&](std::size_t at, double error) {
        if (!(std::abs(error) > std::max(tolerance, worst[k].error))) return;
        const greedy::Cell cell = greedy::cell_at(static_cast<int>(at % across), static_cast<int>(at / across));
        const bool is_vertex =
            std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return s.mesh.cell(v) == cell; });
        if (!is_vertex) worst[k] = {std::abs(error), cell};
      });
    }
  });
  std::vector<std::uint32_t> order;
  for (std::uint32_t t = 0; t < worst.size(); ++t)
    if (worst[t].error > 0) order.push_back(t);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return worst[a].error > worst[b].error; });
  std::vector<std::uint8_t> taken(worst.size(), 0);
  std::vector<greedy::Cell> cells;
  for (const std::uint32_t t : order) {
    if (taken[t] != 0) continue;
    cells.push_back(worst[t].cell);
    for (const std::uint32_t n : s.mesh.neighbors()[t])
      if (n != kNone) taken[n] = 1;
  }
  return cells;
}

}  // namespace retalho
