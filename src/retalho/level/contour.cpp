#include "retalho/level/contour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/level/bands.h"
#include "retalho/level/clip.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/lines.h"
#include "retalho/level/simplify.h"
#include "retalho/level/trace_grid.h"
#include "retalho/level/trace_terrain.h"
#include "retalho/level/void_border.h"

namespace retalho {
namespace {

void check(const std::vector<double>& levels, const ContourOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw BadInput(fmt::format("the tolerance of contour lines must be a positive number, not {}", options.tolerance));
  check_levels(levels);
}

/// Copies lines out of the trace; of equal consecutive points one stays.
void gather(const Trace& trace, const TracedLines& traced, RawLines& raw, const Context& context) {
  ContourSet& set = raw.set;
  const bool cells = !trace.cell.empty();
  set.points.resize(traced.order.size());
  if (cells) raw.cell.resize(traced.order.size());
  set.lines.resize(traced.lines.size());
  raw.ends.resize(traced.lines.size());
  // Every line has its place from the start; lines that turn out shorter leave gaps, closed below.
  std::vector<std::size_t> place(traced.lines.size());
  std::size_t total = 0;
  for (std::size_t l = 0; l < traced.lines.size(); ++l) {
    place[l] = total;
    total += traced.lines[l].count;
  }
  parallel_chunks(traced.lines.size(), 256, context, [&](std::size_t from, std::size_t to) {
    for (std::size_t l = from; l < to; ++l) {
      const TracedLine& line = traced.lines[l];
      const std::size_t begin = place[l];
      std::size_t end = begin;
      for (const std::uint32_t p : std::span(traced.order).subspan(line.first, line.count)) {
        if (end > begin && set.points[end - 1] == trace.points[p]) continue;
        if (cells) raw.cell[end] = trace.cell[p];
        set.points[end++] = trace.points[p];
      }
      if (line.closed && end > begin + 1 && set.points[end - 1] == set.points[begin]) --end;
      set.lines[l] = {line.level, line.closed, begin, end};
      raw.ends[l] = {line.start, line.stop};
    }
  });
  std::size_t write = 0;
  for (ContourLine& line : set.lines) {
    const std::size_t n = line.end - line.begin;
    if (write != line.begin) {
      std::copy_n(set.points.begin() + static_cast<std::ptrdiff_t>(line.begin), n,
                  set.points.begin() + static_cast<std::ptrdiff_t>(write));
      if (cells)
        std::copy_n(raw.cell.begin() + static_cast<std::ptrdiff_t>(line.begin), n,
                    raw.cell.begin() + static_cast<std::ptrdiff_t>(write));
    }
    line.begin = write;
    line.end = write += n;
  }
  set.points.resize(write);
  if (cells) raw.cell.resize(write);
}

void fill(ContourExtras* extras, const Trace& trace) {
  if (extras == nullptr) return;
  extras->stats = {trace.pairs, trace.certified, trace.boxes, trace.undecided_edges, trace.points.size(), trace.depth};
}

/// Lines that will be thinned are traced closer than they have to be.
double raw_tolerance(const ContourOptions& options) {
  return options.simplify ? options.tolerance / 5 : options.tolerance;
}

RawLines raw_lines(const Trace& trace, std::vector<double> levels, const ContourOptions& options, double quantum,
                   ContourExtras* extras, const Context& context) {
  fill(extras, trace);
  RawLines lines;
  lines.raw = raw_tolerance(options);
  lines.set.tolerance = options.tolerance;
  lines.set.height_quantum = quantum;
  lines.set.singular = trace.singular;
  gather(trace, find_lines(trace), lines, context);
  lines.set.levels = std::move(levels);
  return lines;
}

ContourSet trace_fixed(const FixedGrid& fixed, std::vector<double> levels, const ContourOptions& options,
                       const Context& context, ContourExtras* extras) {
  const FixedLevels fixed_levels(levels, fixed.per_unit);
  context.report("contour", 0);
  const bool want_bands = extras != nullptr && extras->want_bands;
  std::vector<BorderEdge> border;
  Trace trace = trace_grid(fixed, fixed_levels, raw_tolerance(options), want_bands ? &border : nullptr, context);
  RawLines lines = raw_lines(trace, std::move(levels), options, 1 / fixed.per_unit, extras, context);
  if (!want_bands) trace = {};
  if (options.simplify) simplify_lines(lines, fixed, fixed_levels, context);
  if (want_bands)
    extras->bands = build_bands(lines.set, lines.ends, grid_border(fixed, fixed_levels, std::move(border), trace));
  context.report("contour", 1);
  return std::move(lines.set);
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
  check(levels, options);
  return trace_fixed(fix_grid(grid, context), std::move(levels), options, context, extras);
}

ContourSet trace_contours(BicubicGrid&& grid, std::vector<double> levels, const ContourOptions& options,
                          const Context& context, ContourExtras* extras) {
  check(levels, options);
  const FixedGrid fixed = fix_grid(grid, context);
  grid = {};
  return trace_fixed(fixed, std::move(levels), options, context, extras);
}

ContourSet trace_contours(const Terrain& terrain, std::vector<double> levels, const ContourOptions& options,
                          const Context& context, ContourExtras* extras) {
  check(levels, options);
  const EdgeTable edges = build_edges(terrain.tin);
  const double per_unit = terrain_quanta(terrain, edges, context);
  const FixedLevels fixed_levels(levels, per_unit);
  const bool want_bands = extras != nullptr && extras->want_bands, voids = has_voids(terrain.grid);
  context.report("contour", 0);
  OuterRoots outer;
  Trace trace = trace_terrain(terrain, edges, per_unit, fixed_levels, raw_tolerance(options), outer, context);
  RawLines lines = raw_lines(trace, std::move(levels), options, 1 / per_unit, extras, context);
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
      extras->bands = build_bands(lines.set, lines.ends, void_border(terrain, outline, trace, cuts, context), &whole);
    }
    drop_points(lines.set);
  }
  context.report("contour", 1);
  return std::move(lines.set);
}

}  // namespace retalho
