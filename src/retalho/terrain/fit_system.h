// The normal equations of a surface on a mesh: a symmetric matrix of blocks, one a vertex and one an edge.
// Internal to terrain/.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/terrain/conjugate_gradients.h"
#include "retalho/terrain/fit_element.h"

namespace retalho {

using TriangleList = std::span<const std::array<std::uint32_t, 3>>;

/// Who shares a triangle with whom: for each vertex itself and its neighbours, ascending, and the triangles around it.
struct FitPattern {
  std::vector<std::uint32_t> begin, vertex;          ///< row v: vertex[begin[v]] up to begin[v + 1]
  std::vector<std::uint32_t> star_begin, triangles;  ///< triangles around v, ascending

  FitPattern(TriangleList triangles, std::size_t vertices, const Context& context);
  std::size_t vertices() const { return begin.size() - 1; }
  std::uint32_t slot(std::uint32_t row, std::uint32_t column) const;
};

/// Marks of a vertex whose numbers are not to be solved for.
inline constexpr std::uint8_t kHeldHeight = 1, kHeldGradient = 2;

struct FitSolveOptions {
  CgLimits limits;
  bool heights_only = false;               ///< gradients follow the heights as the mean of the facets, weighted by area
  std::span<const std::uint8_t> pinned{};  ///< of each vertex: what stays of it (kHeldHeight, kHeldGradient)
};

class CreasedUnknowns;

/// Minimises the sum of the elements' costs over heights (and gradients) of all vertices, starting from `data`.
/// Vertices that no cell speaks for stay. Returns the iterations. `points`: the vertices in units of the fit.
int solve_fit(SurfaceKind kind, TriangleList triangles, std::span<const FitElement> elements,
              std::span<const Vec2> points, std::vector<Vec3>& data, const FitSolveOptions& options,
              const Context& context);

/// The same for a smooth surface with creases, over the heights of the vertices and the gradients of the sectors: one
/// entry of `data` a node, of which later sectors' heights stay. `options.pinned`: one mark a vertex, for all its
/// sectors. Not for heights_only.
int solve_creased(const CreasedUnknowns& unknowns, std::span<const FitElement> elements, std::vector<Vec3>& data,
                  const FitSolveOptions& options, const Context& context);

}  // namespace retalho
