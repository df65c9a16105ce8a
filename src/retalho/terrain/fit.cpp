#include "retalho/terrain/fit.h"

#include <fmt/format.h>

#include <cmath>

#include "retalho/core/error.h"
#include "retalho/terrain/clough_tocher.h"
#include "retalho/terrain/gradients.h"
#include "retalho/terrain/powell_sabin.h"
#include "retalho/terrain/side.h"

namespace retalho {
namespace {

void check_tin(const Tin& tin) {
  if (tin.triangles.empty())
    throw BadInput("the triangulation has no triangle: a surface needs at least three points not on one line");
  if (tin.heights.size() != tin.points.size())
    throw BadInput(
        fmt::format("the triangulation has {} points, but {} heights", tin.points.size(), tin.heights.size()));
  for (std::size_t v = 0; v < tin.points.size(); ++v)
    if (!std::isfinite(tin.points[v].x) || !std::isfinite(tin.points[v].y) || !std::isfinite(tin.heights[v]))
      throw BadInput(
          fmt::format("vertex {} is not finite: ({}, {}, {})", v, tin.points[v].x, tin.points[v].y, tin.heights[v]));
}

void check_triangles(const Tin& tin) {
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t];
    for (const std::uint32_t k : v)
      if (k >= tin.points.size())
        throw BadInput(fmt::format("triangle {} names vertex {} of {}", t, k, tin.points.size()));
    if (side_of(tin.points[v[0]], tin.points[v[1]], tin.points[v[2]]) <= 0)
      throw BadInput(
          fmt::format("triangle {} ({}, {}, {}) is not counter-clockwise or has no area", t, v[0], v[1], v[2]));
  }
}

std::vector<Vec2> gradients_for(const Terrain& terrain, const EdgeTable& edges, const SurfaceOptions& options,
                                const Context& context) {
  if (options.gradients == GradientKind::none)
    throw UsageError(fmt::format("a {} surface needs gradients: normals, quadratic, network or given",
                                 surface_name(options.surface)));
  if (options.gradients != GradientKind::given)
    return estimate_gradients(terrain.tin, edges, options.gradients, context);
  if (!options.given) throw UsageError("gradients are to be given, but none were");
  if (options.given->size() != terrain.tin.vertex_count())
    throw UsageError(fmt::format("{} gradients for {} vertices", options.given->size(), terrain.tin.vertex_count()));
  for (std::size_t v = 0; v < options.given->size(); ++v)
    if (!std::isfinite((*options.given)[v].x) || !std::isfinite((*options.given)[v].y))
      throw BadInput(fmt::format("the gradient of vertex {} is not finite", v));
  return *options.given;
}

}  // namespace

Terrain make_terrain(Tin tin, const Georef& georef, const SurfaceOptions& options, const Context& context) {
  check_tin(tin);
  check_triangles(tin);
  if (tin.neighbors.size() != tin.triangles.size()) build_neighbors(tin);
  Terrain terrain;
  terrain.kind = options.surface;
  terrain.georef = georef;
  terrain.tin = std::move(tin);
  if (terrain.kind == SurfaceKind::linear) return terrain;

  const EdgeTable edges = build_edges(terrain.tin);
  context.report("gradients", 0);
  terrain.gradient_kind = options.gradients;
  terrain.gradients = gradients_for(terrain, edges, options, context);
  if (terrain.kind == SurfaceKind::powell_sabin) {
    terrain.edge_split = powell_sabin_splits(terrain.tin, edges, context);
  } else {
    terrain.cross_derivative = options.cross_derivative;
    if (terrain.cross_derivative == CrossDerivative::cubic)
      terrain.edge_fallback = cubic_fallbacks(terrain.tin, edges, context);
  }
  context.report("gradients", 1);
  return terrain;
}

Terrain make_terrain(Tin tin, const Raster& raster, const SurfaceOptions& options, const Context& context) {
  Terrain terrain = make_terrain(std::move(tin), raster.georef, options, context);
  terrain.grid.columns = raster.columns;
  terrain.grid.rows = raster.rows;
  terrain.grid.cell_width = raster.cell_width;
  terrain.grid.cell_height = raster.cell_height;
  Mask valid = valid_mask(raster);
  if (valid.count() < raster.cells()) terrain.grid.valid = std::move(valid);
  return terrain;
}

}  // namespace retalho
