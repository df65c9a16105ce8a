#include "retalho/terrain/gradients.h"

#include <algorithm>
#include <array>

#include "retalho/core/parallel.h"
#include "retalho/terrain/gradient_estimates.h"

namespace retalho {
namespace {

/// The triangles around each vertex, in the order of their numbers.
struct Stars {
  std::vector<std::uint32_t> begin, triangles;
};

Stars build_stars(const Tin& tin) {
  Stars stars;
  stars.begin.assign(tin.vertex_count() + 1, 0);
  for (const auto& t : tin.triangles)
    for (const std::uint32_t v : t) ++stars.begin[v + 1];
  for (std::size_t v = 0; v < tin.vertex_count(); ++v) stars.begin[v + 1] += stars.begin[v];
  stars.triangles.resize(stars.begin.back());
  std::vector<std::uint32_t> next(stars.begin.begin(), stars.begin.end() - 1);
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t)
    for (const std::uint32_t v : tin.triangles[t]) stars.triangles[next[v]++] = t;
  return stars;
}

std::vector<Vec2> normals(const Tin& tin, const Context& context) {
  const Stars stars = build_stars(tin);
  std::vector<Vec2> gradients(tin.vertex_count());
  parallel_chunks(gradients.size(), 4096, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3 sum;
      for (std::uint32_t k = stars.begin[v]; k < stars.begin[v + 1]; ++k) {
        const auto& t = tin.triangles[stars.triangles[k]];
        const Vec2 e1 = tin.points[t[1]] - tin.points[t[0]], e2 = tin.points[t[2]] - tin.points[t[0]];
        const double h1 = tin.heights[t[1]] - tin.heights[t[0]], h2 = tin.heights[t[2]] - tin.heights[t[0]];
        sum = sum + cross(Vec3{e1.x, e1.y, h1}, Vec3{e2.x, e2.y, h2});
      }
      if (sum.z > 0) gradients[v] = {-sum.x / sum.z, -sum.y / sum.z};
    }
  });
  return gradients;
}

}  // namespace

VertexRings build_rings(const Tin& tin, const EdgeTable& edges) {
  VertexRings rings;
  rings.begin.assign(tin.vertex_count() + 1, 0);
  for (const auto& e : edges.vertices)
    for (const std::uint32_t v : e) ++rings.begin[v + 1];
  for (std::size_t v = 0; v < tin.vertex_count(); ++v) rings.begin[v + 1] += rings.begin[v];
  rings.neighbors.resize(rings.begin.back());
  std::vector<std::uint32_t> next(rings.begin.begin(), rings.begin.end() - 1);
  for (const auto& [a, b] : edges.vertices) {
    rings.neighbors[next[a]++] = b;
    rings.neighbors[next[b]++] = a;
  }
  return rings;
}

std::vector<Vec2> estimate_gradients(const Tin& tin, const EdgeTable& edges, GradientKind kind,
                                     const Context& context) {
  switch (kind) {
    case GradientKind::quadratic:
      return quadratic_gradients(tin, build_rings(tin, edges), context);
    case GradientKind::network:
      return network_gradients(tin, build_rings(tin, edges), context);
    default:
      return normals(tin, context);
  }
}

}  // namespace retalho
