// Level lines of smooth height surfaces, none missed and none crossing (docs/contours.md).
//
// The surface is first rounded to a fixed-point one (ContourSet::height_quantum); of that surface the lines are proved:
// every component of every level set has its line, lines are closed or end on the border of the valid area, lines never
// meet, and line and level set are within the tolerance of each other, both ways. Where a level set is singular (a
// saddle exactly on the level) the place is reported and decided alike on both sides.
#pragma once

#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/contours.h"
#include "retalho/terrain/bicubic.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct ContourOptions {
  double tolerance = 0;  ///< local units, > 0: no point of a line is farther from its level set, nor conversely
  bool simplify = true;  ///< thin the vertices, within the same tolerance and with the topology kept
};

/// How the work went.
struct ContourStats {
  std::size_t pairs = 0;      ///< (patch, level) pairs that the lines cross
  std::size_t certified = 0;  ///< of them, without any halving
  std::size_t boxes = 0, undecided_edges = 0, raw_points = 0;
  int depth = 0;  ///< of the deepest box
};

/// What else a call can give.
struct ContourExtras {
  ContourStats stats;
  bool want_bands = false;
  BandSet bands;  ///< where asked for
};

/// Levels from `base` by `interval` that lie in (low, high]. Throws BadInput for an interval that is not positive or
/// gives more than a million levels.
std::vector<double> contour_levels(double low, double high, double interval, double base = 0);

/// Throws BadInput unless the levels are finite and ascend, each given once.
void check_levels(const std::vector<double>& levels);

/// Lines of all `levels` (ascending, different, finite). Throws BadInput for a tolerance that is not positive, and for
/// levels closer than the surface's quantum. Cost: docs/contours.md, "Cost"; it grows with cells and with traced
/// vertices, memory too. The same bytes from any number of threads.
ContourSet trace_contours(const BicubicGrid& grid, std::vector<double> levels, const ContourOptions& options,
                          const Context& context = {}, ContourExtras* extras = nullptr);
/// The same for a grid that is not needed afterwards: its memory is given back as soon as may be.
ContourSet trace_contours(BicubicGrid&& grid, std::vector<double> levels, const ContourOptions& options,
                          const Context& context = {}, ContourExtras* extras = nullptr);

/// The lines of the bicubic surface of a grid (terrain/bicubic.h), given to `take` while the surface is made and
/// traced, from north to south: neither the surface nor the lines are ever held whole. Lines that end in the same 64
/// rows come at once, by level; all together they are those of trace_contours. Returns the set without its lines.
/// Memory beside the raster: about 130 rows of cells a thread at 70 bytes a cell, their lines, and the lines that still
/// go on; whatever the number of levels but for the latter. `take` is called in the calling thread; what it throws is
/// passed on. The surface is made twice, first to know how large its ordinates are.
ContourSet stream_contours(const Raster& raster, const BicubicOptions& surface, std::vector<double> levels,
                           const ContourOptions& options, const TakeContours& take, const Context& context = {},
                           ContourStats* stats = nullptr);
/// The same, collected: trace_contours without the memory of a whole surface.
ContourSet trace_contours(const Raster& raster, const BicubicOptions& surface, std::vector<double> levels,
                          const ContourOptions& options, const Context& context = {}, ContourStats* stats = nullptr);

/// The same on the surface of a terrain model, linear, Powell-Sabin or Clough-Tocher. Where the model's grid has cells
/// without data, lines and bands end on the border of those cells.
ContourSet trace_contours(const Terrain& terrain, std::vector<double> levels, const ContourOptions& options,
                          const Context& context = {}, ContourExtras* extras = nullptr);

}  // namespace retalho
