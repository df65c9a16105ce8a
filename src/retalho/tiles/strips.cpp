#include "retalho/tiles/strips.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "retalho/raster/io.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"

namespace retalho {
namespace {

using Data = std::unordered_map<std::uint64_t, VertexData>;
using CellTriangle = std::array<GridCell, 3>;

/// All vertices of a tile, by their cells.
std::set<GridCell> cells_of(const TiledIndex& frame, const PlacedTin& tile) {
  std::set<GridCell> cells;
  for (std::uint32_t v = 0; v < tile.tin->vertex_count(); ++v) cells.insert(cell_of(frame, tile, v));
  return cells;
}

/// The triangles of `tiles` within kStripRings rings of `seeds`, each from its first cell on, in the order of their
/// cells: nothing of who asks is left in them.
std::vector<CellTriangle> strip_round(const TiledIndex& frame, const std::vector<PlacedTin>& tiles,
                                      const std::set<GridCell>& seeds) {
  std::vector<CellTriangle> all;
  for (const PlacedTin& tile : tiles)
    for (const auto& t : tile.tin->triangles)
      all.push_back({cell_of(frame, tile, t[0]), cell_of(frame, tile, t[1]), cell_of(frame, tile, t[2])});
  std::vector<CellTriangle> strip;
  std::set<GridCell> reached = seeds;
  for (int ring = 0; ring < kStripRings; ++ring) {
    const auto far = std::partition(all.begin(), all.end(), [&](const CellTriangle& t) {
      return std::none_of(t.begin(), t.end(), [&](const GridCell& c) { return reached.contains(c); });
    });
    for (auto t = far; t != all.end(); ++t) {
      reached.insert(t->begin(), t->end());
      std::rotate(t->begin(), std::min_element(t->begin(), t->end()), t->end());
      strip.push_back(*t);
    }
    all.erase(far, all.end());
  }
  std::sort(strip.begin(), strip.end());
  return strip;
}

/// Fits the strip and puts the data of `seeds` into `result`. What is `known` is held.
void fit_strip(const TilePlan& plan, const std::vector<PlacedTin>& tiles, const std::set<GridCell>& seeds,
               const Data& known, Data& result, const Context& context) {
  const TiledIndex& frame = plan.frame;
  const std::vector<CellTriangle> strip = strip_round(frame, tiles, seeds);
  std::map<GridCell, std::uint32_t> number;
  for (const CellTriangle& t : strip)
    for (const GridCell& c : t) number.emplace(c, 0U);
  if (number.empty()) return;
  std::int64_t left = number.begin()->first.column, right = left;
  const std::int64_t top = number.begin()->first.row, bottom = number.rbegin()->first.row;
  std::uint32_t next = 0;
  for (auto& [cell, at] : number) {
    at = next++;
    left = std::min(left, cell.column);
    right = std::max(right, cell.column);
  }
  ReadOptions read = plan.read;
  read.window = CellWindow{static_cast<int>(left), static_cast<int>(top), static_cast<int>(right - left + 1),
                           static_cast<int>(bottom - top + 1)};
  const Raster raster = read_raster(plan.source, read, nullptr, context);
  Tin tin;
  for (const auto& [cell, at] : number) {
    const auto column = static_cast<int>(cell.column - left), row = static_cast<int>(cell.row - top);
    tin.points.push_back(raster.centre(column, row));
    tin.heights.push_back(raster.at(column, row));
  }
  for (const CellTriangle& t : strip) tin.triangles.push_back({number.at(t[0]), number.at(t[1]), number.at(t[2])});
  SurfaceOptions surface;
  surface.surface = frame.surface;
  Terrain terrain = make_terrain(std::move(tin), raster, surface, context);
  std::vector<std::uint8_t> held(number.size(), 0);
  for (const auto& [cell, at] : number)
    if (const auto found = known.find(cell.key()); found != known.end()) {
      held[at] = 1;
      terrain.tin.heights[at] = found->second.height;
      if (!terrain.gradients.empty()) terrain.gradients[at] = found->second.gradient;
    }
  LeastSquaresOptions fit;
  fit.held = held;
  terrain = fit_least_squares(std::move(terrain), raster, fit, context);
  for (const GridCell& seed : seeds)
    if (const auto found = number.find(seed); found != number.end())
      result[seed.key()] = {terrain.tin.heights[found->second],
                            terrain.gradients.empty() ? Vec2{} : terrain.gradients[found->second]};
}

class Seams {
 public:
  Seams(const TilePlan& plan, const TilesAround& tiles, const Context& context)
      : plan_(plan), tiles_(tiles), context_(context) {
    for (std::size_t k = 0; k < 9; ++k)
      if (tiles[k].tin != nullptr) cells_[k] = cells_of(plan.frame, tiles[k]);
  }

  Data run() {
    for (const auto& [south, east] : {std::pair{1, 1}, {1, 2}, {2, 1}, {2, 2}}) corner(south, east);
    const Data corners = data_;
    for (const auto& [first, second] : {std::pair<std::size_t, std::size_t>{3, 4}, {4, 5}, {1, 4}, {4, 7}})
      seam(first, second, corners);
    return std::move(data_);
  }

 private:
  /// The corner that tile (south, east) of the nine has in its north-west.
  void corner(int south, int east) {
    const auto at = [](int row, int column) { return static_cast<std::size_t>(3 * row + column); };
    const CellWindow& middle = tiles_[4].cells;
    const GridCell cell{middle.row + (south == 2 ? middle.rows - 1 : 0),
                        middle.column + (east == 2 ? middle.columns - 1 : 0)};
    std::vector<PlacedTin> meet;
    for (const std::size_t k : {at(south - 1, east - 1), at(south - 1, east), at(south, east - 1), at(south, east)})
      if (tiles_[k].tin != nullptr && cells_[k].contains(cell)) meet.push_back(tiles_[k]);
    if (meet.size() > 1) fit_strip(plan_, meet, {cell}, {}, data_, context_);
  }

  /// Only what both of its tiles have is held: the corners at its ends.
  void seam(std::size_t first, std::size_t second, const Data& corners) {
    if (tiles_[first].tin == nullptr || tiles_[second].tin == nullptr) return;
    std::set<GridCell> shared;
    Data ends;
    for (const GridCell& cell : cells_[first]) {
      if (!cells_[second].contains(cell)) continue;
      if (const auto found = corners.find(cell.key()); found != corners.end())
        ends.insert(*found);
      else
        shared.insert(cell);
    }
    if (!shared.empty()) fit_strip(plan_, {tiles_[first], tiles_[second]}, shared, ends, data_, context_);
  }

  const TilePlan& plan_;
  const TilesAround& tiles_;
  const Context& context_;
  std::array<std::set<GridCell>, 9> cells_;
  Data data_;
};

}  // namespace

std::unordered_map<std::uint64_t, VertexData> fit_seams(const TilePlan& plan, const TilesAround& tiles,
                                                        const Context& context) {
  return Seams(plan, tiles, context).run();
}

}  // namespace retalho
