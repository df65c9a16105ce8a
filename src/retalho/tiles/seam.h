// Gradients at the vertices of a tile's border, which its neighbours share: from the triangles on both sides.
#pragma once

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

/// GradientKind::normals of all vertices of `tile`: inside as estimate_gradients gives them, on the border of the
/// tile's cells with the triangles of `neighbors` as well. There the sum is over triangles in the order of their cells
/// and from whole numbers of cells, so that every tile which has the vertex gets the same bits.
std::vector<Vec2> seam_gradients(const TiledIndex& frame, const PlacedTin& tile, std::span<const PlacedTin> neighbors,
                                 const Context& context = {});

}  // namespace retalho
