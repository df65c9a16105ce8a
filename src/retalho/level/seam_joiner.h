// Internal to level/: pieces of lines that tiles leave, put together across their seams.
//
// Tiles come row by row. A root on a seam is known by its edge and its place in the edge's list: both tiles find the
// same list there, as the edge's ordinates have the same bits in both.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "retalho/level/line_chains.h"
#include "retalho/level/raw_lines.h"
#include "retalho/level/trace_terrain.h"
#include "retalho/terrain/tile_source.h"

namespace retalho {

enum class TileSide : std::uint8_t { north, west, south, east };

/// A root on a seam.
struct SeamRoot {
  std::uint32_t point;  ///< of the tile's trace
  TileSide side;
  std::uint64_t cell;   ///< of the edge's first vertex: row and column in the whole grid
  std::uint32_t place;  ///< half and number in its list
};
/// Those of a tile, by point. `open`: the sides, in TileSide's order, beyond which there is another tile.
std::vector<SeamRoot> seam_roots(const PlacedTile& tile, const EdgeTable& edges, const OuterRoots& outer,
                                 const std::array<bool, 4>& open);

class SeamJoiner {
 public:
  explicit SeamJoiner(int tile_columns);
  /// Takes the pieces of the next tile, row by row; none of a tile without data. Leaves in `lines` those that go on
  /// nowhere, whole, by level, then in the order in which they were begun. `name`: what the ends of open lines are to
  /// be called, by point of the tile's trace; without it they are called by their lines.
  using EndName = std::function<std::uint32_t(std::uint32_t point)>;
  void add(RawLines& lines, const std::vector<SeamRoot>& roots, int column, const EndName& name = {});

 private:
  struct Name {
    std::uint64_t cell;
    std::uint32_t place;
    friend bool operator==(const Name&, const Name&) = default;
  };
  struct Hash {
    std::size_t operator()(const Name& n) const {
      return static_cast<std::size_t>((n.cell * 0x9e3779b97f4a7c15ULL) ^ (n.place * 0xff51afd7ed558ccdULL));
    }
  };
  /// The roots of a seam where a line of the first of its two tiles waits.
  using Seam = std::unordered_map<Name, LineChains::Place, Hash>;

  LineChains::Place place_of(std::uint32_t point, const std::vector<SeamRoot>& roots);

  std::vector<Seam> south_;  ///< of each column of tiles, the seam below its last tile
  Seam east_, north_, west_;
  LineChains chains_;
  LineChains::Place next_place_ = 0;
  std::uint32_t next_line_ = 0;
  int column_ = 0;
};

}  // namespace retalho
