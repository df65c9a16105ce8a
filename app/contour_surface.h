// retalho contour: the surface that is traced, out of a grid, points or a model.
#pragma once

#include <optional>
#include <string>

#include "breaklines.h"
#include "fitting.h"
#include "inputs.h"
#include "program.h"
#include "retalho/level/tile_lines.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/bicubic.h"
#include "retalho/terrain/terrain.h"

namespace retalho::app {

struct SurfaceChoice {
  std::string input, kind, twist = "spline", ends = "not-a-knot";
  bool ring = false;
  bool whole = false;   ///< a grid's surface will be made whole: for bands, conics and map sheets
  bool joined = false;  ///< and the tiles of a tiled model will be joined: for conics and map sheets
  GridFlags grid;
  PointOptions points;
  BreaklineFlags breaklines;
  BudgetFlags budget;
  TileMemoryFlag tile_memory;
};

/// What is traced: one of the three, and what its reader knew.
struct TracedSurface {
  std::optional<Raster> raster;  ///< of which the bicubic surface is made
  BicubicOptions bicubic;
  std::optional<Terrain> terrain;
  std::optional<TileSource> tiles;  ///< a tiled model that is not made whole
  SurfaceRange range;               ///< of it
  double low = 0, high = 0;         ///< of the samples; the surface may go a little beyond
  double cell = 0;                  ///< size of a cell, or of a triangle's edge; local units
  std::string height_unit;
  const Georef& georef() const { return raster ? raster->georef : tiles ? tiles->georef : terrain->georef; }
};

/// Reads the input and makes its surface. Throws UsageError for options that do not go together.
TracedSurface load_surface(const Program& program, const SurfaceChoice& options, const Context& context);

/// The mean length of the triangles' edges, local units.
double mean_edge(const Tin& tin);

}  // namespace retalho::app
