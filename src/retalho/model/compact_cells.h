// Sets of cells of a grid as few bits: the vertices of a compact model, and the mask of its valid cells.
// Internal to the room.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/model/bit_coder.h"
#include "retalho/raster/mask.h"
#include "retalho/tin/cell_delaunay.h"

namespace retalho {

/// Codes which `count` cells of a grid are vertices (reading: `cells` is ignored), row by row, each bit by how many
/// vertices lie near it and how far the nearest one is, beside the chance that the bare count gives. Returns the cells
/// in raster order; when reading, as many as the bits say, at most `count`. Cost: about 0.15 us a cell of the grid.
std::vector<greedy::Cell> code_vertices(BitCoder& coder, int columns, int rows, std::size_t count,
                                        const std::vector<greedy::Cell>& cells);

/// Codes which vertices are folded, in ascending order, each by its neighbours that are known and by how crowded it
/// lies. `folded` when writing, one a vertex. Cost: about 1 us a vertex.
std::vector<std::uint8_t> code_folds(BitCoder& coder, const CellTriangulation& finest,
                                     const std::vector<std::uint8_t>& folded);

/// Codes a mask of the grid by the ten bits before and above each. Cost: about 20 ns a cell.
Mask code_mask(BitCoder& coder, int columns, int rows, const Mask& mask);

}  // namespace retalho
