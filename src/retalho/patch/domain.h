// Triangulations of the parameter triangle: regular, with a count of its own on each side, or given.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"

namespace retalho {

/// Nodes (u, v) and counter-clockwise triangles that cover the parameter triangle. Nodes of a side lie exactly on it
/// (u == 0, v == 0, u + v == 1 in doubles), and no edge but its own joins two nodes of one side.
struct Domain {
  std::vector<Vec2> parameters;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::array<std::vector<std::uint32_t>, 3> sides;  ///< the nodes of each side from its start to its end
};

/// n edges a side: (n+1)(n+2)/2 nodes in the order of transfinite_grid, n^2 triangles. Throws UsageError: n under 1 or
/// over 10,000.
Domain regular_domain(std::size_t n);

/// How a triangle with different counts a side is cut.
enum class DomainLayout {
  delaunay,  ///< any counts: the mean spacing inside, Delaunay (exact predicates); 2 V - 2 - B triangles
  midpoint,  ///< three grids about a point; asks for an even sum, and each count under the sum of the other two
};

/// counts[i] edges on side i, nodes at s = k / counts[i]. Three equal counts give regular_domain with either layout.
/// Throws UsageError: counts under 1 or over 10,000, or for `midpoint` no whole numbers of rows.
Domain make_domain(const std::array<std::size_t, 3>& counts, DomainLayout layout = DomainLayout::delaunay,
                   const Context& context = {});

}  // namespace retalho
