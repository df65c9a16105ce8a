// Refinement of a grid's surface by the surface's own error: the vertices are chosen for the smooth surface itself, not
// for the flat triangulation under it (docs/algorithms/smooth-fit.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// How long the vertices are moved about: none of it, some, or much. What it costs: docs/smooth.md.
enum class Effort : std::uint8_t { fast, normal, best };

/// "fast", "normal", "best", and back; nullopt for another word.
const char* effort_name(Effort effort);
std::optional<Effort> parse_effort(std::string_view name);

struct SurfaceRefineOptions {
  SurfaceKind surface = SurfaceKind::clough_tocher;
  double max_error = 0;       ///< height units: every valid cell within it of the surface; 0: only the budget counts
  std::size_t vertices = 0;   ///< the budget, 0: none; with both, whichever comes first. At least the corners of the
                              ///< valid cells' box are vertices
  int relocations = 3;        ///< sweeps of relocation after the last vertex (Effort::normal)
  int exchanges = 5;          ///< rounds of removal and re-insertion, each followed by a relocation
  bool heights_only = false;  ///< gradients follow the heights, as in LeastSquaresOptions; for smooth kinds, by a
                              ///< budget. The vertices are those that the flat surface chooses: the best that are known
  double growth = 0.25;       ///< of the number of vertices a round
  double slope_weight = 0.1;  ///< as in LeastSquaresOptions
  double fairness = 1e-5;
  bool creases = false;  ///< edges may be creases in place of vertices, where that lowers the objective and the
                         ///< RMSE: no more numbers than `vertices` have without; smooth surfaces, a budget alone
};

/// The same with the relocations and exchanges of an effort.
SurfaceRefineOptions with_effort(SurfaceRefineOptions options, Effort effort);

/// Vertices are cells, inserted at the centroids of the squared errors, moved, removed and inserted elsewhere; heights
/// and gradients of all are fitted to all valid cells after each step, and no exchange or relocation that makes the
/// objective larger is kept. The triangulation is Delaunay in cell coordinates. The same result from any number of
/// threads. With max_error and no budget every valid cell is within max_error of the surface, as assess() finds;
/// refinement always ends, at the latest when every cell is a vertex with its own height. One of max_error and vertices
/// must be given. Throws BadInput as refine_grid, UsageError for options out of range or that exclude each other,
/// Interrupted.
Terrain refine_surface(const Raster& raster, const SurfaceRefineOptions& options, const Context& context = {});

/// A vertex on a side of the grid that is settled before the inside is refined.
struct SideVertex {
  int column = 0, row = 0;  ///< a valid cell
  bool held = false;        ///< height and gradient stay as well, to the last bit; else they are fitted
  double height = 0;
  Vec2 gradient;  ///< height units per local unit; unused by linear surfaces
};

/// refine_surface to a budget with some of the grid's sides settled: `frozen` (north, west, south, east) sides have the
/// vertices given, and no others but corners of the valid cells' hull; so grids that share a side agree along it. The
/// outline is the hull of the valid cells, as refine_grid's. For linear and Clough-Tocher surfaces: an edge of a
/// Powell-Sabin one depends on the triangles on both of its sides. Throws as refine_surface, and UsageError for options
/// that need more than a budget.
Terrain refine_inside(const Raster& raster, std::span<const SideVertex> sides, const std::array<bool, 4>& frozen,
                      const SurfaceRefineOptions& options, const Context& context = {});

}  // namespace retalho
