#include "retalho/tin/cell_delaunay.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {
namespace {

using greedy::area2;
using greedy::Cell;

/// Corners of the convex hull, as CellMesh wants its outline. `cells` ascending.
std::vector<Cell> hull_of(const std::vector<Cell>& cells) {
  std::vector<Cell> hull;
  const auto run = [&](auto begin, auto end) {
    const std::size_t start = hull.size();
    for (auto it = begin; it != end; ++it) {
      while (hull.size() >= start + 2 && area2(hull[hull.size() - 2], hull.back(), *it) <= 0) hull.pop_back();
      hull.push_back(*it);
    }
    hull.pop_back();
  };
  run(cells.begin(), cells.end());
  run(cells.rbegin(), cells.rend());
  if (hull.size() < 3) throw BadInput("the vertices lie on one line");
  return hull;
}

/// The bits of a cell's column and row in turns: cells near in this order are near.
std::uint32_t interleaved(Cell c) {
  std::uint32_t result = 0;
  for (std::uint32_t k = 0; k < 16; ++k) result |= (c >> k & 1U) << (2 * k) | (c >> (16 + k) & 1U) << (2 * k + 1);
  return result;
}

/// Rounds of growing size, each in an order that runs from neighbour to neighbour: fast to insert.
void sort_for_insertion(std::vector<std::uint32_t>& list, std::span<const Cell> cells) {
  const auto key = [&](std::uint32_t v) {
    const std::uint32_t mixed = v * 2654435761U;
    return std::pair<int, std::uint32_t>(-std::countr_zero(mixed >> 12 | 1U << 16), interleaved(cells[v]));
  };
  std::sort(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
}

}  // namespace

CellTriangulation triangulate_cells(std::span<const Cell> cells, std::vector<std::uint32_t> chosen) {
  std::vector<Cell> places;
  places.reserve(chosen.size());
  for (const std::uint32_t v : chosen) places.push_back(cells[v]);
  const std::vector<Cell> hull = hull_of(places);
  CellTriangulation level{CellMesh(hull), {}, std::vector<std::uint32_t>(cells.size(), kNone)};
  const auto name = [&](std::uint32_t v) {
    level.number[v] = static_cast<std::uint32_t>(level.vertex.size());
    level.vertex.push_back(v);
  };
  for (std::uint32_t k = 0; k < hull.size(); ++k)
    name(static_cast<std::uint32_t>(std::lower_bound(cells.begin(), cells.end(), level.mesh.cell(k)) - cells.begin()));
  sort_for_insertion(chosen, cells);
  std::uint32_t near = 0;
  for (const std::uint32_t v : chosen) {
    if (level.number[v] != kNone) continue;
    const std::uint32_t made = level.mesh.insert(cells[v], near);
    if (made == kNone) throw BadInput("two vertices lie in one cell");
    near = level.mesh.triangle_at(made);
    name(v);
  }
  level.mesh.clear_changed();
  return level;
}

CellTriangulation triangulate_cells(std::span<const Cell> cells) {
  std::vector<std::uint32_t> all(cells.size());
  std::iota(all.begin(), all.end(), 0U);
  return triangulate_cells(cells, std::move(all));
}

}  // namespace retalho
