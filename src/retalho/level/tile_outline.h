// Internal to level/: the border of a triangulation that comes tile by tile.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "retalho/level/bands.h"
#include "retalho/raster/mask.h"
#include "retalho/terrain/tile_source.h"

namespace retalho {

/// What a tile leaves of its own border: pieces whose nodes are cells of the whole grid, and whose roots count from 0.
struct TileOutline {
  std::vector<DirectedBorder> pieces;
  std::vector<Vec2> root_places;
  std::unordered_map<std::uint32_t, std::uint32_t> root_of;  ///< by point of the tile's trace
  GridDomain grid;
  int first_column = 0, first_row = 0;
  bool data = false;
};
TileOutline tile_outline(const PlacedTile& placed, const EdgeTable& edges, double per_unit, const FixedLevels& levels,
                         const OuterRoots& outer, const Trace& trace);

/// The tiles' borders put together: what two of them have, one in each direction, is inside of the whole.
class JoinedOutline {
 public:
  explicit JoinedOutline(const TileSource& tiles);

  /// The next tile. What its root is called in the whole is first_root() before the call and its number.
  void add(TileOutline&& outline);
  std::uint32_t first_root() const { return static_cast<std::uint32_t>(root_places_.size()); }

  /// When all tiles have been added: the border, its nodes numbered from 0.
  std::vector<DirectedBorder> take();
  const std::vector<Vec2>& root_places() const { return root_places_; }
  /// The whole grid, with the cells that a tile has data in.
  const GridDomain& grid() const { return grid_; }

 private:
  struct EdgeHash {
    std::size_t operator()(const std::pair<std::uint64_t, std::uint64_t>& e) const {
      return static_cast<std::size_t>((e.first * 0x9e3779b97f4a7c15ULL) ^ (e.second * 0xff51afd7ed558ccdULL));
    }
  };
  GridDomain grid_;
  std::vector<Vec2> root_places_;
  std::vector<DirectedBorder> pieces_;
  std::vector<std::uint8_t> inside_;  ///< of each piece: it has met its like
  std::unordered_map<std::pair<std::uint64_t, std::uint64_t>, std::size_t, EdgeHash> alone_;
};

/// Is a place within a border? Cost: O(pieces) to make; a search looks at the pieces of one horizontal slice.
class OutlineArea {
 public:
  explicit OutlineArea(const std::vector<DirectedBorder>& border);
  bool holds(Vec2 p) const;

 private:
  struct Edge {
    Vec2 from, to;
  };
  std::size_t slice(double y) const;
  double low_ = 0, per_slice_ = 0;
  std::vector<std::vector<Edge>> slices_;
};

}  // namespace retalho
