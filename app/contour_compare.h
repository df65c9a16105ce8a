// retalho contour --compare-surfaces: the lines of several surfaces through the same samples, side by side.
#pragma once

#include <string>
#include <vector>

#include "program.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tin/breaklines.h"

namespace retalho::app {

struct SurfaceComparison {
  std::string output;          ///< .png, .svg or .pdf
  int zoom = 48;               ///< cells a side that are shown, from the grid's middle; 0: all
  std::vector<double> levels;  ///< of all the surface
  std::vector<bool> index;     ///< one a level
  double tolerance = 0;        ///< local units
};

/// The part of a grid that is shown: `zoom` cells a side around the middle, or all.
Raster middle_of(const Raster& raster, int zoom);

/// Every surface that grids can have: linear, Powell-Sabin and Clough-Tocher on all cells, and the bicubic surface with
/// each twist, with natural ends, and ringing. Returns the names drawn. Throws UsageError for more than a million
/// cells.
std::vector<std::string> compare_grid_surfaces(const Program& program, const Raster& raster,
                                               const SurfaceComparison& comparison, const Context& context);
/// The same for survey points: linear, Powell-Sabin, and Clough-Tocher with each kind of gradients.
std::vector<std::string> compare_point_surfaces(const Program& program, const ConstrainedTin& tin, const Georef& georef,
                                                const SurfaceComparison& comparison, const Context& context);

}  // namespace retalho::app
