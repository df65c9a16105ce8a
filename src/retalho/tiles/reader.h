// A tiled model read by tiles: what is asked for is read, and what was not asked for longest is forgotten.
#pragma once

#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/model/tiled.h"
#include "retalho/raster/cell_heights.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/report.h"

namespace retalho {

/// A tile ready for questions, in local coordinates of its own: those of the whole less `origin`.
class OpenTile {
 public:
  OpenTile(Terrain terrain, Vec2 origin);
  OpenTile(const OpenTile&) = delete;
  OpenTile& operator=(const OpenTile&) = delete;

  const Terrain& terrain() const { return terrain_; }
  const TerrainEvaluator& evaluator() const { return evaluator_; }
  Vec2 origin() const { return origin_; }
  /// What it takes: the terrain's arrays, and kEvaluatorBytes a triangle.
  std::size_t bytes() const;

 private:
  Terrain terrain_;
  TerrainEvaluator evaluator_;
  Vec2 origin_;
};

/// Safe to use from several threads at once; tiles are read one after another.
class TileReader {
 public:
  static constexpr std::size_t kBound = std::size_t{512} << 20;

  /// Reads the index alone. `bound`: bytes of the tiles that are kept (OpenTile::bytes); the one asked for last is kept
  /// whatever its size, and whoever holds a tile keeps it alive. Throws CannotRead.
  explicit TileReader(std::string folder, std::size_t bound = kBound);

  const TiledIndex& index() const { return index_; }
  /// The tile; null where it holds no data. Throws CannotRead: missing, damaged.
  std::shared_ptr<const OpenTile> tile(int tile_row, int tile_column);

  /// At a point in local coordinates of the whole (those of the grid's north-western cell): height, gradient and second
  /// derivatives as the joined model has them, but for rounding; nullopt where there is no data.
  std::optional<Jet> jet(Vec2 p);

  /// jet() at each of them, asked tile by tile: a tile is read once whatever the bound.
  std::vector<std::optional<Jet>> jets(std::span<const Vec2> points);

  std::size_t reads() const;      ///< of tiles, so far
  std::size_t most_kept() const;  ///< bytes, the most so far

 private:
  struct Kept {
    std::shared_ptr<const OpenTile> tile;
    std::list<std::size_t>::iterator used;
  };
  std::optional<Jet> jet_in(int tile_row, int tile_column, Vec2 p);

  std::string folder_;
  std::size_t bound_;
  TiledIndex index_;
  mutable std::mutex mutex_;
  std::list<std::size_t> used_;  // the last one used first
  std::unordered_map<std::size_t, Kept> kept_;
  std::size_t bytes_ = 0, reads_ = 0, most_ = 0;
};

/// Cell (c, r) of a raster lies at origin + (c step.x, -r step.y), local coordinates of the whole.
struct SampledRows {
  Vec2 origin, step;
  int columns = 0;
  int first = 0, rows = 0;  ///< rows first to first + rows - 1 are wanted
};
/// Heights, and gradients where `gradients` is not empty, of some rows: as TerrainEvaluator::grid_values on the joined
/// model, but for rounding. NaN: no data. Memory: the reader's bound, and one tile's part of the rows.
void sample_rows(TileReader& reader, const SampledRows& rows, std::span<double> heights, std::span<Vec2> gradients,
                 const Context& context = {});

/// The heights of a part of the model's grid: raster_of_cells of the joined model, but for rounding. Throws BadInput
/// for a window that is not within the grid. Memory: 8 bytes a cell of the window, and the reader's bound.
Raster raster_of_window(TileReader& reader, const CellWindow& window, const Context& context = {});

/// The heights of the model's grid cell by cell, for work that asks for few of them; refers to the reader.
CellHeights cells_of(TileReader& reader);

/// What a joined model would have.
struct TiledFacts {
  std::size_t vertices = 0, triangles = 0;
  GradientKind gradients = GradientKind::none;
};

/// Is `place` (inspect_raster) the very grid that the model was made from: its size, its place, its cells? Only then
/// can the two be compared part by part.
bool same_grid(const TiledIndex& index, const Raster& place);

/// assess() on the joined model, tile by tile: `read(window)` gives the heights of a part of the grid that the model
/// was made from. The same counts and largest error; sums but for rounding. Throws as assess, and BadInput for another
/// grid.
ErrorReport assess_tiles(TileReader& reader, const std::function<Raster(const CellWindow&)>& read, double tolerance,
                         TiledFacts* facts = nullptr, const Context& context = {});

}  // namespace retalho
