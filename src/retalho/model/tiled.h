// A tiled model: a folder with one model file a tile and an index, for grids that do not fit into memory
// (docs/tiles.md). Whoever takes a model file takes such a folder.
//
// Tiles overlap by one row or column of cells, the seam. Neighbours have the same vertices there, the same heights and
// the same gradients, to the last bit, so that their surfaces join as smoothly as the pieces of one tile do.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "retalho/raster/window.h"
#include "retalho/terrain/terrain.h"
#include "retalho/terrain/tile_source.h"

namespace retalho {

struct TileEntry {
  int row = 0, column = 0;  ///< of the tile
  CellWindow cells;
  std::string file;  ///< its name in the folder; empty: the tile holds no area with data
  std::string checksum;
  std::size_t bytes = 0, vertices = 0, triangles = 0;
};

/// What index.json holds.
struct TiledIndex {
  int columns = 0, rows = 0;  ///< of the whole grid
  double cell_width = 1, cell_height = 1;
  Georef georef;
  int tile_size = 0;  ///< cells from seam to seam
  SurfaceKind surface = SurfaceKind::clough_tocher;
  double max_error = 0;          ///< of the flat triangulation at every valid cell
  bool fitted = false;           ///< heights and gradients by least squares (else interpolated)
  std::string effort;            ///< refined by the surface's own error within the tiles, with this effort; empty: by
                                 ///< the flat triangulation's
  std::size_t budget = 0;        ///< the vertices that were asked for, of which max_error follows; 0: none
  std::vector<TileEntry> tiles;  ///< row by row

  int tile_columns() const { return (columns - 2) / tile_size + 1; }
  int tile_rows() const { return (rows - 2) / tile_size + 1; }
  std::size_t tile_count() const {
    return static_cast<std::size_t>(tile_columns()) * static_cast<std::size_t>(tile_rows());
  }
  CellWindow window(int tile_row, int tile_column) const;
};

inline constexpr const char* kTiledIndexName = "index.json";

/// 32 hexadecimal digits that tell contents apart (XXH3, 128 bits).
std::string content_digest(std::string_view bytes);

/// Is it a folder with an index?
bool is_tiled_model(const std::string& path);

/// The text of index.json.
std::string index_text(const TiledIndex& index);
/// The index in a text. Throws CannotRead with what is wrong in it; `file` is its name in messages.
TiledIndex parse_index(std::string_view json, const std::string& file = {});
/// The same of a text without tiles: a plan's frame.
TiledIndex parse_frame(std::string_view json, const std::string& file = {});

/// Atomic. Throws CannotWrite.
void write_tiled_index(const TiledIndex& index, const std::string& folder, bool overwrite);
/// Throws CannotRead: missing, not an index of this version, tiles that do not make up the grid.
TiledIndex read_tiled_index(const std::string& folder);

/// One tile, in coordinates of its own. Throws CannotRead: missing, or not the file that the index speaks of.
Terrain load_tile(const TiledIndex& index, const TileEntry& entry, const std::string& folder);

/// The same in coordinates of the whole, with the very points that load_tiled_model gives it; its grid is that of its
/// own cells.
PlacedTile load_placed_tile(const TiledIndex& index, const TileEntry& entry, const std::string& folder);

/// All tiles as one terrain on the whole grid, vertices by row and column of their cells, triangles tile by tile.
/// Throws CannotRead, also where tiles disagree along a seam. Memory: that of the model (about 150 bytes a vertex), and
/// one bit a cell where the grid has voids.
Terrain load_tiled_model(const std::string& folder);

/// The tiles for which `wanted` is true, as one terrain on the smallest part of the grid that holds them, with the
/// origin in that part's north-western cell; the other tiles of that part hold no data. Throws CannotRead, also
/// where none of them has data, and BadInput where none is wanted. Memory: as load_tiled_model's, for those tiles.
Terrain load_tiled_part(const std::string& folder, const std::function<bool(const TileEntry& tile)>& wanted);

/// Size of a model file, or of all tiles of a tiled model. Throws CannotRead.
std::size_t model_size(const std::string& path);

}  // namespace retalho
