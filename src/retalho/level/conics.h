// Level lines of Powell-Sabin surfaces as what they are: chains of conics, not polylines.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/curve/curve.h"
#include "retalho/raster/georef.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// One line: rational quadratic segments in local coordinates (the plane), high ground on the left. As with
/// ContourLine, an open one starts and ends on the border.
struct ConicLine {
  int level = 0;  ///< index into the levels
  Curve curve;
};

struct ConicSet {
  std::vector<double> levels;
  std::vector<ConicLine>
      lines;  ///< by level, then by where they start; one for each line of trace_contours (with voids: but for touches)
  double height_quantum = 0;  ///< heights were rounded to multiples of this before tracing
};

/// The lines of all `levels` (ascending, different, finite) of a Powell-Sabin surface. The topology is decided as in
/// trace_contours; each segment is the level line of one piece of the rounded surface, to the rounding of doubles: none
/// turns by more than 60 degrees, none lies in two pieces. Lines of a linear surface are segments with straight control
/// points. Where the model's grid has no data the lines end, on the sides of cells. Throws BadInput: a Clough-Tocher
/// surface (its lines are cubics), levels as in trace_contours. Cost: tracing as trace_contours does, and 108 bytes a
/// segment. The same bytes from any number of threads.
ConicSet trace_conics(const Terrain& terrain, std::vector<double> levels, const Context& context = {});

/// The same curves in the coordinates of the CRS: lines that are conics stay conics.
void move_to_crs(ConicSet& set, const Georef& georef);

}  // namespace retalho
