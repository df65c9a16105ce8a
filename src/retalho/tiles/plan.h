// How a grid is cut into tiles, and what its tiles are called.
//
// A name holds a digest of the parameters and of all heights that the tile depends on: the same name is the same
// content, so that a run which was stopped goes on where it was.
#pragma once

#include <array>
#include <string>

#include "retalho/core/context.h"
#include "retalho/model/tiled.h"
#include "retalho/raster/io.h"

namespace retalho {

struct TileOptions {
  int size = 1024;       ///< cells from seam to seam, 16 to 16,384
  double max_error = 0;  ///< height units, 0 or more: of the flat triangulation at every valid cell
  SurfaceKind surface = SurfaceKind::clough_tocher;  ///< or linear; gradients are those of the triangles' normals
};

struct TilePlan {
  std::string source;  ///< as read_raster takes it
  ReadOptions read;
  TiledIndex frame;  ///< without tiles
};

/// Reads where the grid lies, no heights. Throws UsageError (options; Powell-Sabin surfaces, whose pieces at a seam
/// would depend on both tiles), CannotRead, BadInput (a grid of less than 2 x 2 cells; formats without windows).
TilePlan plan_tiles(const std::string& source, const TileOptions& options, const ReadOptions& read = {});

/// The heights of one tile, seams included, with its place. Memory: 4 (or 8) bytes a cell of the tile.
Raster read_tile(const TilePlan& plan, int tile_row, int tile_column, const Context& context = {});

/// Name of the file with the tile's triangulation; empty: the tile holds no area with data. Reads the tile's heights.
std::string tin_name(const TilePlan& plan, int tile_row, int tile_column, const Context& context = {});

/// The names of the triangulations of a tile and its eight neighbours, row by row; empty where there is none.
using NeighborNames = std::array<std::string, 9>;

/// Name of the file with the tile's surface.
std::string tile_name(const TilePlan& plan, int tile_row, int tile_column, const NeighborNames& tins);

}  // namespace retalho
