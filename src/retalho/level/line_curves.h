// Contour lines as cubic Bézier curves that do not meet, for drawings.
//
// Promises: curve and traced line are within the tolerance of each other, both ways (each piece is proved when it is
// fitted); no two pieces of any line meet but neighbours at their joint (every pair is proved apart, on the very
// numbers that are given back); neighbouring curves share their tangent unless the traced line has a corner between
// them. Where a curve would break this, the line is followed closer; where that does not help either, the traced
// straight pieces stand instead, and are counted.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/contours.h"
#include "retalho/level/cubic.h"

namespace retalho {

struct CurvePiece {
  Cubic points;
  bool straight = false;  ///< a side of the traced line, as it was
};

/// Pieces [begin, end) of the set, each starting where the one before ends; a closed line's last ends where it starts.
struct CurveLine {
  int level = 0;
  bool closed = false;
  std::size_t begin = 0, end = 0;
};

struct CurveSet {
  std::vector<CurvePiece> pieces;
  std::vector<CurveLine> lines;  ///< as in the contour set; lines without length are left out
  std::size_t straight = 0;      ///< pieces that fell back to the traced line
  std::size_t corners = 0;       ///< joints without a common tangent that the traced lines have
  std::size_t unproved = 0;      ///< pairs of traced sides that no rule could tell apart (at most rounding's size)
};

struct CurveOptions {
  double tolerance = 0;  ///< > 0: curve and traced line are this close, both ways; the set's units
  double traced = 0;     ///< > 0: how close the traced line's sides are to the level line: tells corners from bends
  double per_unit = 0;   ///< all numbers are whole multiples of 1 / per_unit (the set's are, already); 0: as they come
};

/// Curves for every line of `lines`, which should hold the traced vertices, not thinned. Throws BadInput for a
/// tolerance that is not positive. Cost: about 2 us a vertex and 5 us a piece. The same bytes from any number of
/// threads.
CurveSet fit_line_curves(const ContourSet& lines, const CurveOptions& options, const Context& context = {});

}  // namespace retalho
