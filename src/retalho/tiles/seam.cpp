#include "retalho/tiles/seam.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

#include "retalho/terrain/gradients.h"
#include "retalho/terrain/powell_sabin.h"

namespace retalho {
namespace {

/// A triangle at a border vertex, its smallest cell first.
struct Facet {
  std::uint32_t vertex = 0;
  std::array<GridCell, 3> cells;
  std::array<double, 3> heights{};
};

bool on_border(const CellWindow& w, const GridCell& c) {
  return c.row == w.row || c.row == w.row + w.rows - 1 || c.column == w.column || c.column == w.column + w.columns - 1;
}

void collect(const TiledIndex& frame, const PlacedTin& from,
             const std::unordered_map<std::uint64_t, std::uint32_t>& border, std::vector<Facet>& facets) {
  for (const auto& t : from.tin->triangles) {
    const std::array<GridCell, 3> cells{cell_of(frame, from, t[0]), cell_of(frame, from, t[1]),
                                        cell_of(frame, from, t[2])};
    const auto first = static_cast<std::size_t>(std::min_element(cells.begin(), cells.end()) - cells.begin());
    Facet facet;
    for (std::size_t k = 0; k < 3; ++k) {
      facet.cells[k] = cells[(first + k) % 3];
      facet.heights[k] = from.tin->heights[t[(first + k) % 3]];
    }
    for (const GridCell& cell : cells)
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

/// The cells of an edge, the first in raster order first.
using EdgeCells = std::pair<std::uint64_t, std::uint64_t>;
EdgeCells edge_key(const GridCell& a, const GridCell& b) {
  return std::minmax(a.key(), b.key());
}

/// From `a`, in local units.
Vec2 place_from(const TiledIndex& frame, const GridCell& a, const GridCell& p) {
  return {static_cast<double>(p.column - a.column) * frame.cell_width,
          -static_cast<double>(p.row - a.row) * frame.cell_height};
}

}  // namespace

GridCell cell_of(const TiledIndex& frame, const PlacedTin& tile, std::uint32_t vertex) {
  const Vec2 p = tile.tin->points[vertex];
  return {tile.cells.row + std::llround(-p.y / frame.cell_height),
          tile.cells.column + std::llround(p.x / frame.cell_width)};
}

std::vector<Vec2> seam_gradients(const TiledIndex& frame, const PlacedTin& tile, std::span<const PlacedTin> neighbors,
                                 const Context& context) {
  std::vector<Vec2> gradients = estimate_gradients(*tile.tin, build_edges(*tile.tin), GradientKind::normals, context);
  std::unordered_map<std::uint64_t, std::uint32_t> border;
  for (std::uint32_t v = 0; v < gradients.size(); ++v)
    if (const GridCell cell = cell_of(frame, tile, v); on_border(tile.cells, cell)) border.emplace(cell.key(), v);
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

std::vector<double> seam_splits(const TiledIndex& frame, const PlacedTin& tile, std::span<const PlacedTin> neighbors,
                                const Context& context) {
  const Tin& tin = *tile.tin;
  const EdgeTable edges = build_edges(tin);
  std::vector<double> splits = powell_sabin_splits(tin, edges, context);
  struct Side {
    std::size_t edge;
    GridCell low, high, apex;
  };
  std::map<EdgeCells, Side> open;  // the border's edges
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    if (edges.triangles[e][1] != kNone) continue;
    const auto [a, b] = edges.vertices[e];
    Side side{e, cell_of(frame, tile, a), cell_of(frame, tile, b), {}};
    if (!on_border(tile.cells, side.low) || !on_border(tile.cells, side.high)) continue;
    for (const std::uint32_t v : tin.triangles[edges.triangles[e][0]])
      if (v != a && v != b) side.apex = cell_of(frame, tile, v);
    open.emplace(edge_key(side.low, side.high), side);
  }
  for (const PlacedTin& neighbor : neighbors)
    for (const auto& t : neighbor.tin->triangles) {
      const std::array<GridCell, 3> cells{cell_of(frame, neighbor, t[0]), cell_of(frame, neighbor, t[1]),
                                          cell_of(frame, neighbor, t[2])};
      for (std::size_t k = 0; k < 3; ++k) {
        const auto found = open.find(edge_key(cells[(k + 1) % 3], cells[(k + 2) % 3]));
        if (found == open.end()) continue;
        const Side& side = found->second;
        const auto [first, second] = std::minmax(side.apex, cells[k]);
        splits[side.edge] = powell_sabin_split({0, 0}, place_from(frame, side.low, side.high),
                                               place_from(frame, side.low, first), place_from(frame, side.low, second));
      }
    }
  return splits;
}

}  // namespace retalho
