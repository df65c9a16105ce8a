#include "retalho/terrain/surface_refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/terrain/fit_moves.h"

namespace retalho {
namespace {

constexpr CgLimits kRough{1e-5, 60}, kFinal{1e-8, 1000};
constexpr double kExchanged = 0.05;  // of the vertices a round

void check(const SurfaceRefineOptions& o) {
  if (!(o.slope_weight >= 0) || !(o.fairness >= 0) || std::isinf(o.slope_weight) || std::isinf(o.fairness))
    throw UsageError(fmt::format("the weights of a fit must be 0 or more, not {} (slopes) and {} (fairness)",
                                 o.slope_weight, o.fairness));
  if (!(o.growth > 0 && o.growth <= 1)) throw UsageError(fmt::format("growth must be in (0, 1], not {}", o.growth));
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
  state.solve(kRough, context);
  return state;
}

void grow(FitState& state, std::size_t vertices, double growth, const Context& context) {
  while (state.mesh.vertex_count() < vertices) {
    context.check();
    const std::size_t n = state.mesh.vertex_count();
    const auto round = std::max<std::size_t>(1, static_cast<std::size_t>(growth * static_cast<double>(n)));
    if (insert_at_centroids(state, std::min(round, vertices - n), context) == 0) break;
    state.refresh(context);
    state.solve(kRough, context);
    context.report("refine", static_cast<double>(n) / static_cast<double>(vertices));
  }
}

}  // namespace

Terrain refine_surface(const Raster& raster, const SurfaceRefineOptions& options, const Context& context) {
  check(options);
  FitState state = begin(raster, options, context);
  grow(state, options.vertices, options.growth, context);
  double reach = 0.35;
  const auto sweep = [&](int done) {
    context.report("relocate", done / std::max(1.0, static_cast<double>(options.relocations + options.exchanges)));
    relocate(state, reach, kRough, context);
    reach = std::max(0.15, reach * 0.85);
  };
  for (int k = 0; k < options.relocations; ++k) sweep(k);
  for (int k = 0; k < options.exchanges; ++k) {
    exchange(state, kExchanged, kRough, context);
    sweep(options.relocations + k);
  }
  state.solve(kFinal, context);
  return to_terrain(state, raster, context);
}

}  // namespace retalho
