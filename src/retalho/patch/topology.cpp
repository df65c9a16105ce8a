#include "retalho/patch/topology.h"

#include <algorithm>

namespace retalho {

VertexTriangles vertex_triangles(std::span<const Triangle> triangles, std::size_t vertices) {
  VertexTriangles out;
  out.first.assign(vertices + 1, 0);
  for (const Triangle& t : triangles)
    for (const std::uint32_t v : t) ++out.first[v + 1];
  for (std::size_t i = 0; i < vertices; ++i) out.first[i + 1] += out.first[i];
  out.triangles.resize(3 * triangles.size());
  std::vector<std::uint32_t> at(out.first.begin(), out.first.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t v : triangles[t]) out.triangles[at[v]++] = t;
  return out;
}

std::vector<Triangle> triangle_neighbors(std::span<const Triangle> triangles) {
  std::uint32_t vertices = 0;
  for (const Triangle& t : triangles) vertices = std::max(vertices, 1 + std::max({t[0], t[1], t[2]}));
  const VertexTriangles around = vertex_triangles(triangles, vertices);
  std::vector<Triangle> neighbors(triangles.size(), {kNoTriangle, kNoTriangle, kNoTriangle});
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = triangles[t][(k + 1) % 3], to = triangles[t][(k + 2) % 3];
      for (const std::uint32_t other : around.of(from)) {  // the neighbour runs from `to` to `from`
        const Triangle& o = triangles[other];
        for (std::size_t j = 0; j < 3; ++j)
          if (o[j] == to && o[(j + 1) % 3] == from) neighbors[t][k] = other;
      }
    }
  return neighbors;
}

VertexNeighbors vertex_neighbors(std::span<const Triangle> triangles, std::size_t vertices) {
  const VertexTriangles around = vertex_triangles(triangles, vertices);
  VertexNeighbors out;
  out.first.reserve(vertices + 1);
  out.first.push_back(0);
  out.vertices.reserve(3 * triangles.size() + 2 * vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    const auto start = static_cast<std::ptrdiff_t>(out.vertices.size());
    for (const std::uint32_t t : around.of(v))
      for (const std::uint32_t w : triangles[t])
        if (w != v) out.vertices.push_back(w);
    std::sort(out.vertices.begin() + start, out.vertices.end());
    out.vertices.erase(std::unique(out.vertices.begin() + start, out.vertices.end()), out.vertices.end());
    out.first.push_back(static_cast<std::uint32_t>(out.vertices.size()));
  }
  return out;
}

}  // namespace retalho
