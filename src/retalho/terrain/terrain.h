// A terrain model: a height surface on a TIN, with all that is needed to evaluate it, draw it and write it down.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "retalho/bernstein/triangle.h"
#include "retalho/raster/georef.h"
#include "retalho/raster/mask.h"
#include "retalho/tin/tin.h"

namespace retalho {

enum class SurfaceKind : std::uint8_t { linear = 1, powell_sabin = 2, clough_tocher = 3 };
/// How Clough-Tocher sets the cross derivative at the middle of an edge (docs/mathematics.md, section 3).
enum class CrossDerivative : std::uint8_t {
  perpendicular = 0,  ///< the paper's: linear along the edge, perpendicular to it; quadratics exact
  cubic = 1,          ///< from the two triangles' data; cubics exact, one stored fallback bit an edge
};
enum class GradientKind : std::uint8_t { none = 0, normals = 1, quadratic = 2, network = 3, given = 4, fitted = 5 };

/// The grid that a model was made from: its size, cells and valid cells. Queries outside answer "no data".
struct GridDomain {
  int columns = 0, rows = 0;
  double cell_width = 1, cell_height = 1;  ///< local units
  Mask valid;                              ///< empty: every cell is valid

  /// Does the cell nearest to `p` hold data? A point half way between two cells belongs to the eastern or southern one.
  /// True everywhere for a model of scattered points.
  bool has_data(Vec2 p) const;
};

struct Terrain {
  SurfaceKind kind = SurfaceKind::linear;
  CrossDerivative cross_derivative = CrossDerivative::perpendicular;
  GradientKind gradient_kind = GradientKind::none;
  Georef georef;
  GridDomain grid;  ///< columns == 0: made from scattered points, valid on the triangulation
  Tin tin;
  std::vector<Vec2> gradients;  ///< one a vertex (dz/dx, dz/dy in local units); with creases more; empty for linear
  /// Edges that the surface folds along: numbers of build_edges, ascending; empty for linear. A vertex where creases
  /// part its triangles into sectors has a gradient for each (terrain/creases.h).
  std::vector<std::uint32_t> creases;
  std::vector<std::array<std::uint32_t, 3>> corner_gradients;  ///< which gradient each corner has: crease_sectors of
                                                               ///< the creases, kept for speed; empty: the vertex's
  std::vector<double>
      edge_split;  ///< Powell-Sabin: lambda of each edge from its lower-index end, by build_edges' order
  std::vector<std::uint8_t> edge_fallback;  ///< cubic Clough-Tocher: 1 where the edge falls back to perpendicular
  double tolerance = 0;                     ///< the max_error asked for; 0: none
};

/// The gradient's number at a corner of a triangle.
inline std::uint32_t gradient_of(const Terrain& terrain, std::uint32_t triangle, std::size_t corner) {
  return terrain.corner_gradients.empty() ? terrain.tin.triangles[triangle][corner]
                                          : terrain.corner_gradients[triangle][corner];
}

/// One polynomial piece: a triangle and its ordinates (the first ordinate_count(degree) of `ordinates`).
struct TerrainPatch {
  std::array<Vec2, 3> corners;  ///< counter-clockwise, local coordinates
  int degree = 1;
  std::array<double, 10> ordinates{};  ///< in bernstein/triangle.h's order
};

/// Pieces a triangle: 1 linear, 6 Powell-Sabin, 3 Clough-Tocher.
int patches_per_triangle(SurfaceKind kind);

/// Powell-Sabin, Clough-Tocher or linear pieces of one triangle of the TIN. `edges` is build_edges(terrain.tin).
/// Neighbouring triangles get the same ordinates on a shared edge, to the last bit.
/// Writes patches_per_triangle(kind) pieces into `out` and returns how many.
int triangle_patches(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle,
                     std::array<TerrainPatch, 6>& out);

/// "powell-sabin" and so on, as the program spells them.
const char* surface_name(SurfaceKind kind);
const char* gradient_name(GradientKind kind);
const char* cross_derivative_name(CrossDerivative rule);
/// The inverse: nullopt for a word that is no such name.
std::optional<SurfaceKind> parse_surface(std::string_view name);
std::optional<GradientKind> parse_gradients(std::string_view name);
std::optional<CrossDerivative> parse_cross_derivative(std::string_view name);

/// How many numbers a plain table of the model stores: x, y and coefficients of each vertex; which edges are creases.
std::size_t number_count(const Terrain& terrain);
/// Coefficients alone: 1 a vertex for linear, 3 for the smooth kinds.
std::size_t coefficient_count(const Terrain& terrain);

}  // namespace retalho
