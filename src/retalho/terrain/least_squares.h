// Heights and gradients of a surface's vertices fitted to all cells of the grid that it stands for.
//
// The fit minimises, over the unknowns of all vertices at once,
//   sum_k (S(x_k) - z_k)^2 + slope_weight sum_k |grad S(x_k) - D z_k|^2 + fairness int (Sxx^2 + 2 Sxy^2 + Syy^2)
// over the valid cells k, lengths counted in cells (anisotropic cells: in square roots of a cell's area); D z are
// central differences, over cells whose four neighbours are valid. The bending of a triangle whose smallest height h is
// less than a cell counts h^4 times: else one step under an outline that is not convex outweighs the cells. Every
// ordinate of the surface is a linear function of the 9 unknowns of its triangle, so the problem is a sparse symmetric
// system of 3 x 3 blocks, solved by conjugate gradients; no row a cell is stored (docs/algorithms/smooth-fit.md).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct LeastSquaresOptions {
  bool heights_only = false;  ///< z-only: gradients follow the heights as GradientKind::normals, so that the model
                              ///< needs no more numbers than a flat one
  double slope_weight = 0.1;  ///< 0 or more; not used by linear surfaces
  double fairness = 1e-5;     ///< 0 or more; not used by linear surfaces
  double tolerance = 1e-7;    ///< where conjugate gradients stop, relative
  int iterations = 1000;      ///< and after how many steps at most
  /// One mark a vertex: 1: its height and gradient stay, to the last bit. Empty: none does. Not with heights_only.
  std::span<const std::uint8_t> held = {};
  bool slopes_across_creases = false;  ///< central differences count even where a crease lies between the cells
};

struct LeastSquaresNotes {
  int iterations = 0;
};

/// The terrain with fitted heights (linear), heights and gradients (smooth kinds: GradientKind::fitted) or,
/// heights_only, heights whose gradients are GradientKind::normals of them. The triangulation stays as it is. Vertices
/// that no cell speaks for stay where they are. The result is finite, never worse by the objective than the start, and
/// the same from any number of threads. `terrain` must have been made from `raster` (same cells), on a TIN with a
/// convex outline, as refine_tin makes it, or a part of such a TIN (then some cells on its inner outline count in no
/// triangle). With creases every sector's gradient is fitted, and both sides' slopes along a crease stay the same.
/// Throws UsageError for negative weights, marks of another number, or creases with heights_only, BadInput for another
/// grid, or for the cubic rule of Clough-Tocher, whose pieces depend on more than their own triangle's corners. Cost:
/// about 0.3 us a cell and 20 us a vertex on one thread; memory: 8 bytes a cell and about 2 kB a vertex.
Terrain fit_least_squares(Terrain terrain, const Raster& raster, const LeastSquaresOptions& options = {},
                          const Context& context = {}, LeastSquaresNotes* notes = nullptr);

/// How the vertices of a grid's triangulation get their data: heights as the grid has them and estimated gradients,
/// or fitted to every cell.
enum class FitKind : std::uint8_t { interpolate, least_squares, z_only };
/// Their names, in the same order.
inline constexpr std::array<const char*, 3> kFitNames{"interpolate", "least-squares", "z-only"};
/// make_terrain of a grid's triangulation and, unless it interpolates, the fit.
Terrain make_fitted(Tin tin, const Raster& raster, const SurfaceOptions& surface, FitKind fit,
                    const Context& context = {});

}  // namespace retalho
