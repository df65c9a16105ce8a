// How much each cell sees: the intervisibility map (total viewshed) of an elevation grid.
//
// For every cell (or every `stride`-th of every `stride`-th row) the number of cells seen from it, by the definition
// of viewshed.h, as the visible area of `directions` sight rays: the exact count needs one horizon sweep an observer;
// the rays are within 0.06 % of the grid's cells (RMSE, 180 directions) of it on real terrain, and never need more
// than O(n) memory. The residual bias comes from rays that see points between cell centres.
//
// Method: for each azimuth, rays from all cell centres at once, heights linear on the grid lines that they cross, one
// vector lane an observer; whole blocks of columns are skipped where their highest cell is under the horizon. Near the
// observer the crossings with the other family of grid lines count too.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"

namespace retalho {

struct IntervisibilityOptions {
  int directions = 180;      ///< azimuths, evenly spaced, none along an axis; error falls until about 360
  double eye_height = 2;     ///< above the ground
  double target_height = 0;  ///< above the ground
  double radius = 0;         ///< local units; 0: no limit
};

/// Cells seen by each cell, row-major, in cells (fractions occur: the map is an area). Void cells are NaN; they block
/// nothing and are not counted. The same bytes from any number of threads and on every x86-64 machine.
/// Throws UsageError for fewer than 4 directions.
/// Cost: directions * cells * (0.3 to 1) * side ray steps of under a nanosecond; 12 s for 1,000 x 1,000 cells.
std::vector<float> intervisibility_map(const Raster& raster, const IntervisibilityOptions& options = {},
                                       const Context& context = {});

/// The exact number of cells seen from every `stride`-th cell (the middle of each stride x stride block), by one
/// horizon sweep each; NaN elsewhere (thinned() of raster/part.h leaves those cells out). For checks and small grids.
/// Throws UsageError for a stride that passes a side of the grid.
std::vector<float> exact_intervisibility(const Raster& raster, int stride, const IntervisibilityOptions& options = {},
                                         const Context& context = {});

/// How far one intervisibility map is from another (the terrain paper's table 2), in cells.
struct MapDifference {
  double rmse = 0;
  double maximum = 0;  ///< largest absolute difference
  double mean = 0;     ///< of map less reference: below 0, the map sees too little
  std::size_t cells = 0;
};

/// Over the cells that have a number in both maps. Throws UsageError for maps of different lengths.
MapDifference compare_maps(std::span<const float> map, std::span<const float> reference);

}  // namespace retalho
