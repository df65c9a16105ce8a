// A grid's surface that folds along lines which are known: ridges of roofs, shores, kerbs.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct CreaseLineNotes {
  std::size_t lines = 0;     ///< parts of lines inside the grid
  std::size_t vertices = 0;  ///< put on them
  std::size_t edges = 0;     ///< that the surface may fold along
};

/// As refine_surface with the budget `options.vertices`, of which the lines get theirs: one at every place of theirs
/// and as many between as vertices elsewhere are apart. Triangles keep to the lines, all edges along them are creases,
/// and heights and gradients of all sectors are fitted to all valid cells. `lines`: local coordinates; what lies
/// outside of the box of the valid cells is cut off, and what is within a thousandth of a cell of each other is one:
/// lines may run over each other, with vertices of their own. Vertices within half a cell of a line give way to it. The
/// numbers are those of the vertices, one for each crease and two for each further sector. The same from any number of
/// threads. Throws as refine_surface and triangulate_points, UsageError for a tolerance, a flat surface, or lines that
/// need more vertices than the budget has, BadInput where no line is inside.
Terrain refine_along_lines(const Raster& raster, std::span<const std::vector<Vec2>> lines,
                           const SurfaceRefineOptions& options, CreaseLineNotes* notes = nullptr,
                           const Context& context = {});

}  // namespace retalho
