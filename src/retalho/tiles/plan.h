// How a grid is cut into tiles, and what its tiles are called.
//
// A name holds a digest of the parameters and of all heights that the tile depends on: the same name is the same
// content, so that a run which was stopped goes on where it was.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/model/tiled.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/surface_refine.h"

namespace retalho {

struct TileOptions {
  int size = 1024;           ///< cells from seam to seam, 16 to 16,384
  double max_error = 0;      ///< height units, 0 or more: of the flat triangulation at every valid cell
  std::size_t vertices = 0;  ///< instead of max_error: the tolerance that spends at most so many; 0: none
  double ratio = 0;          ///< instead of max_error: vertices as a share of the valid cells, in (0, 1]; 0: none
  SurfaceKind surface = SurfaceKind::clough_tocher;
  bool fitted = false;  ///< heights and gradients fitted to every cell (least_squares.h); else interpolated, with the
                        ///< gradients of the triangles' normals
  /// The vertices inside a tile by the surface's own error (surface_refine.h), as many as the flat triangulation to the
  /// budget's tolerance has; those on seams are the latter's. Needs fitted, a budget, and no Powell-Sabin surface.
  std::optional<Effort> refine = {};
};

struct TilePlan {
  std::string source;  ///< as read_raster takes it
  ReadOptions read;
  TiledIndex frame;  ///< without tiles
  double ratio = 0;  ///< over 0: frame.budget is still to be counted from it

  /// Is a budget given whose tolerance is not known yet? settle() finds it; nothing can be made before.
  bool open() const { return ratio > 0 || (frame.budget > 0 && frame.max_error == 0); }
};

/// Reads where the grid lies, no heights. Throws UsageError (options), CannotRead, BadInput (a grid of less than 2 x 2
/// cells; formats without windows).
TilePlan plan_tiles(const std::string& source, const TileOptions& options, const ReadOptions& read = {});

/// Are there three valid cells that are not on one line?
bool has_area(const Raster& raster);

/// What a budget is settled by.
struct TileLook {
  bool area = false;      ///< does the tile hold an area with data?
  std::size_t valid = 0;  ///< valid cells; those on a seam are the northern or western tile's
  double low = 0, high = 0;
};
TileLook look_at_tile(const TilePlan& plan, int tile_row, int tile_column, const Context& context = {});

/// Vertices of a tile's triangulation to `max_error`, of which those on seams count in one tile only: the first in
/// row by row order that has an area. `area` says that of the nine tiles around it, row by row. Cost: refine_grid's.
std::size_t count_vertices(const TilePlan& plan, int tile_row, int tile_column, double max_error,
                           const std::array<bool, 9>& area, const Context& context = {});
std::array<bool, 9> areas_around(const TiledIndex& frame, const std::vector<TileLook>& looks, int tile_row,
                                 int tile_column);

/// The plan with the tolerance that spends its budget: at most frame.budget vertices, and at least 98 % of it unless
/// every cell is a vertex before, or steps of the count are larger. `looks`: of all tiles, row by row;
/// `count(max_error)`: the sum of count_vertices over all tiles, asked 5 to 24 times. A greedy budget ends at a
/// tolerance as well; so the vertices on a seam still depend on the seam alone. Throws UsageError where the corners and
/// hulls of the tiles alone are more vertices than that.
TilePlan settle(TilePlan plan, const std::vector<TileLook>& looks,
                const std::function<std::size_t(double max_error)>& count);

/// The heights of one tile, seams included, with its place. Memory: 4 (or 8) bytes a cell of the tile.
Raster read_tile(const TilePlan& plan, int tile_row, int tile_column, const Context& context = {});

/// Name of the file with the tile's triangulation; empty: the tile holds no area with data. Reads the tile's heights.
std::string tin_name(const TilePlan& plan, int tile_row, int tile_column, const Context& context = {});

/// The names of the triangulations of a tile and its eight neighbours, row by row; empty where there is none.
using NeighborNames = std::array<std::string, 9>;

/// Name of the file with the tile's surface.
std::string tile_name(const TilePlan& plan, int tile_row, int tile_column, const NeighborNames& tins);

}  // namespace retalho
