// Internal to level/: the lines of a grid, strip by strip. Strips are traced and thinned by all threads at once, each
// while it is in the processor's caches; one after the other their lines are joined, and given on when they end, so
// that no more is held than a few strips and the lines that still go on.
//
// Where a line crosses the row between two strips it keeps its vertex there; its chords are judged one by one
// (level/simplify.h), so a vertex more changes nothing else.
#pragma once

#include <functional>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/contour.h"
#include "retalho/level/fixed_grid.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/raw_lines.h"
#include "retalho/level/trace_grid.h"

namespace retalho {

/// What is known when all strips have been traced.
struct StripTotals {
  ContourStats stats;
  std::vector<SingularPlace> singular;
  std::vector<BorderEdge> border;  ///< where asked for; points are numbered through all strips
};

/// Gives the lines of all levels, complete, to `take`: set.points, set.lines and ends, numbered through all strips;
/// those that end in the same strip at once, by level, then by start. `raw`: how close chords are traced; with
/// options.simplify they are thinned to options.tolerance. The same from any number of threads.
StripTotals trace_strips(const FixedGrid& grid, const FixedLevels& levels, const ContourOptions& options, double raw,
                         bool want_border, const Context& context, const std::function<void(RawLines& lines)>& take);
/// The same of a surface of which no more is made than the strips in hand.
StripTotals trace_strips(const FixedRows& rows, const FixedLevels& levels, const ContourOptions& options, double raw,
                         const Context& context, const std::function<void(RawLines& lines)>& take);

}  // namespace retalho
