// A grown triangulation as a Tin in canonical order.
#include <algorithm>
#include <array>
#include <numeric>

#include "retalho/tin/scattered_mesh.h"
#include "retalho/tin/scattered_places.h"

namespace retalho {

Tin to_tin(const ScatteredMesh& mesh, const Places& places, const std::vector<std::uint32_t>& vertex,
           std::size_t vertices) {
  const auto& triangles = mesh.triangles();
  const auto number = [&](std::uint32_t place) { return vertex.empty() ? place : vertex[place]; };
  // Sorted by smallest vertex (counting), then by the next one.
  std::vector<std::uint32_t> start(vertices + 1);
  const auto corner = [&](std::uint32_t t) {
    const auto& v = triangles[t].v;
    const std::array<std::uint32_t, 3> n{number(v[0]), number(v[1]), number(v[2])};
    return static_cast<std::uint32_t>(std::min_element(n.begin(), n.end()) - n.begin());
  };
  std::vector<std::uint32_t> renumbered(triangles.size(), kNone);
  std::size_t count = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (!mesh.is_ghost(t)) ++start[number(triangles[t].v[corner(t)]) + 1], ++count;
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint32_t> sorted(count), next = start;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    if (!mesh.is_ghost(t)) sorted[next[number(triangles[t].v[corner(t)])]++] = t;
  const auto second = [&](std::uint32_t t) { return number(triangles[t].v[(corner(t) + 1) % 3]); };
  for (std::size_t v = 0; v < vertices; ++v)
    std::sort(sorted.begin() + start[v], sorted.begin() + start[v + 1],
              [&](std::uint32_t a, std::uint32_t b) { return second(a) < second(b); });

  for (std::uint32_t k = 0; k < count; ++k) renumbered[sorted[k]] = k;
  Tin tin;
  tin.points.resize(vertices);
  tin.heights.resize(vertices);
  for (std::uint32_t place = 0; place < places.at.size(); ++place)
    if (const std::uint32_t v = number(place); v != kNone) {
      tin.points[v] = places.at[place];
      tin.heights[v] = places.heights[place];
    }
  tin.triangles.resize(count);
  tin.neighbors.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto& triangle = triangles[sorted[k]];
    const std::uint32_t turn = corner(sorted[k]);
    for (std::uint32_t c = 0; c < 3; ++c) {
      tin.triangles[k][c] = number(triangle.v[(turn + c) % 3]);
      tin.neighbors[k][c] = renumbered[triangle.n[(turn + c) % 3]];
    }
  }
  return tin;
}

}  // namespace retalho
