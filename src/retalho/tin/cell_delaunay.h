// The Delaunay triangulation of a set of cells, from scratch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retalho/tin/cell_mesh.h"

namespace retalho {

struct CellTriangulation {
  CellMesh mesh;
  std::vector<std::uint32_t> vertex;  ///< of each vertex of `mesh`: its place among the cells given
  std::vector<std::uint32_t> number;  ///< the inverse; kNone: not chosen
};

/// The canonical triangulation (CellMesh) of cells[chosen[k]]; its outline is their convex hull. Both lists ascending.
/// Throws BadInput where they lie on one line or two are the same. Cost: about 2 us a vertex.
CellTriangulation triangulate_cells(std::span<const greedy::Cell> cells, std::vector<std::uint32_t> chosen);
/// Of all of them.
CellTriangulation triangulate_cells(std::span<const greedy::Cell> cells);

}  // namespace retalho
