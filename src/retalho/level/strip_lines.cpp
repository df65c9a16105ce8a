#include "retalho/level/strip_lines.h"

#include <algorithm>
#include <utility>

#include "retalho/core/in_order.h"
#include "retalho/level/line_joiner.h"
#include "retalho/level/simplify.h"

namespace retalho {
namespace {

struct Slot {
  GridStrip strip;
  RawLines lines;
};

void add_totals(GridStrip& strip, const LineJoiner& joiner, bool first, std::size_t index, StripTotals& totals) {
  const Trace& trace = strip.trace;
  // The strip above has reported the first row's.
  const std::size_t again = first ? 0 : strip.top_undecided;
  totals.singular.insert(totals.singular.end(), trace.singular.begin() + static_cast<std::ptrdiff_t>(again),
                         trace.singular.end());
  ContourStats& stats = totals.stats;
  stats.pairs += trace.pairs;
  stats.certified += trace.certified;
  stats.boxes += trace.boxes;
  stats.undecided_edges += trace.undecided_edges - again;
  stats.raw_points += trace.points.size() - (first ? 0 : strip.top);
  stats.depth = std::max(stats.depth, trace.depth);
  for (BorderEdge& edge : strip.border) {
    if (!first && edge.horizontal && edge.row == static_cast<int>(index) * kStripRows) continue;
    for (BorderRoot& root : edge.roots) root.point = joiner.joined(root.point);
    totals.border.push_back(std::move(edge));
  }
}

}  // namespace

StripTotals trace_strips(const FixedGrid& grid, const FixedLevels& levels, const ContourOptions& options, double raw,
                         bool want_border, const Context& context, const std::function<void(RawLines& lines)>& take) {
  StripTotals totals;
  LineJoiner joiner;
  const std::size_t count = strip_count(grid);
  std::vector<Slot> slots(std::min(slot_count(context), std::max<std::size_t>(count, 1)));
  const Context alone{.threads = 1, .cancel = context.cancel};
  parallel_in_order(
      count, context,
      [&](std::size_t i, std::size_t slot) {
        auto& [strip, lines] = slots[slot];
        trace_strip(grid, levels, raw, i, want_border, strip, alone);
        lines.raw = raw;
        lines.set.tolerance = options.tolerance;
        gather_lines(strip.trace, lines, alone);
        if (options.simplify) simplify_lines(lines, grid, levels, alone);
      },
      [&](std::size_t i, std::size_t slot) {
        auto& [strip, lines] = slots[slot];
        joiner.add(lines, strip, i + 1 == count);
        add_totals(strip, joiner, i == 0, i, totals);
        take(lines);
        context.report("contour", static_cast<double>(i + 1) / static_cast<double>(count));
      });
  return totals;
}

}  // namespace retalho
