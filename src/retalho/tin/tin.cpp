#include "retalho/tin/tin.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {
namespace {

/// The side of a triangle opposite its corner `place % 3`, in the list of the vertex that it starts from.
struct OutgoingSide {
  std::uint32_t to, place;
  friend bool operator<(const OutgoingSide& a, const OutgoingSide& b) {
    return a.to != b.to ? a.to < b.to : a.place < b.place;
  }
};

void check_corners(const Tin& tin) {
  for (std::size_t t = 0; t < tin.triangles.size(); ++t) {
    const auto& v = tin.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (v[k] >= tin.points.size())
        throw BadInput(fmt::format("triangle {} names vertex {} of {}", t, v[k], tin.points.size()));
      if (v[k] == v[(k + 1) % 3]) throw BadInput(fmt::format("triangle {} names vertex {} twice", t, v[k]));
    }
  }
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
  if (tin.triangles.size() >= kNone / 3)
    throw BadInput(fmt::format("{} triangles are more than 32 bits can number", tin.triangles.size()));
  check_corners(tin);
  // Sides sorted by their two ends: counted into lists of the vertex they start from, then each short list by itself.
  std::vector<std::uint32_t> start(tin.points.size() + 1, 0);
  for (const auto& v : tin.triangles)
    for (const std::uint32_t k : v) ++start[k + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<OutgoingSide> sides(tin.triangles.size() * 3);
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = tin.triangles[t][(k + 1) % 3], to = tin.triangles[t][(k + 2) % 3];
      sides[next[from]++] = {to, 3 * t + k};
    }
  const auto list = [&](std::uint32_t vertex) {
    return std::pair(sides.begin() + start[vertex], sides.begin() + start[vertex + 1]);
  };
  for (std::uint32_t v = 0; v < tin.points.size(); ++v) {
    const auto [begin, end] = list(v);
    std::sort(begin, end);
    const auto twice =
        std::adjacent_find(begin, end, [](const OutgoingSide& a, const OutgoingSide& b) { return a.to == b.to; });
    if (twice != end)
      throw BadInput(
          fmt::format("triangles {} and {} run along the edge {}-{} in the same direction: the mesh is not a surface",
                      twice->place / 3, (twice + 1)->place / 3, v, twice->to));
  }
  tin.neighbors.assign(tin.triangles.size(), {kNone, kNone, kNone});
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = tin.triangles[t][(k + 1) % 3], to = tin.triangles[t][(k + 2) % 3];
      const auto [begin, end] = list(to);
      const auto twin = std::lower_bound(begin, end, OutgoingSide{from, 0});
      if (twin != end && twin->to == from) tin.neighbors[t][k] = twin->place / 3;
    }
}

}  // namespace retalho
