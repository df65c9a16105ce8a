#include "retalho/terrain/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/terrain/clough_tocher.h"
#include "retalho/terrain/creases.h"
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

/// Takes the creases over; returns how many gradients the surface has.
std::size_t set_creases(Terrain& terrain, const EdgeTable& edges, std::vector<std::uint32_t> creases) {
  for (const std::uint32_t e : creases)
    if (e >= edges.vertices.size())
      throw UsageError(fmt::format("crease {} is no edge: the triangulation has {}", e, edges.vertices.size()));
  std::sort(creases.begin(), creases.end());
  creases.erase(std::unique(creases.begin(), creases.end()), creases.end());
  // On the border there is nothing to fold against.
  std::erase_if(creases, [&](std::uint32_t e) { return edges.triangles[e][1] == kNone; });
  std::size_t nodes = terrain.tin.vertex_count();
  if (creases.empty()) return nodes;
  terrain.corner_gradients = crease_sectors(terrain.tin, edges, creases, &nodes);
  terrain.creases = std::move(creases);
  return nodes;
}

std::vector<Vec2> gradients_for(const Terrain& terrain, const EdgeTable& edges, const SurfaceOptions& options,
                                std::size_t nodes, const Context& context) {
  if (options.gradients == GradientKind::none)
    throw UsageError(fmt::format("a {} surface needs gradients: normals, quadratic, network or given",
                                 surface_name(options.surface)));
  const std::vector<std::array<std::uint32_t, 3>>& sectors = terrain.corner_gradients;
  if (options.gradients != GradientKind::given)
    return sectors.empty() ? estimate_gradients(terrain.tin, edges, options.gradients, context)
                           : sector_gradients(terrain.tin, edges, terrain.creases, sectors, options.gradients, context);
  if (!options.given) throw UsageError("gradients are to be given, but none were");
  if (options.given->size() != nodes)
    throw UsageError(fmt::format("{} gradients for {} {}", options.given->size(), nodes,
                                 sectors.empty() ? "vertices" : "sectors at vertices"));
  for (std::size_t v = 0; v < options.given->size(); ++v)
    if (!std::isfinite((*options.given)[v].x) || !std::isfinite((*options.given)[v].y))
      throw BadInput(fmt::format("the gradient of vertex {} is not finite", v));
  return *options.given;
}

/// The cubic rule takes both triangles of an edge for one surface: not at creases, nor where sectors meet.
void keep_creases(Terrain& terrain, const EdgeTable& edges) {
  std::vector<char> creased(terrain.tin.vertex_count(), 0);
  for (const std::uint32_t e : terrain.creases)
    for (const std::uint32_t v : edges.vertices[e]) creased[v] = 1;
  for (std::size_t e = 0; e < edges.vertices.size(); ++e)
    for (const std::uint32_t t : edges.triangles[e])
      for (std::size_t k = 0; t != kNone && k < 3; ++k)
        if (creased[terrain.tin.triangles[t][k]]) terrain.edge_fallback[e] = 1;
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
  const std::size_t nodes = set_creases(terrain, edges, options.creases);
  terrain.gradients = gradients_for(terrain, edges, options, nodes, context);
  if (terrain.kind == SurfaceKind::powell_sabin) {
    terrain.edge_split = powell_sabin_splits(terrain.tin, edges, context);
  } else {
    terrain.cross_derivative = options.cross_derivative;
    if (terrain.cross_derivative == CrossDerivative::cubic)
      terrain.edge_fallback = cubic_fallbacks(terrain.tin, edges, context);
    if (!terrain.edge_fallback.empty() && !terrain.creases.empty()) keep_creases(terrain, edges);
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
