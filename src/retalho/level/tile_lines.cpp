#include "retalho/level/tile_lines.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <tuple>
#include <utility>

#include "retalho/level/clip.h"
#include "retalho/level/contour_options.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/raw_lines.h"
#include "retalho/level/seam_joiner.h"
#include "retalho/level/simplify.h"
#include "retalho/level/tile_outline.h"
#include "retalho/level/trace_terrain.h"
#include "retalho/level/void_border.h"
#include "retalho/terrain/height_range.h"

namespace retalho {
namespace {

struct Slot {
  RawLines lines;
  std::vector<SeamRoot> roots;
  std::vector<SingularPlace> singular;
  ContourStats stats;
  TileOutline outline;  // where bands are wanted
};

/// `whole`: lines are not cut where there are no data, and the outline is wanted.
void trace_tile(const PlacedTile& placed, const TilePlace& place, double per_unit, const FixedLevels& levels,
                const ContourOptions& options, bool whole, Slot& slot, const Context& context) {
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
  if (whole) slot.outline = tile_outline(placed, edges, per_unit, levels, outer, trace);
  const auto first_cut = static_cast<std::uint32_t>(trace.points.size());
  trace = {};
  if (options.simplify) simplify_lines(slot.lines, tile, edges, per_unit, levels, context, true);
  if (!whole && has_voids(tile.grid))
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
        const GridDomain& grid = tile->terrain.grid;
        const Vec2 origin{tile->first_column * grid.cell_width, -tile->first_row * grid.cell_height};
        const HeightRange heights = height_range(tile->terrain, origin);
        slots[s] = {heights.low, heights.high, terrain_quanta(tile->terrain, build_edges(tin), inside), true};
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

namespace {

/// Traces every tile, and gives what has become whole to take(slot), row by row.
ContourSet trace_tiles(const TileSource& tiles, const SurfaceRange& range, std::vector<double> levels,
                       const ContourOptions& options, JoinedOutline* outline,
                       const std::function<void(RawLines& lines, const ContourSet& whole)>& take,
                       const Context& context, ContourStats* stats) {
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
        if (tile != nullptr)
          trace_tile(*tile, place, range.per_unit, fixed, options, outline != nullptr, slots[s], inside);
      },
      [&](const TilePlace& place, std::size_t s) {
        Slot& slot = slots[s];
        if (outline != nullptr) {
          const std::uint32_t first = outline->first_root();
          joiner.add(slot.lines, slot.roots, place.column,
                     [&](std::uint32_t point) { return first + slot.outline.root_of.at(point); });
          outline->add(std::move(slot.outline));
        } else {
          joiner.add(slot.lines, slot.roots, place.column);
        }
        whole.singular.insert(whole.singular.end(), slot.singular.begin(), slot.singular.end());
        add_stats(sum, slot.stats);
        take(slot.lines, whole);
        slot = {};
      });
  drop_repeated(whole.singular);
  if (stats != nullptr) *stats = sum;
  return whole;
}

void append(RawLines& all, const RawLines& part) {
  for (ContourLine line : part.set.lines) {
    line.begin += all.set.points.size();
    line.end += all.set.points.size();
    all.set.lines.push_back(line);
  }
  all.set.points.insert(all.set.points.end(), part.set.points.begin(), part.set.points.end());
  all.ends.insert(all.ends.end(), part.ends.begin(), part.ends.end());
}

}  // namespace

ContourSet stream_contours(const TileSource& tiles, const SurfaceRange& range, std::vector<double> levels,
                           const ContourOptions& options, const TakeContours& take, const Context& context,
                           ContourStats* stats) {
  return trace_tiles(
      tiles, range, std::move(levels), options, nullptr,
      [&](RawLines& lines, const ContourSet& whole) {
        ContourSet& set = lines.set;
        drop_points(set);
        set.levels = whole.levels;
        set.tolerance = whole.tolerance;
        set.height_quantum = whole.height_quantum;
        take(set);
      },
      context, stats);
}

ContourSet trace_contours(const TileSource& tiles, const SurfaceRange& range, std::vector<double> levels,
                          const ContourOptions& options, const Context& context, ContourExtras* extras) {
  const bool bands = extras != nullptr && extras->want_bands;
  std::optional<JoinedOutline> joined;
  if (bands) joined.emplace(tiles);
  RawLines all;
  ContourSet whole = trace_tiles(
      tiles, range, std::move(levels), options, bands ? &*joined : nullptr,
      [&](const RawLines& lines, const ContourSet&) { append(all, lines); }, context,
      extras != nullptr ? &extras->stats : nullptr);
  all.set.levels = std::move(whole.levels);
  all.set.singular = std::move(whole.singular);
  all.set.tolerance = whole.tolerance;
  all.set.height_quantum = whole.height_quantum;
  if (bands) {
    const std::vector<DirectedBorder> outline = joined->take();
    extras->bands = build_bands(all.set, all.ends, outline);
    if (has_voids(joined->grid())) {
      const std::vector<LineCut> cuts = clip_to_cells(all.set, all.ends, joined->first_root(), joined->grid());
      const BandLocator everywhere(extras->bands);
      const OutlineArea area(outline);
      const auto inside = [&](Vec2 p) { return area.holds(p); };
      extras->bands =
          build_bands(all.set, all.ends,
                      void_border(joined->grid(), outline, joined->root_places(), cuts, inside, context), &everywhere);
    }
  }
  drop_points(all.set);
  std::stable_sort(all.set.lines.begin(), all.set.lines.end(),
                   [](const ContourLine& a, const ContourLine& b) { return a.level < b.level; });
  return std::move(all.set);
}

}  // namespace retalho
