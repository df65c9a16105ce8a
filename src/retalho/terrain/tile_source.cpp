#include "retalho/terrain/tile_source.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "retalho/core/in_order.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

Context side_by_side(const TileSource& source, const Context& context) {
  Context tiles = context;
  tiles.threads = static_cast<int>(std::min(source.at_once, static_cast<std::size_t>(thread_count(context))));
  return tiles;
}

TilePlace place_of(const TileSource& source, std::size_t k) {
  const auto across = static_cast<std::size_t>(source.tile_columns);
  TilePlace place;
  place.row = static_cast<int>(k / across);
  place.column = static_cast<int>(k % across);
  place.north = place.row > 0;
  place.west = place.column > 0;
  place.south = place.row + 1 < source.tile_rows;
  place.east = place.column + 1 < source.tile_columns;
  return place;
}

}  // namespace

bool PlacedTile::has_data(Vec2 p) const {
  const GridDomain& grid = terrain.grid;
  const double column = std::floor(p.x / grid.cell_width + 0.5) - first_column,
               row = std::floor(-p.y / grid.cell_height + 0.5) - first_row;
  if (!(column >= 0 && row >= 0 && column < grid.columns && row < grid.rows)) return false;
  return grid.valid.empty() || grid.valid.get(static_cast<int>(column), static_cast<int>(row));
}

std::size_t tile_slots(const TileSource& source, const Context& context) {
  return slot_count(side_by_side(source, context));
}

void each_tile(const TileSource& source, const char* stage, const Context& context,
               const std::function<void(const PlacedTile*, const TilePlace&, std::size_t, const Context&)>& make,
               const std::function<void(const TilePlace&, std::size_t)>& take) {
  const Context tiles = side_by_side(source, context);
  const Context inside{.threads = tiles.threads > 1 ? 1 : context.threads, .cancel = context.cancel};
  parallel_in_order(
      source.tiles(), tiles,
      [&](std::size_t k, std::size_t slot) {
        const TilePlace place = place_of(source, k);
        const std::optional<PlacedTile> tile = source.load(place.row, place.column);
        make(tile ? &*tile : nullptr, place, slot, inside);
      },
      [&](std::size_t k, std::size_t slot) {
        take(place_of(source, k), slot);
        context.report(stage, static_cast<double>(k + 1) / static_cast<double>(source.tiles()));
      });
}

VertexBox vertex_box(const TileSource& source, const Context& context) {
  std::vector<VertexBox> slots(tile_slots(source, context));
  VertexBox whole;
  const auto add = [](VertexBox& box, Vec3 p) {
    if (!box.data) box = {p, p, true};
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
  };
  each_tile(
      source, "range", context,
      [&](const PlacedTile* tile, const TilePlace&, std::size_t s, const Context&) {
        slots[s] = {};
        if (tile == nullptr) return;
        const Tin& tin = tile->terrain.tin;
        for (std::size_t v = 0; v < tin.vertex_count(); ++v)
          add(slots[s], {tin.points[v].x, tin.points[v].y, tin.heights[v]});
      },
      [&](const TilePlace&, std::size_t s) {
        if (!slots[s].data) return;
        add(whole, slots[s].low);
        add(whole, slots[s].high);
      });
  return whole;
}

}  // namespace retalho
