#include "retalho/terrain/least_squares.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/terrain/crease_unknowns.h"
#include "retalho/terrain/creases.h"
#include "retalho/terrain/fit_system.h"
#include "retalho/terrain/gradients.h"

namespace retalho {
namespace {

void check(const Terrain& terrain, const Raster& raster, const LeastSquaresOptions& options) {
  if (!(options.slope_weight >= 0) || !(options.fairness >= 0) || std::isinf(options.slope_weight) ||
      std::isinf(options.fairness))
    throw UsageError(fmt::format("the weights of a fit must be 0 or more, not {} (slopes) and {} (fairness)",
                                 options.slope_weight, options.fairness));
  if (!options.held.empty() && options.held.size() != terrain.tin.vertex_count())
    throw UsageError(
        fmt::format("{} marks of held vertices for {} vertices", options.held.size(), terrain.tin.vertex_count()));
  if (!options.held.empty() && options.heights_only)
    throw UsageError("gradients that follow from the heights cannot be held: heights_only takes no held vertices");
  if (!terrain.creases.empty() && options.heights_only)
    throw UsageError("a surface with creases has gradients of its own on each side: heights_only takes none");
  const GridDomain& grid = terrain.grid;
  if (grid.columns != raster.columns || grid.rows != raster.rows || grid.cell_width != raster.cell_width ||
      grid.cell_height != raster.cell_height)
    throw BadInput(fmt::format("a surface on {} x {} cells cannot be fitted to a grid of {} x {}", grid.columns,
                               grid.rows, raster.columns, raster.rows));
  if (terrain.kind == SurfaceKind::clough_tocher && terrain.cross_derivative == CrossDerivative::cubic)
    throw BadInput("the least-squares fit takes Clough-Tocher with the perpendicular cross derivative");
}

class Fit {
 public:
  Fit(Terrain& terrain, const Raster& raster, const LeastSquaresOptions& options, const Context& context)
      : terrain_(terrain), options_(options), context_(context), grid_(raster, context) {
    const Tin& tin = terrain.tin;
    at_.resize(tin.vertex_count());
    points_.resize(tin.vertex_count());
    data_.resize(std::max(tin.vertex_count(), terrain.gradients.size()));  // with creases: one a sector
    for (std::size_t v = 0; v < at_.size(); ++v) {
      at_[v] = cell_coordinates(tin.points[v], raster);
      points_[v] = grid_.place(at_[v]);
      data_[v].x = tin.heights[v] - grid_.reference;
    }
    for (std::size_t n = 0; n < terrain.gradients.size(); ++n) {
      data_[n].y = terrain.gradients[n].x * grid_.unit;
      data_[n].z = terrain.gradients[n].y * grid_.unit;
    }
    if (terrain.kind != SurfaceKind::linear) {
      weights_.slope = options.slope_weight;
      weights_.fairness = options.fairness;
    }
    const auto& first = tin.triangles.front();
    weights_.inside = (at_[first[0]] + at_[first[1]] + at_[first[2]]) / 3;
    if (terrain.kind == SurfaceKind::powell_sabin || !terrain.creases.empty()) edges_ = build_edges(tin);
    if (options.slopes_across_creases) return;
    for (const std::uint32_t e : terrain.creases) grid_.tear(at_[edges_.vertices[e][0]], at_[edges_.vertices[e][1]]);
  }

  int run() {
    const Tin& tin = terrain_.tin;
    std::vector<FitElement> elements(tin.triangle_count());
    context_.report("fit", 0);
    parallel_chunks(elements.size(), 64, context_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t)
        elements[t] = fit_element(terrain_.kind, triangle(static_cast<std::uint32_t>(t)), grid_, weights_);
    });
    context_.report("fit", 0.5);
    FitSolveOptions solve;
    solve.limits = {options_.tolerance, options_.iterations};
    solve.heights_only = options_.heights_only;
    std::vector<std::uint8_t> pinned(options_.held.begin(), options_.held.end());
    for (std::uint8_t& mark : pinned) mark = mark != 0 ? kHeldHeight | kHeldGradient : 0;
    solve.pinned = pinned;
    const int iterations =
        terrain_.creases.empty()
            ? solve_fit(terrain_.kind, tin.triangles, elements, points_, data_, solve, context_)
            : solve_creased(CreasedUnknowns(tin.triangles, tin.neighbors, terrain_.corner_gradients, points_), elements,
                            data_, solve, context_);
    store();
    context_.report("fit", 1);
    return iterations;
  }

 private:
  FitTriangle triangle(std::uint32_t t) const {
    FitTriangle result;
    result.vertex = terrain_.tin.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      result.at[k] = at_[result.vertex[k]];
      result.corner[k] = points_[result.vertex[k]];
      if (terrain_.kind == SurfaceKind::powell_sabin) result.split[k] = terrain_.edge_split[edges_.of_triangle[t][k]];
    }
    return result;
  }

  void store() {
    const auto held = [&](std::size_t v) { return !options_.held.empty() && options_.held[v] != 0; };
    const std::size_t vertices = terrain_.tin.vertex_count();
    for (std::size_t v = 0; v < vertices; ++v)
      if (!held(v)) terrain_.tin.heights[v] = data_[v].x + grid_.reference;
    if (terrain_.kind == SurfaceKind::linear) return;
    if (options_.heights_only) {
      terrain_.gradients = estimate_gradients(terrain_.tin, build_edges(terrain_.tin), GradientKind::normals, context_);
      terrain_.gradient_kind = GradientKind::normals;
      return;
    }
    const std::vector<std::uint32_t> vertex = sector_vertices(
        terrain_.tin, terrain_.creases.empty() ? terrain_.tin.triangles : terrain_.corner_gradients, data_.size());
    for (std::size_t n = 0; n < data_.size(); ++n)
      if (!held(vertex[n])) terrain_.gradients[n] = Vec2{data_[n].y, data_[n].z} / grid_.unit;
    terrain_.gradient_kind = GradientKind::fitted;
  }

  Terrain& terrain_;
  const LeastSquaresOptions& options_;
  const Context& context_;
  FitGrid grid_;
  FitWeights weights_;
  EdgeTable edges_;
  std::vector<Vec2> at_, points_;
  std::vector<Vec3> data_;
};

}  // namespace

Terrain fit_least_squares(Terrain terrain, const Raster& raster, const LeastSquaresOptions& options,
                          const Context& context, LeastSquaresNotes* notes) {
  check(terrain, raster, options);
  const int iterations = Fit(terrain, raster, options, context).run();
  if (notes) notes->iterations = iterations;
  return terrain;
}

Terrain make_fitted(Tin tin, const Raster& raster, const SurfaceOptions& surface, FitKind fit, const Context& context) {
  Terrain terrain = make_terrain(std::move(tin), raster, surface, context);
  if (fit == FitKind::interpolate) return terrain;
  return fit_least_squares(std::move(terrain), raster, {.heights_only = fit == FitKind::z_only}, context);
}

}  // namespace retalho
