#include "retalho/terrain/folded_surface.h"

#include "retalho/terrain/creases.h"
#include "retalho/terrain/folds.h"

namespace retalho {

FoldedSurface folded_surface(const Tin& tin, std::span<const std::uint8_t> folded, std::span<const Vec2> gradients) {
  FoldedSurface result;
  const EdgeTable edges = build_edges(tin);
  for (std::uint32_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [a, b] = edges.vertices[e];
    if (edges.triangles[e][1] != kNone && (folded[a] != 0 || folded[b] != 0)) result.creases.push_back(e);
  }
  std::size_t nodes = 0;
  result.sectors = crease_sectors(tin, edges, result.creases, &nodes);
  result.gradients.assign(nodes, Vec2{});
  for (std::size_t t = 0; t < result.sectors.size(); ++t) {
    const auto& v = tin.triangles[t];
    const Vec2 plane = plane_slope({tin.points[v[0]], tin.points[v[1]], tin.points[v[2]]},
                                   {tin.heights[v[0]], tin.heights[v[1]], tin.heights[v[2]]});
    for (std::size_t k = 0; k < 3; ++k)
      result.gradients[result.sectors[t][k]] = folded[v[k]] != 0 ? plane : gradients[v[k]];
  }
  return result;
}

}  // namespace retalho
