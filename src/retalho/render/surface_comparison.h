// The level lines of several surfaces through the same samples, side by side: to choose one by.
#pragma once

#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/render/curve_picture.h"
#include "retalho/tin/breaklines.h"

namespace retalho {

struct SurfaceComparison {
  std::vector<double> levels;  ///< ascending
  std::vector<bool> index;     ///< one a level: drawn thicker
  double tolerance = 0;        ///< of the lines, local units
};

/// A panel a surface, captioned with its name.
struct ComparedSurfaces {
  CurvePicture picture;
  std::vector<std::string> names;
};

/// The part of a grid that is shown: `zoom` cells a side around the middle, or all where that is 0.
Raster middle_of(const Raster& raster, int zoom);

/// Every surface that grids can have: linear, Powell-Sabin and Clough-Tocher on all cells, and the bicubic surface with
/// each twist, with natural ends, and ringing. Throws UsageError for more than a million cells.
ComparedSurfaces compare_grid_surfaces(const Raster& raster, const SurfaceComparison& comparison,
                                       const Context& context = {});
/// The same for survey points: linear, Powell-Sabin, and Clough-Tocher with each kind of gradients.
ComparedSurfaces compare_point_surfaces(const ConstrainedTin& tin, const Georef& georef,
                                        const SurfaceComparison& comparison, const Context& context = {});

}  // namespace retalho
