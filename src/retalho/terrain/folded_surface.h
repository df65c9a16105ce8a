// Surfaces with folded vertices: at such a vertex the surface follows the plane of each of its triangles, as the flat
// surface does, and elsewhere it is as smooth as ever. It needs a height there and no gradient. In a terrain it has
// creases along all edges of folded vertices (terrain/creases.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tin/grid_cell.h"

namespace retalho {

/// What a terrain says about folds.
struct FoldedSurface {
  std::vector<std::uint32_t> creases;
  std::vector<Vec2> gradients;  ///< of each sector, the vertices' first
  std::vector<std::array<std::uint32_t, 3>> sectors;
};

/// `folded`, `gradients`: of each vertex, in local units; the gradients of folded vertices do not matter. `tin` knows
/// its neighbours.
FoldedSurface folded_surface(const Tin& tin, std::span<const std::uint8_t> folded, std::span<const Vec2> gradients);

/// Vertices of a surface, ascending, and which of them are folded (1).
struct FoldedVertices {
  std::vector<greedy::Cell> cells;
  std::vector<std::uint8_t> folded;
};

/// The vertices that refine_surface (surface_refine.h) chooses where any vertex of a Clough-Tocher surface may be
/// folded, at the price of a height alone: it is where that costs the fit less than a gradient's two numbers would save
/// elsewhere. Not with options.creases or heights_only. Throws as refine_surface.
FoldedVertices refine_folded(const Raster& raster, const SurfaceRefineOptions& options, const Context& context = {});

}  // namespace retalho
