// A triangulated irregular network: vertices with heights, counter-clockwise triangles, and who touches whom.
// It knows local coordinates (raster/georef.h) only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/core/vec.h"

namespace retalho {

inline constexpr std::uint32_t kNone = 0xffffffffU;

struct Tin {
  std::vector<Vec2> points;
  std::vector<double> heights;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< vertex indices, counter-clockwise
  std::vector<std::array<std::uint32_t, 3>> neighbors;  ///< triangle across the edge opposite corner k; kNone: border

  std::size_t vertex_count() const { return points.size(); }
  std::size_t triangle_count() const { return triangles.size(); }
};

/// Undirected edges, numbered by the first triangle corner that meets them (triangle order, then corner order): a rule
/// that depends on `triangles` alone, so that per-edge data in a file need no indices.
struct EdgeTable {
  std::vector<std::array<std::uint32_t, 2>> vertices;     ///< low index first
  std::vector<std::array<std::uint32_t, 2>> triangles;    ///< the one or two triangles; kNone second: border
  std::vector<std::array<std::uint32_t, 3>> of_triangle;  ///< edge opposite corner k of each triangle
};
EdgeTable build_edges(const Tin& tin);

/// Fills `neighbors` from `triangles`. Throws BadInput for an edge with more than two triangles or two triangles that
/// run along it in the same direction, an index out of range, or a triangle that names a vertex twice.
void build_neighbors(Tin& tin);

}  // namespace retalho
