#include "retalho/terrain/surface_refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "retalho/core/error.h"
#include "retalho/terrain/crease_choice.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/fit_moves.h"
#include "retalho/terrain/fit_tolerance.h"
#include "retalho/terrain/folded_surface.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/report.h"
#include "retalho/tin/grid_hull.h"

namespace retalho {
namespace {

void check(const SurfaceRefineOptions& o) {
  if (!(o.slope_weight >= 0) || !(o.fairness >= 0) || std::isinf(o.slope_weight) || std::isinf(o.fairness))
    throw UsageError(fmt::format("the weights of a fit must be 0 or more, not {} (slopes) and {} (fairness)",
                                 o.slope_weight, o.fairness));
  if (!(o.growth > 0 && o.growth <= 1)) throw UsageError(fmt::format("growth must be in (0, 1], not {}", o.growth));
  if (!(o.max_error >= 0) || std::isinf(o.max_error))
    throw UsageError(fmt::format("the largest error must be 0 or more, not {}", o.max_error), {}, "max_error");
  if (o.max_error == 0 && o.vertices == 0)
    throw UsageError("refinement of a surface needs a largest error or a budget");
  if (o.heights_only && o.surface == SurfaceKind::linear)
    throw UsageError("heights alone are fitted for a smooth surface: a flat one has no gradients to follow them");
  if (o.heights_only && o.max_error > 0)
    throw UsageError("heights alone are refined to a number of vertices, not to a largest error", {}, "max_error");
  if (o.creases && (o.max_error > 0 || o.surface == SurfaceKind::linear || o.heights_only))
    throw UsageError(
        "creases are chosen for smooth surfaces and a budget: leave the largest error and heights_only out", {},
        "creases");
  if (o.relocations < 0 || o.exchanges < 0) throw UsageError("relocations and exchanges must be 0 or more");
}

FitState begin(const Raster& raster, const SurfaceRefineOptions& options, const Context& context) {
  FitState state(raster, options.surface, context);
  if (options.surface != SurfaceKind::linear) {
    state.weights.slope = options.slope_weight;
    state.weights.fairness = options.fairness;
  }
  constexpr int kStart = 4;  // cells of a coarse lattice
  for (int j = 0; j <= kStart; ++j)
    for (int i = 0; i <= kStart; ++i) {
      if (options.vertices != 0 && state.mesh.vertex_count() >= options.vertices) continue;
      const int column = (raster.columns - 1) * i / kStart, row = (raster.rows - 1) * j / kStart;
      const greedy::Cell cell = greedy::cell_at(column, row);
      if (raster.valid(column, row)) state.insert(cell, 0, {state.height(cell), 0, 0});
    }
  state.refresh(context);
  state.solve(kRoughSolve, context);
  return state;
}

void grow(FitState& state, std::size_t vertices, double growth, const Context& context) {
  while (state.mesh.vertex_count() < vertices) {
    context.check();
    const std::size_t n = state.mesh.vertex_count();
    const auto round = std::max<std::size_t>(1, static_cast<std::size_t>(growth * static_cast<double>(n)));
    if (insert_at_centroids(state, std::min(round, vertices - n), context) == 0) break;
    state.refresh(context);
    state.solve(kRoughSolve, context);
    state.set_gradient_price();
    refold(state, context);
    context.report("refine", static_cast<double>(n) / static_cast<double>(vertices));
  }
  context.report("refine", 1);
}

Terrain refine_heights(const Raster& raster, const SurfaceRefineOptions& options, const Context& context) {
  SurfaceRefineOptions flat = options;
  flat.surface = SurfaceKind::linear;
  flat.heights_only = false;
  Tin tin = refine_surface(raster, flat, context).tin;
  return fit_least_squares(make_terrain(std::move(tin), raster, {.surface = options.surface}, context), raster,
                           {.heights_only = true, .slope_weight = options.slope_weight, .fairness = options.fairness},
                           context);
}

}  // namespace

const char* effort_name(Effort effort) {
  return effort == Effort::fast ? "fast" : effort == Effort::best ? "best" : "normal";
}

std::optional<Effort> parse_effort(std::string_view name) {
  for (const Effort effort : {Effort::fast, Effort::normal, Effort::best})
    if (name == effort_name(effort)) return effort;
  return std::nullopt;
}

SurfaceRefineOptions with_effort(SurfaceRefineOptions options, Effort effort) {
  const SurfaceRefineOptions normal;
  options.relocations = effort == Effort::fast ? 0 : effort == Effort::best ? 5 : normal.relocations;
  options.exchanges = effort == Effort::fast ? 0 : effort == Effort::best ? 25 : normal.exchanges;
  return options;
}

void better(FitState& state, int relocations, int exchanges, const Context& context) {
  constexpr double kExchanged = 0.05;  // of the vertices a round
  double reach = 0.35, share = kExchanged;
  const auto sweep = [&](int done) {
    context.report("relocate", done / std::max(1.0, static_cast<double>(relocations + exchanges)));
    relocate(state, reach, kRoughSolve, context);
    reach = std::max(0.15, reach * 0.85);
  };
  for (int k = 0; k < relocations; ++k) {
    state.set_gradient_price();
    sweep(k);
  }
  for (int k = 0; k < exchanges; ++k) {
    const FitSnapshot before(state);
    state.set_gradient_price();
    const double cost = state.cost(context);
    exchange(state, share, kRoughSolve, context);
    sweep(relocations + k);  // judged together: new vertices are not yet at their best places
    if (state.cost(context) < cost) continue;
    before.restore(state, context);
    share /= 2;
  }
  if (relocations + exchanges > 0) context.report("relocate", 1);
}

Terrain refine_inside(const Raster& raster, std::span<const SideVertex> sides, const std::array<bool, 4>& frozen,
                      const SurfaceRefineOptions& options, const Context& context) {
  check(options);
  if (options.max_error > 0 || options.vertices == 0 || options.heights_only || options.creases ||
      options.surface == SurfaceKind::powell_sabin)
    throw UsageError(
        "a grid with settled sides is refined to a number of vertices, by a linear or Clough-Tocher surface");
  FitState state(raster, options.surface, CellMesh(greedy::hull_of_valid(raster)), context);
  state.frozen = frozen;
  if (options.surface != SurfaceKind::linear) {
    state.weights.slope = options.slope_weight;
    state.weights.fairness = options.fairness;
  }
  std::unordered_map<CellMesh::Cell, std::uint32_t> corners;
  for (std::uint32_t v = 0; v < state.mesh.vertex_count(); ++v) corners.emplace(state.mesh.cell(v), v);
  for (const SideVertex& side : sides) {
    const auto refuse = [&] {
      throw UsageError(fmt::format("no vertex can be settled at cell ({}, {})", side.column, side.row));
    };
    if (side.column < 0 || side.row < 0 || side.column >= raster.columns || side.row >= raster.rows ||
        !raster.valid(side.column, side.row))
      refuse();
    const CellMesh::Cell cell = greedy::cell_at(side.column, side.row);
    const Vec3 data = side.held ? Vec3{side.height - state.grid.reference, side.gradient.x * state.grid.unit,
                                       side.gradient.y * state.grid.unit}
                                : Vec3{state.height(cell), 0, 0};
    const auto corner = corners.find(cell);
    const auto v = corner != corners.end() ? corner->second : static_cast<std::uint32_t>(state.mesh.vertex_count());
    if (corner == corners.end() && !state.insert(cell, 0, data)) refuse();
    state.data[v] = data;
    if (side.held) state.pinned[v] = kHeldHeight | kHeldGradient;
  }
  state.refresh(context, true);
  state.solve(kRoughSolve, context);
  grow(state, options.vertices, options.growth, context);
  better(state, options.relocations, options.exchanges, context);
  state.solve(kFinalSolve, context);
  Terrain terrain = to_terrain(state, raster, context);
  // What is held has been through other units: here are the very numbers.
  std::unordered_map<std::uint64_t, const SideVertex*> held;
  const auto key = [](std::int64_t column, std::int64_t row) { return static_cast<std::uint64_t>(row << 32 | column); };
  for (const SideVertex& side : sides)
    if (side.held) held.emplace(key(side.column, side.row), &side);
  for (std::size_t v = 0; v < terrain.tin.vertex_count(); ++v) {
    const Vec2 at = cell_coordinates(terrain.tin.points[v], raster);
    const auto found = held.find(key(std::llround(at.x), std::llround(-at.y)));
    if (found == held.end()) continue;
    terrain.tin.heights[v] = found->second->height;
    if (!terrain.gradients.empty()) terrain.gradients[v] = found->second->gradient;
  }
  return terrain;
}

namespace {

/// As the options ask for, but for creases.
Terrain refine(FitState& state, const Raster& raster, const SurfaceRefineOptions& options, const Context& context) {
  if (options.max_error > 0) {
    const ToleranceOptions tolerance{options.max_error, options.vertices, options.growth, options.relocations,
                                     options.exchanges};
    Terrain terrain = refine_to_tolerance(state, raster, tolerance, context);
    terrain.tolerance = options.max_error;
    return terrain;
  }
  grow(state, options.vertices, options.growth, context);
  better(state, options.relocations, options.exchanges, context);
  state.solve(kFinalSolve, context);
  return to_terrain(state, raster, context);
}

}  // namespace

FoldedVertices refine_folded(const Raster& raster, const SurfaceRefineOptions& options, const Context& context) {
  check(options);
  if (options.surface != SurfaceKind::clough_tocher || options.creases || options.heights_only)
    throw UsageError("vertices of a Clough-Tocher surface can be folded, without other creases", {}, "surface");
  FitState state = begin(raster, options, context);
  state.folded.assign(state.mesh.vertex_count(), 0);
  refine(state, raster, options, context);
  FoldedVertices result;
  std::vector<std::uint32_t> order(state.mesh.vertex_count());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return state.mesh.cell(a) < state.mesh.cell(b); });
  for (const std::uint32_t v : order) {
    result.cells.push_back(state.mesh.cell(v));
    result.folded.push_back(state.folded[v]);
  }
  return result;
}

Terrain refine_surface(const Raster& raster, const SurfaceRefineOptions& options, const Context& context) {
  check(options);
  if (options.heights_only) return refine_heights(raster, options, context);
  FitState state = begin(raster, options, context);
  Terrain terrain = refine(state, raster, options, context);
  if (!options.creases) return terrain;
  const CreaseChoice chosen = trade_for_creases(state, context);
  if (chosen.edges.empty()) return terrain;
  Terrain creased = fit_least_squares(to_terrain(state, raster, context, chosen.edges), raster,
                                      {.slope_weight = options.slope_weight,
                                       .fairness = options.fairness,
                                       .tolerance = kFinalSolve.tolerance,
                                       .iterations = kFinalSolve.iterations,
                                       .slopes_across_creases = true},  // they were chosen so
                                      context);
  // The objective counts slopes too, and a cell on a crease has two: heights decide.
  const bool nearer = assess(creased, raster, 0, context).rmse < assess(terrain, raster, 0, context).rmse;
  return nearer ? creased : terrain;
}

}  // namespace retalho
