// Making the tiles of a plan, one task at a time (for a scheduler) or all of them in this process.
//
// Two rounds: a triangulation a tile, which needs the tile's heights alone, and a surface a tile, which needs the
// triangulations of the tile and its neighbours. Files are complete or absent; one that is there already, whole, is not
// made again. Any number of processes may work on one folder.
#pragma once

#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tiles/plan.h"

namespace retalho {

/// For use before any work: throws CannotWrite where the folder holds the index of another grid or of other parameters
/// and `overwrite` is false.
void check_tiles_folder(const TilePlan& plan, const std::string& folder, bool overwrite);

/// Makes the triangulation `name` (tin_name) in `folder`. Memory: refine_grid's, for the tile.
void make_tin(const TilePlan& plan, int tile_row, int tile_column, const std::string& name, const std::string& folder,
              const Context& context = {});

/// Makes the surface of a tile from the triangulations in `folder`; its entry for the index. Memory: nine
/// triangulations, and for fitted surfaces fit_least_squares' for the largest strip (tiles/strips.h).
TileEntry make_tile(const TilePlan& plan, int tile_row, int tile_column, const NeighborNames& tins,
                    const std::string& folder, const Context& context = {});

/// The names round a tile, out of those of all tiles (row by row).
NeighborNames names_around(const TiledIndex& frame, const std::vector<std::string>& tins, int tile_row,
                           int tile_column);

/// The tiles whose surface is not in `folder`, by their places in the row by row order.
std::vector<std::size_t> missing_tiles(const TilePlan& plan, const std::vector<std::string>& tins,
                                       const std::string& folder);
/// The triangulations that those need and that are not in `folder`.
std::vector<std::size_t> missing_tins(const TilePlan& plan, const std::vector<std::string>& tins,
                                      const std::vector<std::size_t>& tiles, const std::string& folder);

/// Writes the index of all tiles (unless this very index is there) and removes the triangulations, which nobody needs
/// any more. Throws CannotWrite where another index is there and `overwrite` is false.
TiledIndex finish_tiles(const TilePlan& plan, std::vector<TileEntry> entries, const std::vector<std::string>& tins,
                        const std::string& folder, bool overwrite);

/// The plan with its budget settled (tiles/plan.h), `jobs` tiles at a time; as it is where none is open.
TilePlan settle_here(const TilePlan& plan, int jobs, const Context& context = {});

/// All of it, `jobs` tiles at a time (0: as many as there are threads), each then on one thread. The bytes do not
/// depend on `jobs`, nor on what was there before. The folder is made if it is missing; one with the index of another
/// grid or other parameters is refused (CannotWrite) unless `overwrite`. Memory: `jobs` times a tile's.
TiledIndex make_tiles(const TilePlan& plan, const std::string& folder, int jobs, bool overwrite,
                      const Context& context = {});

}  // namespace retalho
