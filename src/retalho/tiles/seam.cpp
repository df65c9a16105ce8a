#include "retalho/tiles/seam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "retalho/terrain/gradients.h"

namespace retalho {
namespace {

/// A cell of the whole grid.
struct Cell {
  std::int64_t row = 0, column = 0;
  friend bool operator<(const Cell& a, const Cell& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; }
  std::uint64_t key() const { return (static_cast<std::uint64_t>(row) << 32) | static_cast<std::uint64_t>(column); }
};

/// A triangle at a border vertex, its smallest cell first.
struct Facet {
  std::uint32_t vertex = 0;
  std::array<Cell, 3> cells;
  std::array<double, 3> heights{};
};

Cell cell_of(const TiledIndex& frame, const PlacedTin& tile, std::uint32_t vertex) {
  const Vec2 p = tile.tin->points[vertex];
  return {tile.cells.row + std::llround(-p.y / frame.cell_height),
          tile.cells.column + std::llround(p.x / frame.cell_width)};
}

bool on_border(const CellWindow& w, const Cell& c) {
  return c.row == w.row || c.row == w.row + w.rows - 1 || c.column == w.column || c.column == w.column + w.columns - 1;
}

void collect(const TiledIndex& frame, const PlacedTin& from,
             const std::unordered_map<std::uint64_t, std::uint32_t>& border, std::vector<Facet>& facets) {
  for (const auto& t : from.tin->triangles) {
    const std::array<Cell, 3> cells{cell_of(frame, from, t[0]), cell_of(frame, from, t[1]), cell_of(frame, from, t[2])};
    const auto first = static_cast<std::size_t>(std::min_element(cells.begin(), cells.end()) - cells.begin());
    Facet facet;
    for (std::size_t k = 0; k < 3; ++k) {
      facet.cells[k] = cells[(first + k) % 3];
      facet.heights[k] = from.tin->heights[t[(first + k) % 3]];
    }
    for (const Cell& cell : cells)
      if (const auto found = border.find(cell.key()); found != border.end()) {
        facet.vertex = found->second;
        facets.push_back(facet);
      }
  }
}

Vec3 normal_of(const TiledIndex& frame, const Facet& f) {
  const auto edge = [&](std::size_t k) {
    return Vec3{static_cast<double>(f.cells[k].column - f.cells[0].column) * frame.cell_width,
                -static_cast<double>(f.cells[k].row - f.cells[0].row) * frame.cell_height, f.heights[k] - f.heights[0]};
  };
  return cross(edge(1), edge(2));
}

}  // namespace

std::vector<Vec2> seam_gradients(const TiledIndex& frame, const PlacedTin& tile, std::span<const PlacedTin> neighbors,
                                 const Context& context) {
  std::vector<Vec2> gradients = estimate_gradients(*tile.tin, build_edges(*tile.tin), GradientKind::normals, context);
  std::unordered_map<std::uint64_t, std::uint32_t> border;
  for (std::uint32_t v = 0; v < gradients.size(); ++v)
    if (const Cell cell = cell_of(frame, tile, v); on_border(tile.cells, cell)) border.emplace(cell.key(), v);
  std::vector<Facet> facets;
  collect(frame, tile, border, facets);
  for (const PlacedTin& neighbor : neighbors) collect(frame, neighbor, border, facets);
  std::sort(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.cells < b.cells;
  });
  for (std::size_t begin = 0, end = 0; begin < facets.size(); begin = end) {
    Vec3 sum;
    for (end = begin; end < facets.size() && facets[end].vertex == facets[begin].vertex; ++end)
      sum = sum + normal_of(frame, facets[end]);
    if (sum.z > 0) gradients[facets[begin].vertex] = {-sum.x / sum.z, -sum.y / sum.z};
  }
  return gradients;
}

}  // namespace retalho
