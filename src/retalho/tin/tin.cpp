#include "retalho/tin/tin.h"

#include <fmt/format.h>

#include <unordered_map>

#include "retalho/core/error.h"

namespace retalho {
namespace {

std::uint64_t directed(std::uint32_t from, std::uint32_t to) {
  return (std::uint64_t{from} << 32) | to;
}

}  // namespace

EdgeTable build_edges(const Tin& tin) {
  EdgeTable table;
  table.of_triangle.assign(tin.triangles.size(), {kNone, kNone, kNone});
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (table.of_triangle[t][k] != kNone) continue;
      const std::uint32_t a = tin.triangles[t][(k + 1) % 3], b = tin.triangles[t][(k + 2) % 3];
      const std::uint32_t other = tin.neighbors[t][k];
      const auto edge = static_cast<std::uint32_t>(table.vertices.size());
      table.vertices.push_back(a < b ? std::array{a, b} : std::array{b, a});
      table.triangles.push_back({t, other});
      table.of_triangle[t][k] = edge;
      if (other == kNone) continue;
      for (std::size_t m = 0; m < 3; ++m)
        if (tin.triangles[other][(m + 1) % 3] == b && tin.triangles[other][(m + 2) % 3] == a)
          table.of_triangle[other][m] = edge;
    }
  }
  return table;
}

void build_neighbors(Tin& tin) {
  std::unordered_map<std::uint64_t, std::uint32_t> sides;  // directed edge -> triangle * 3 + corner opposite
  sides.reserve(tin.triangles.size() * 3);
  tin.neighbors.assign(tin.triangles.size(), {kNone, kNone, kNone});
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (v[k] >= tin.points.size())
        throw BadInput(fmt::format("triangle {} names vertex {} of {}", t, v[k], tin.points.size()));
      if (v[k] == v[(k + 1) % 3]) throw BadInput(fmt::format("triangle {} names vertex {} twice", t, v[k]));
      const auto [place, fresh] =
          sides.emplace(directed(v[(k + 1) % 3], v[(k + 2) % 3]), t * 3 + static_cast<std::uint32_t>(k));
      if (!fresh)
        throw BadInput(
            fmt::format("triangles {} and {} run along the edge {}-{} in the same direction: the mesh is not a surface",
                        place->second / 3, t, v[(k + 1) % 3], v[(k + 2) % 3]));
    }
  }
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto twin = sides.find(directed(tin.triangles[t][(k + 2) % 3], tin.triangles[t][(k + 1) % 3]));
      if (twin != sides.end()) tin.neighbors[t][k] = twin->second / 3;
    }
}

}  // namespace retalho
