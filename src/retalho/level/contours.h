// Contour lines and bands: what a tracer gives and a writer takes. Local coordinates (raster/georef.h).
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "retalho/core/vec.h"

namespace retalho {

/// One line: points [begin, end) of the set. High ground lies on its left. A closed line does not repeat its first
/// point; an open one starts and ends on the border of the valid area.
struct ContourLine {
  int level = 0;  ///< index into `levels`
  bool closed = false;
  std::size_t begin = 0, end = 0;
};

/// A place where the level set is singular down to 2^-15 of a patch (a saddle or a tangency exactly on the level):
/// there the lines are joined by a rule instead of a proof, the same on both sides.
struct SingularPlace {
  int level = 0;
  Vec2 low, high;  ///< the box
};

struct ContourSet {
  std::vector<double> levels;      ///< heights, ascending
  std::vector<Vec2> points;        ///< of all lines, one behind the other
  std::vector<ContourLine> lines;  ///< by level, then by where they start
  std::vector<SingularPlace> singular;
  double tolerance = 0;       ///< every point of a line is this close to the level line, and conversely; local units
  double height_quantum = 0;  ///< heights were rounded to multiples of this before tracing
};

/// Takes lines, complete, with their levels. Not kept after the call.
using TakeContours = std::function<void(const ContourSet& lines)>;

/// A ring of a band's border: it does not repeat its first point; outer rings run counter-clockwise, holes clockwise.
struct BandRing {
  std::vector<Vec2> points;
};

/// A connected region between two neighbouring levels.
struct BandPolygon {
  int band = 0;  ///< 0: below levels[0]; k: from levels[k - 1] to levels[k]; levels.size(): above the last
  BandRing outer;
  std::vector<BandRing> holes;
};

/// All regions; together they cover the valid area exactly once, and their borders are the lines' own coordinates.
struct BandSet {
  std::vector<double> levels;
  std::vector<BandPolygon> polygons;  ///< by band
};

}  // namespace retalho
