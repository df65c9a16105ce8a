#include "retalho/level/tile_lines.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "retalho/level/clip.h"
#include "retalho/level/contour_options.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/raw_lines.h"
#include "retalho/level/seam_joiner.h"
#include "retalho/level/simplify.h"
#include "retalho/level/trace_terrain.h"

namespace retalho {
namespace {

struct Slot {
  RawLines lines;
  std::vector<SeamRoot> roots;
  std::vector<SingularPlace> singular;
  ContourStats stats;
};

void trace_tile(const PlacedTile& placed, const TilePlace& place, double per_unit, const FixedLevels& levels,
                const ContourOptions& options, Slot& slot, const Context& context) {
  const Terrain& tile = placed.terrain;
  const EdgeTable edges = build_edges(tile.tin);
  OuterRoots outer;
  Trace trace = trace_terrain(tile, edges, per_unit, levels, raw_tolerance(options), outer, context);
  slot.roots = seam_roots(placed, edges, outer, {place.north, place.west, place.south, place.east});
  slot.stats = {trace.pairs, trace.certified, trace.boxes, trace.undecided_edges, trace.points.size(), trace.depth};
  slot.singular = std::move(trace.singular);
  slot.lines.raw = raw_tolerance(options);
  slot.lines.set.tolerance = options.tolerance;
  gather_lines(trace, slot.lines, context);
  const auto first_cut = static_cast<std::uint32_t>(trace.points.size());
  trace = {};
  if (options.simplify) simplify_lines(slot.lines, tile, edges, per_unit, levels, context, true);
  if (has_voids(tile.grid))
    clip_to_cells(slot.lines.set, slot.lines.ends, first_cut, {tile.grid, placed.first_column, placed.first_row});
}

void add_stats(ContourStats& sum, const ContourStats& part) {
  sum.pairs += part.pairs;
  sum.certified += part.certified;
  sum.boxes += part.boxes;
  sum.undecided_edges += part.undecided_edges;
  sum.raw_points += part.raw_points;
  sum.depth = std::max(sum.depth, part.depth);
}

/// Both tiles of a seam report what is singular on it.
void drop_repeated(std::vector<SingularPlace>& places) {
  const auto key = [](const SingularPlace& p) { return std::tuple(p.level, -p.low.y, p.low.x, -p.high.y, p.high.x); };
  std::sort(places.begin(), places.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  const auto same = [&](const auto& a, const auto& b) { return key(a) == key(b); };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
}

}  // namespace

SurfaceRange measure_range(const TileSource& tiles, const Context& context) {
  std::vector<SurfaceRange> slots(tile_slots(tiles, context));
  SurfaceRange range;
  each_tile(
      tiles, "range", context,
      [&](const PlacedTile* tile, const TilePlace&, std::size_t s, const Context& inside) {
        slots[s] = {};
        if (tile == nullptr || tile->terrain.tin.triangles.empty()) return;
        const Tin& tin = tile->terrain.tin;
        const auto [low, high] = std::minmax_element(tin.heights.begin(), tin.heights.end());
        slots[s] = {*low, *high, terrain_quanta(tile->terrain, build_edges(tin), inside), true};
      },
      [&](const TilePlace&, std::size_t s) {
        const SurfaceRange& part = slots[s];
        if (part.data)
          range = range.data ? SurfaceRange{std::min(range.low, part.low), std::max(range.high, part.high),
                                            std::min(range.per_unit, part.per_unit), true}
                             : part;
      });
  return range;
}

ContourSet stream_contours(const TileSource& tiles, const SurfaceRange& range, std::vector<double> levels,
                           const ContourOptions& options, const TakeContours& take, const Context& context,
                           ContourStats* stats) {
  check_contours(levels, options);
  const FixedLevels fixed(levels, range.per_unit);
  ContourSet whole = empty_set(std::move(levels), options, 1 / range.per_unit);
  std::vector<Slot> slots(tile_slots(tiles, context));
  SeamJoiner joiner(tiles.tile_columns);
  ContourStats sum;
  each_tile(
      tiles, "contour", context,
      [&](const PlacedTile* tile, const TilePlace& place, std::size_t s, const Context& inside) {
        slots[s] = {};
        if (tile != nullptr) trace_tile(*tile, place, range.per_unit, fixed, options, slots[s], inside);
      },
      [&](const TilePlace& place, std::size_t s) {
        Slot& slot = slots[s];
        joiner.add(slot.lines, slot.roots, place.column);
        drop_points(slot.lines.set);
        whole.singular.insert(whole.singular.end(), slot.singular.begin(), slot.singular.end());
        add_stats(sum, slot.stats);
        ContourSet& set = slot.lines.set;
        set.levels.swap(whole.levels);
        set.tolerance = whole.tolerance;
        set.height_quantum = whole.height_quantum;
        take(set);
        set.levels.swap(whole.levels);
      });
  drop_repeated(whole.singular);
  if (stats != nullptr) *stats = sum;
  return whole;
}

}  // namespace retalho
