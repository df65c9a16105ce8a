#include "retalho/level/strip_lines.h"

#include <algorithm>
#include <utility>

#include "retalho/core/in_order.h"
#include "retalho/level/line_joiner.h"
#include "retalho/level/simplify.h"

namespace retalho {
namespace {

struct Slot {
  BicubicGrid scratch;
  FixedGrid rows;
  GridStrip strip;
  RawLines lines;
};

void add_totals(GridStrip& strip, const LineJoiner& joiner, int index, StripTotals& totals) {
  const bool first = index == 0;
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
    if (!first && edge.horizontal && edge.row == index * kStripRows) continue;
    for (BorderRoot& root : edge.roots) root.point = joiner.joined(root.point);
    totals.border.push_back(std::move(edge));
  }
}

/// `rows_of(i, slot)`: the grid with the rows of strip i and those around it that chords may reach.
template <class RowsOf>
StripTotals trace_all(int patch_rows, const FixedLevels& levels, const ContourOptions& options, double raw,
                      bool want_border, const Context& context, const RowsOf& rows_of,
                      const std::function<void(RawLines& lines)>& take) {
  StripTotals totals;
  LineJoiner joiner;
  const std::size_t count = strip_count(patch_rows);
  std::vector<Slot> slots(std::min(slot_count(context), std::max<std::size_t>(count, 1)));
  const Context alone{.threads = 1, .cancel = context.cancel};
  parallel_in_order(
      count, context,
      [&](std::size_t i, std::size_t s) {
        Slot& slot = slots[s];
        const FixedGrid& grid = rows_of(static_cast<int>(i), slot, alone);
        trace_strip(grid, levels, raw, static_cast<int>(i), want_border, slot.strip, alone);
        slot.lines.raw = raw;
        slot.lines.set.tolerance = options.tolerance;
        gather_lines(slot.strip.trace, slot.lines, alone);
        if (options.simplify) simplify_lines(slot.lines, grid, levels, alone);
      },
      [&](std::size_t i, std::size_t s) {
        Slot& slot = slots[s];
        joiner.add(slot.lines, slot.strip, i + 1 == count);
        add_totals(slot.strip, joiner, static_cast<int>(i), totals);
        take(slot.lines);
        context.report("contour", static_cast<double>(i + 1) / static_cast<double>(count));
      });
  return totals;
}

}  // namespace

StripTotals trace_strips(const FixedGrid& grid, const FixedLevels& levels, const ContourOptions& options, double raw,
                         bool want_border, const Context& context, const std::function<void(RawLines& lines)>& take) {
  const auto whole = [&](int, Slot&, const Context&) -> const FixedGrid& { return grid; };
  return trace_all(grid.rows - 1, levels, options, raw, want_border, context, whole, take);
}

StripTotals trace_strips(const FixedRows& rows, const FixedLevels& levels, const ContourOptions& options, double raw,
                         const Context& context, const std::function<void(RawLines& lines)>& take) {
  // The rectangle around a chord goes no farther than the tolerance beyond the strip; a row more is asked for voids.
  const double reach = options.tolerance / rows.cell_height();
  const int around = reach < rows.rows() ? static_cast<int>(reach) + 3 : rows.rows();
  const auto some = [&](int i, Slot& slot, const Context& alone) -> const FixedGrid& {
    const int first = std::max(0, i * kStripRows - around);
    const int last = std::min(rows.rows(), (i + 1) * kStripRows + 1 + around);
    rows.make(first, last, slot.scratch, slot.rows, alone);
    return slot.rows;
  };
  return trace_all(rows.rows() - 1, levels, options, raw, false, context, some, take);
}

}  // namespace retalho
