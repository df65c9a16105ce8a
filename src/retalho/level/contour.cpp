#include "retalho/level/contour.h"

#include <fmt/format.h>

#include <cmath>

#include "retalho/core/error.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/lines.h"
#include "retalho/level/trace_grid.h"
#include "retalho/level/trace_terrain.h"

namespace retalho {
namespace {

void check(const std::vector<double>& levels, const ContourOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw BadInput(fmt::format("the tolerance of contour lines must be a positive number, not {}", options.tolerance));
  for (std::size_t k = 0; k < levels.size(); ++k) {
    if (!std::isfinite(levels[k])) throw BadInput("a contour level is not a finite number");
    if (k > 0 && !(levels[k] > levels[k - 1])) throw BadInput("contour levels must ascend, each given once");
  }
}

/// Copies lines out of the trace; of equal consecutive points one stays.
void gather(const Trace& trace, const std::vector<TracedLine>& lines, ContourSet& set) {
  std::size_t total = 0;
  for (const TracedLine& line : lines) total += line.count;
  set.points.reserve(total);
  set.lines.reserve(lines.size());
  for (const TracedLine& line : lines) {
    ContourLine out{line.level, line.closed, set.points.size(), 0};
    std::uint32_t p = line.start;
    for (std::uint32_t i = 0; i < line.count; ++i, p = trace.next[p])
      if (set.points.size() == out.begin || !(set.points.back() == trace.points[p]))
        set.points.push_back(trace.points[p]);
    if (out.closed && set.points.size() > out.begin + 1 && set.points.back() == set.points[out.begin])
      set.points.pop_back();
    out.end = set.points.size();
    set.lines.push_back(out);
  }
}

void fill(ContourStats* stats, const Trace& trace) {
  if (stats == nullptr) return;
  stats->pairs = trace.pairs;
  stats->certified = trace.certified;
  stats->boxes = trace.boxes;
  stats->undecided_edges = trace.undecided_edges;
  stats->raw_points = trace.points.size();
  stats->depth = trace.depth;
}

}  // namespace

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
                          const Context& context, ContourStats* stats) {
  check(levels, options);
  const FixedGrid fixed = fix_grid(grid, context);
  const FixedLevels fixed_levels(levels, fixed.per_unit);
  context.report("contour", 0);
  const Trace trace = trace_grid(fixed, fixed_levels, options.tolerance, nullptr, context);
  fill(stats, trace);
  ContourSet set;
  set.tolerance = options.tolerance;
  set.height_quantum = 1 / fixed.per_unit;
  set.singular = trace.singular;
  gather(trace, find_lines(trace), set);
  set.levels = std::move(levels);
  context.report("contour", 1);
  return set;
}

ContourSet trace_contours(const Terrain& terrain, std::vector<double> levels, const ContourOptions& options,
                          const Context& context, ContourStats* stats) {
  check(levels, options);
  const EdgeTable edges = build_edges(terrain.tin);
  const double per_unit = terrain_quanta(terrain, edges, context);
  const FixedLevels fixed_levels(levels, per_unit);
  context.report("contour", 0);
  OuterRoots outer;
  const Trace trace = trace_terrain(terrain, edges, per_unit, fixed_levels, options.tolerance, outer, context);
  fill(stats, trace);
  ContourSet set;
  set.tolerance = options.tolerance;
  set.height_quantum = 1 / per_unit;
  set.singular = trace.singular;
  gather(trace, find_lines(trace), set);
  set.levels = std::move(levels);
  context.report("contour", 1);
  return set;
}

}  // namespace retalho
