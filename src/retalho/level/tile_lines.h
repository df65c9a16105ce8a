// Level lines of a surface that comes tile by tile (terrain/tile_source.h): never all of it in memory, nor all lines.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/contour.h"
#include "retalho/terrain/tile_source.h"

namespace retalho {

/// What must be known of all tiles before the first one is traced.
struct SurfaceRange {
  double low = 0, high = 0;  ///< as height_range of each tile
  double per_unit = 1;       ///< quanta a height unit of the fixed-point surface that is traced
  bool data = false;         ///< is there any?
};
/// Reads every tile once. Memory: `tiles.at_once` tiles.
SurfaceRange measure_range(const TileSource& tiles, const Context& context = {});

/// The lines of trace_contours on all tiles as one terrain, given to `take` when they end: those that end in the same
/// tile at once, by level. Pieces join across seams in the same bits; where a line crosses a seam it keeps a vertex
/// there, and is thinned on both sides by themselves: with options.simplify false the lines are trace_contours' to the
/// bit, with it both are as close to the level set. `range`: measure_range's. Returns the set without its lines.
/// Memory: tiles.at_once tiles, the lines of twice as many, and those that still go on. The same from any number of
/// threads. Throws as trace_contours.
ContourSet stream_contours(const TileSource& tiles, const SurfaceRange& range, std::vector<double> levels,
                           const ContourOptions& options, const TakeContours& take, const Context& context = {},
                           ContourStats* stats = nullptr);

/// The same, collected, and the bands where they are asked for: those of trace_contours on all tiles as one terrain, to
/// the bit with options.simplify false. Memory: tiles.at_once tiles; and the lines with the border of the valid area,
/// 16 bytes a point, with bands about ten times that, and one bit a cell of the whole grid where it has voids.
ContourSet trace_contours(const TileSource& tiles, const SurfaceRange& range, std::vector<double> levels,
                          const ContourOptions& options, const Context& context = {}, ContourExtras* extras = nullptr);

}  // namespace retalho
