// Parameters for a triangle mesh that came without: Floater's convex combinations on the parameter triangle
// (Floater 1997, "Parametrization and smooth approximation of surface triangulations"; Floater 2003, "Mean value
// coordinates"; docs/triangular-patches.md, "Parameters").
//
// Three corners of the mesh's border go to U, V, W, the border between them by arc length onto the sides; every inner
// node is a positive mean of its neighbours. With no inner edge between two nodes of one side (such edges are split
// first) the map is one to one: no triangle turns over, ever.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/patch/patch.h"

namespace retalho {

/// Both are positive and reproduce plane meshes exactly (up to an affine map).
enum class Weights { shape_preserving, mean_value };

/// Is it a triangulated disk? Throws BadInput that says what is wrong and where: an index out of range, a corner named
/// twice, an edge of no length, an edge of more than two triangles, two triangles that are oriented against each other,
/// a node where two parts touch, nodes without triangles, several parts, no border, holes, handles.
/// Returns the border, counter-clockwise seen from outside, from its smallest vertex on.
std::vector<std::uint32_t> check_disk(std::span<const Vec3> positions,
                                      std::span<const std::array<std::uint32_t, 3>> triangles);

/// The three sharpest turns of the border, in its order, the smallest vertex first.
std::array<std::uint32_t, 3> find_corners(std::span<const Vec3> positions, std::span<const std::uint32_t> border);

struct ParameterizeOptions {
  Weights weights = Weights::mean_value;
  std::optional<std::array<std::uint32_t, 3>> corners = {};  ///< vertices of the border, in any order; the first is U
};

struct Parameterization {
  Domain domain;                ///< of the mesh's vertices in their order, then those of split edges
  std::vector<Vec3> positions;  ///< of all of them
  std::size_t split_edges = 0;  ///< inner edges between two nodes of one side, which got a node in their middle
  int iterations = 0;           ///< of the solver; 0: solved directly
};

/// Throws as check_disk; BadInput for corners that are not three vertices of the border, and where inner nodes come so
/// close that doubles cannot keep their triangles apart (a chimney on a thin neck), with the place.
/// Cost: about 3 us a triangle, 300 bytes a triangle.
Parameterization parameterize(std::span<const Vec3> positions, std::span<const std::array<std::uint32_t, 3>> triangles,
                              const ParameterizeOptions& options = {}, const Context& context = {});

/// A patch of it: sides are cubic splines through the border's nodes.
Patch patch_of(Parameterization parameterization, Recovery recovery = Recovery::smooth);

}  // namespace retalho
