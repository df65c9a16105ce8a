#include "retalho/level/tile_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace retalho {

TileOutline tile_outline(const PlacedTile& placed, const EdgeTable& edges, double per_unit, const FixedLevels& levels,
                         const OuterRoots& outer, const Trace& trace) {
  const Terrain& tile = placed.terrain;
  TileOutline outline;
  outline.data = true;
  outline.grid = tile.grid;
  outline.first_column = placed.first_column;
  outline.first_row = placed.first_row;
  outline.pieces = terrain_border(tile, edges, per_unit, levels, outer, trace);
  const auto cell = [&](std::uint64_t vertex) {
    const Vec2 p = tile.tin.points[vertex];
    return (static_cast<std::uint64_t>(std::llround(-p.y / tile.grid.cell_height)) << 32) |
           static_cast<std::uint64_t>(std::llround(p.x / tile.grid.cell_width));
  };
  for (DirectedBorder& piece : outline.pieces) {
    piece.from = cell(piece.from);
    piece.to = cell(piece.to);
    for (std::uint32_t& root : piece.roots) {
      const auto number = static_cast<std::uint32_t>(outline.root_places.size());
      outline.root_places.push_back(trace.points[root]);
      outline.root_of.emplace(root, number);
      root = number;
    }
  }
  return outline;
}

JoinedOutline::JoinedOutline(const TileSource& tiles) {
  grid_.columns = tiles.columns;
  grid_.rows = tiles.rows;
  grid_.cell_width = tiles.cell_width;
  grid_.cell_height = tiles.cell_height;
  grid_.valid = Mask(tiles.columns, tiles.rows, false);
}

void JoinedOutline::add(TileOutline&& outline) {
  if (!outline.data) return;
  const std::uint32_t first = first_root();
  root_places_.insert(root_places_.end(), outline.root_places.begin(), outline.root_places.end());
  for (DirectedBorder& piece : outline.pieces) {
    for (std::uint32_t& root : piece.roots) root += first;
    if (const auto like = alone_.find({piece.to, piece.from}); like != alone_.end()) {
      inside_[like->second] = 1;
      pieces_[like->second].roots = {};
      alone_.erase(like);
      continue;
    }
    alone_.emplace(std::pair{piece.from, piece.to}, pieces_.size());
    pieces_.push_back(std::move(piece));
    inside_.push_back(0);
  }
  const GridDomain& g = outline.grid;
  for (int r = 0; r < g.rows; ++r)
    for (int c = 0; c < g.columns; ++c)
      if (g.valid.empty() || g.valid.get(c, r)) grid_.valid.set(outline.first_column + c, outline.first_row + r, true);
}

std::vector<DirectedBorder> JoinedOutline::take() {
  std::unordered_map<std::uint64_t, std::uint64_t> number;
  const auto node = [&](std::uint64_t cell) { return number.emplace(cell, number.size()).first->second; };
  std::vector<DirectedBorder> border;
  for (std::size_t k = 0; k < pieces_.size(); ++k) {
    if (inside_[k] != 0) continue;
    border.push_back(std::move(pieces_[k]));
    border.back().from = node(border.back().from);
    border.back().to = node(border.back().to);
  }
  pieces_.clear();
  alone_.clear();
  return border;
}

OutlineArea::OutlineArea(const std::vector<DirectedBorder>& border) {
  double high = 0;
  for (const DirectedBorder& piece : border) {
    if (&piece == &border.front()) low_ = high = piece.place.y;
    low_ = std::min(low_, piece.place.y);
    high = std::max(high, piece.place.y);
  }
  const auto slices = static_cast<std::size_t>(std::sqrt(static_cast<double>(border.size()))) + 1;
  per_slice_ = high > low_ ? static_cast<double>(slices) / (high - low_) : 0;
  slices_.resize(slices + 1);
  for (const DirectedBorder& piece : border) {
    const Edge edge{piece.place, piece.place + piece.along};
    const std::size_t from = slice(edge.from.y), to = slice(edge.to.y);
    for (std::size_t s = std::min(from, to); s <= std::max(from, to); ++s) slices_[s].push_back(edge);
  }
}

std::size_t OutlineArea::slice(double y) const {
  return static_cast<std::size_t>(std::clamp((y - low_) * per_slice_, 0.0, static_cast<double>(slices_.size()) - 1));
}

/// The next piece to the west decides, just above the place where several start from one point: of one that runs south
/// the area lies to the east.
bool OutlineArea::holds(Vec2 p) const {
  double best = -std::numeric_limits<double>::infinity(), best_lean = best;
  bool inside = false;
  for (const Edge& e : slices_[slice(p.y)]) {
    if ((e.from.y <= p.y) == (e.to.y <= p.y)) continue;
    const double lean = (e.to.x - e.from.x) / (e.to.y - e.from.y);
    const double x = p.y == e.from.y ? e.from.x : p.y == e.to.y ? e.to.x : e.from.x + (p.y - e.from.y) * lean;
    if (x > p.x || x < best || (x == best && lean <= best_lean)) continue;
    best = x;
    best_lean = lean;
    inside = e.from.y > e.to.y;
  }
  return inside;
}

}  // namespace retalho
