// A tiled model that is too large to be joined, for the page: a picture of all of it is held coarsely, and what is near
// is sampled from its tiles.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "detail.h"
#include "retalho/core/context.h"
#include "retalho/level/tile_lines.h"
#include "retalho/mesh/mesh.h"
#include "retalho/tiles/source.h"

namespace retalho::viewer {

/// Up to this many vertices a tiled model is joined (500 bytes a vertex, beside what the page asks for).
inline constexpr std::size_t kMostJoined = 1'000'000;

class TiledTerrain {
 public:
  /// Reads every tile once. Memory: `bound` (TileReader), and 24 bytes a place of at most 1.3 million. Throws
  /// CannotRead: a tile is missing or damaged, or none holds data.
  explicit TiledTerrain(const std::string& folder, std::size_t bound = TileReader::kBound, const Context& context = {});

  TileReader& reader() { return reader_; }
  const TiledIndex& index() const { return reader_.index(); }
  double low() const { return low_; }  ///< of the heights that are held coarsely
  double high() const { return high_; }
  Vec2 middle() const { return 0.5 * size_; }  ///< of the grid, local coordinates

  /// The surface as it is seen from the eye: no finer than `options.angle` needs nor than the cells, and about
  /// `options.budget` triangles at most. Triangles of a square without data at a corner or in its middle are left out.
  /// Squares of the same size as what is held cost no reading; of the others the tiles are read. Safe from several
  /// threads at once.
  TriangleMesh detail(const DetailOptions& options, DetailNotes* notes = nullptr, const Context& context = {});

  /// What the level lines need to know of all tiles, which the first call reads.
  SurfaceRange range(const Context& context);
  /// The lines of trace_contours on the joined model, within a tenth of a cell. `check` is asked with the number of
  /// points so far, and throws where there are too many.
  ContourSet contours(std::vector<double> levels, const std::function<void(std::size_t points)>& check,
                      const Context& context);

 private:
  struct Sample {
    double height;
    Vec2 gradient;
  };
  void look(const Context& context);
  Vec2 place(double x, double y) const;
  Sample coarse(std::size_t x, std::size_t y) const;

  TileReader reader_;
  TileSource source_;
  std::optional<SurfaceRange> range_;
  std::mutex range_mutex_;
  Vec2 size_;                           // of the box of cell centres; y is negative
  int across_ = 1, down_ = 1;           // squares of level 0
  int held_ = 0;                        // the level whose squares' corners are held
  std::size_t columns_ = 0, rows_ = 0;  // of what is held
  std::vector<double> heights_;
  std::vector<Vec2> gradients_;
  double low_ = 0, high_ = 0;
};

}  // namespace retalho::viewer
