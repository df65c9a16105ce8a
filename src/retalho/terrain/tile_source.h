// A surface that comes tile by tile, for work that never holds all of it.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "retalho/core/context.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// A tile in coordinates of the whole: its terrain's points are the whole's. The terrain's grid is of its own cells,
/// and knows nothing of where they lie.
struct PlacedTile {
  Terrain terrain;
  int first_column = 0, first_row = 0;  ///< of its cells in the whole grid

  /// GridDomain::has_data at a place of the whole.
  bool has_data(Vec2 p) const;
};

/// Tiles lie in rows and columns; neighbours share the vertices of their seam, with the same bits of place, height and
/// gradient, and the same splits of its edges.
struct TileSource {
  int tile_rows = 0, tile_columns = 0;
  int columns = 0, rows = 0;  ///< cells of the whole grid
  Georef georef;
  double cell_width = 1, cell_height = 1;  ///< local units
  std::size_t at_once = 1;                 ///< how many tiles may be held at a time
  /// The tile, vertices by row and column of their cells; nullopt: it holds no data. Safe to call from several threads
  /// at once.
  std::function<std::optional<PlacedTile>(int row, int column)> load;

  std::size_t tiles() const { return static_cast<std::size_t>(tile_rows) * static_cast<std::size_t>(tile_columns); }
};

/// The box of all vertices, in coordinates of the whole.
struct VertexBox {
  Vec3 low, high;
  bool data = false;  ///< is there any vertex?
};

/// Where a tile lies, and beyond which of its sides there is another one.
struct TilePlace {
  int row = 0, column = 0;
  bool north = false, west = false, south = false, east = false;
};

/// Reads every tile once: make(tile, place, slot, inside) for several of them at once, as many as `at_once` allows, and
/// take(place, slot) in the calling thread, row by row, each after its make; both also for tiles without data (null).
/// `slot` < tile_slots() is where make leaves what take reads. `inside`: the context of work on one tile, which has all
/// threads where only one tile is worked on. Reports `stage`.
void each_tile(const TileSource& source, const char* stage, const Context& context,
               const std::function<void(const PlacedTile* tile, const TilePlace& place, std::size_t slot,
                                        const Context& inside)>& make,
               const std::function<void(const TilePlace& place, std::size_t slot)>& take);
std::size_t tile_slots(const TileSource& source, const Context& context);

/// Reads every tile once.
VertexBox vertex_box(const TileSource& source, const Context& context = {});

}  // namespace retalho
