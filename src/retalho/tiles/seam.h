// What a tile's border needs of its neighbours: gradients at its vertices and splits of its edges, from the triangles
// on both sides.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/model/tiled.h"

namespace retalho {

/// A tile's triangulation and where it lies.
struct PlacedTin {
  CellWindow cells;
  const Tin* tin = nullptr;
};

/// A cell of the whole grid.
struct GridCell {
  std::int64_t row = 0, column = 0;
  friend bool operator==(const GridCell&, const GridCell&) = default;
  friend bool operator<(const GridCell& a, const GridCell& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  }
  std::uint64_t key() const { return (static_cast<std::uint64_t>(row) << 32) | static_cast<std::uint64_t>(column); }
};
GridCell cell_of(const TiledIndex& frame, const PlacedTin& tile, std::uint32_t vertex);

/// GradientKind::normals of all vertices of `tile`: inside as estimate_gradients gives them, on the border of the
/// tile's cells with the triangles of `neighbors` as well. There the sum is over triangles in the order of their cells
/// and from whole numbers of cells, so that every tile which has the vertex gets the same bits.
std::vector<Vec2> seam_gradients(const TiledIndex& frame, const PlacedTin& tile, std::span<const PlacedTin> neighbors,
                                 const Context& context = {});

/// powell_sabin_splits of `tile`, by build_edges' order; edges on the tile's border that a neighbour has as well are
/// split by the triangles on both sides, from whole numbers of cells, so that both tiles get the same bits. Vertices
/// must be in raster order.
std::vector<double> seam_splits(const TiledIndex& frame, const PlacedTin& tile, std::span<const PlacedTin> neighbors,
                                const Context& context = {});

}  // namespace retalho
