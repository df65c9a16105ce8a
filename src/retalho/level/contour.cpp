#include "retalho/level/contour.h"

#include <fmt/format.h>

#include <cmath>

#include "retalho/core/error.h"
#include "retalho/level/bands.h"
#include "retalho/level/clip.h"
#include "retalho/level/contour_options.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/raw_lines.h"
#include "retalho/level/simplify.h"
#include "retalho/level/strip_lines.h"
#include "retalho/level/trace_terrain.h"
#include "retalho/level/void_border.h"
#include "retalho/terrain/locate.h"

namespace retalho {
namespace {

void append(RawLines& all, const RawLines& part) {
  for (std::size_t l = 0; l < part.set.lines.size(); ++l) {
    ContourLine line = part.set.lines[l];
    const auto from = part.set.points.begin() + static_cast<std::ptrdiff_t>(line.begin),
               to = part.set.points.begin() + static_cast<std::ptrdiff_t>(line.end);
    line.begin = all.set.points.size();
    all.set.points.insert(all.set.points.end(), from, to);
    line.end = all.set.points.size();
    all.set.lines.push_back(line);
    all.ends.push_back(part.ends[l]);
  }
}

/// All lines of a grid at once; `trace` gives them strip by strip.
template <class TraceStrips>
RawLines collect(std::vector<double> levels, const ContourOptions& options, double per_unit, StripTotals& totals,
                 const TraceStrips& trace) {
  RawLines all;
  all.set = empty_set(std::move(levels), options, 1 / per_unit);
  totals = trace([&](RawLines& part) { append(all, part); });
  sort_lines(all);
  all.set.singular = std::move(totals.singular);
  return all;
}

ContourSet trace_fixed(const FixedGrid& fixed, std::vector<double> levels, const ContourOptions& options,
                       const Context& context, ContourExtras* extras) {
  const FixedLevels fixed_levels(levels, fixed.per_unit);
  const bool want_bands = extras != nullptr && extras->want_bands;
  StripTotals totals;
  RawLines all = collect(std::move(levels), options, fixed.per_unit, totals, [&](const auto& take) {
    return trace_strips(fixed, fixed_levels, options, raw_tolerance(options), want_bands, context, take);
  });
  if (extras != nullptr) extras->stats = totals.stats;
  if (want_bands)
    extras->bands = build_bands(all.set, all.ends, grid_border(fixed, fixed_levels, std::move(totals.border)));
  context.report("contour", 1);
  return std::move(all.set);
}

}  // namespace

void check_levels(const std::vector<double>& levels) {
  for (std::size_t k = 0; k < levels.size(); ++k) {
    if (!std::isfinite(levels[k])) throw BadInput("a contour level is not a finite number");
    if (k > 0 && !(levels[k] > levels[k - 1])) throw BadInput("contour levels must ascend, each given once");
  }
}

std::vector<double> contour_levels(double low, double high, double interval, double base) {
  if (!(interval > 0) || !std::isfinite(interval) || !std::isfinite(base))
    throw BadInput(fmt::format("the contour interval must be a positive number, not {}", interval));
  const double first = std::floor((low - base) / interval) + 1, last = std::floor((high - base) / interval);
  if (!(last - first < 1e6))
    throw BadInput(fmt::format("an interval of {} gives {:.0f} levels between {} and {}: ask for a larger one",
                               interval, last - first + 1, low, high));
  std::vector<double> levels;
  for (double k = first; k <= last; ++k) levels.push_back(base + k * interval);
  return levels;
}

ContourSet trace_contours(const BicubicGrid& grid, std::vector<double> levels, const ContourOptions& options,
                          const Context& context, ContourExtras* extras) {
  check_contours(levels, options);
  return trace_fixed(fix_grid(grid, context), std::move(levels), options, context, extras);
}

ContourSet trace_contours(BicubicGrid&& grid, std::vector<double> levels, const ContourOptions& options,
                          const Context& context, ContourExtras* extras) {
  check_contours(levels, options);
  const FixedGrid fixed = fix_grid(grid, context);
  grid = {};
  return trace_fixed(fixed, std::move(levels), options, context, extras);
}

ContourSet stream_contours(const Raster& raster, const BicubicOptions& surface, std::vector<double> levels,
                           const ContourOptions& options, const TakeContours& take, const Context& context,
                           ContourStats* stats) {
  check_contours(levels, options);
  const FixedRows rows(raster, surface, context);
  const FixedLevels fixed_levels(levels, rows.per_unit());
  ContourSet whole = empty_set(std::move(levels), options, 1 / rows.per_unit());
  StripTotals totals = trace_strips(rows, fixed_levels, options, raw_tolerance(options), context, [&](RawLines& part) {
    part.set.levels.swap(whole.levels);
    part.set.height_quantum = whole.height_quantum;
    take(part.set);
    part.set.levels.swap(whole.levels);
  });
  whole.singular = std::move(totals.singular);
  if (stats != nullptr) *stats = totals.stats;
  return whole;
}

ContourSet trace_contours(const Raster& raster, const BicubicOptions& surface, std::vector<double> levels,
                          const ContourOptions& options, const Context& context, ContourStats* stats) {
  check_contours(levels, options);
  const FixedRows rows(raster, surface, context);
  const FixedLevels fixed_levels(levels, rows.per_unit());
  StripTotals totals;
  RawLines all = collect(std::move(levels), options, rows.per_unit(), totals, [&](const auto& take) {
    return trace_strips(rows, fixed_levels, options, raw_tolerance(options), context, take);
  });
  if (stats != nullptr) *stats = totals.stats;
  return std::move(all.set);
}

ContourSet trace_contours(const Terrain& terrain, std::vector<double> levels, const ContourOptions& options,
                          const Context& context, ContourExtras* extras) {
  check_contours(levels, options);
  const EdgeTable edges = build_edges(terrain.tin);
  const double per_unit = terrain_quanta(terrain, edges, context);
  const FixedLevels fixed_levels(levels, per_unit);
  const bool want_bands = extras != nullptr && extras->want_bands, voids = has_voids(terrain.grid);
  context.report("contour", 0);
  OuterRoots outer;
  Trace trace = trace_terrain(terrain, edges, per_unit, fixed_levels, raw_tolerance(options), outer, context);
  if (extras != nullptr)
    extras->stats = {trace.pairs,           trace.certified,     trace.boxes,
                     trace.undecided_edges, trace.points.size(), trace.depth};
  RawLines lines;
  lines.raw = raw_tolerance(options);
  lines.set = empty_set(std::move(levels), options, 1 / per_unit);
  lines.set.singular = trace.singular;
  gather_lines(trace, lines, context);
  if (!want_bands) trace = {};
  if (options.simplify) simplify_lines(lines, terrain, edges, per_unit, fixed_levels, context);
  std::vector<DirectedBorder> outline;
  if (want_bands) {
    outline = terrain_border(terrain, edges, per_unit, fixed_levels, outer, trace);
    extras->bands = build_bands(lines.set, lines.ends, outline);
  }
  if (voids) {
    const std::vector<LineCut> cuts =
        clip_to_cells(lines.set, lines.ends, static_cast<std::uint32_t>(trace.points.size()), terrain.grid);
    if (want_bands) {
      const BandLocator whole(extras->bands);  // of the whole triangulation
      const PointLocator locator(terrain.tin, context);
      const auto inside = [&](Vec2 p) { return locator.locate(p) != kNone; };
      extras->bands = build_bands(lines.set, lines.ends,
                                  void_border(terrain.grid, outline, trace.points, cuts, inside, context), &whole);
    }
    drop_points(lines.set);
  }
  context.report("contour", 1);
  return std::move(lines.set);
}

}  // namespace retalho
