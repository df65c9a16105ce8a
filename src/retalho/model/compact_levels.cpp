#include "retalho/model/compact_levels.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

namespace retalho {
namespace {

using greedy::area2;
using greedy::Cell;

constexpr std::size_t kCoarsest = 8;

}  // namespace

std::vector<CellLevel> make_levels(std::span<const Cell> cells, const Context& context) {
  std::vector<CellLevel> levels;
  std::vector<std::uint32_t> current(cells.size());
  std::iota(current.begin(), current.end(), 0U);
  while (true) {
    context.check();
    CellLevel level{triangulate_cells(cells, current), {}};
    const CellMesh& mesh = level.mesh;
    const std::size_t n = mesh.vertex_count();
    std::vector<std::uint8_t> blocked(n, 0);
    std::vector<std::uint32_t> degree(n, 0), order;
    for (const auto& t : mesh.triangles())
      for (const std::uint32_t v : t) ++degree[v];
    CellMesh::Star star;
    for (const std::uint32_t v : current) {
      const std::uint32_t k = level.number[v];
      mesh.star(k, star);
      const auto at = [&](std::uint32_t w) { return mesh.cell(w); };
      if (star.closed || area2(at(star.ring.front()), at(k), at(star.ring.back())) == 0) order.push_back(v);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return degree[level.number[a]] < degree[level.number[b]];
    });
    const bool last = current.size() <= kCoarsest || order.empty();
    if (last) {
      level.fresh = current;
    } else {
      for (const std::uint32_t v : order) {
        const std::uint32_t k = level.number[v];
        if (blocked[k] != 0) continue;
        mesh.star(k, star);
        for (const std::uint32_t w : star.ring) blocked[w] = 1;
        level.fresh.push_back(v);
      }
      std::sort(level.fresh.begin(), level.fresh.end());
      std::vector<std::uint32_t> rest;
      std::set_difference(current.begin(), current.end(), level.fresh.begin(), level.fresh.end(),
                          std::back_inserter(rest));
      current = std::move(rest);
    }
    levels.push_back(std::move(level));
    if (last) break;
  }
  std::reverse(levels.begin(), levels.end());
  return levels;
}

}  // namespace retalho
