// Terrains in as few bytes as their error allows: the compact form of the model file, and the fit that knows of its
// rounding (docs/compact-file.md, docs/algorithms/compact-model.md).
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct CompactOptions {
  SurfaceKind surface = SurfaceKind::clough_tocher;  ///< linear or clough_tocher
  bool heights_only = false;  ///< clough_tocher whose gradients are the facets' means: a flat TIN's bytes
  double max_error = 0;       ///< height units: every valid cell within it of the surface; 0: only the budget counts
  std::size_t vertices = 0;   ///< the budget, 0: none. With a budget and max_error the error may be larger
  double height_step = 0;     ///< 0: chosen, by max_error or else by the fit's own error
  double slope_weight = 0.1;  ///< as in LeastSquaresOptions; not of heights_only
  std::optional<bool> folds = {};  ///< clough_tocher: may vertices be folded (terrain/folded_surface.h)? If not, the
                                   ///< surface is smooth everywhere. Unset: with max_error yes, whatever it saves;
                                   ///< with a budget no. Not of heights_only
  Effort effort = Effort::normal;  ///< of the refinement
};

struct CompactModel {
  std::string bytes;  ///< the file
  Terrain terrain;    ///< what decode_model makes of it, to the bit
};

/// Refines a surface for the grid (terrain/surface_refine.h), rounds its numbers level by level while the fit of the
/// others goes on, and writes them. With max_error and no budget every valid cell is within max_error of what is read
/// from the file, as assess() finds: vertices are added, at the end with their cells' heights, until it is so. The same
/// bytes from any number of threads. Throws UsageError for options out of range, BadInput as refine_surface and for
/// what has no compact form. Cost: that of refine_surface and about 100 us a vertex and round of rounding (1 to 10).
CompactModel fit_compact(const Raster& raster, const CompactOptions& options, const Context& context = {});

/// The compact form of a terrain whose vertices are cells of `raster`, heights and gradients fitted anew while they are
/// rounded; its triangulation is taken to be the Delaunay one. `options` as above, but nothing is refined or added.
CompactModel compact_terrain(const Terrain& terrain, const Raster& raster, const CompactOptions& options,
                             const Context& context = {});

}  // namespace retalho
