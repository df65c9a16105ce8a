// The Clough-Tocher surface as the compact form predicts with it, and the gradients of least bending: part of the
// format (docs/compact-file.md), written out here so that a file does not depend on how terrain/ computes the same.
// Every operation is one of IEEE 754's exactly rounded ones in the order of the source, so every machine predicts the
// same bits. Internal to the room.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/vec.h"

namespace retalho {

/// Height, d/dx, d/dy of a vertex.
using VertexJet = std::array<double, 3>;

/// The surface at `p` in the triangle with these corners (counter-clockwise).
double clough_tocher_height(const std::array<Vec2, 3>& corner, const std::array<VertexJet, 3>& data, Vec2 p);

using IndexTriangles = std::span<const std::array<std::uint32_t, 3>>;

/// Sets every vertex's gradient to the mean of its triangles' slopes, weighted by area: of those without a folded
/// corner (1 in `folded`; empty: none is), where it has one.
void facet_gradients(std::span<const Vec2> points, IndexTriangles triangles, std::span<const std::uint8_t> folded,
                     std::vector<VertexJet>& data);

/// Gives the folded corners of a triangle the slope of the plane through its heights.
void fold_jets(const std::array<Vec2, 3>& corner, const std::array<bool, 3>& folded, std::array<VertexJet, 3>& data);

/// The bending of the surface, int Sxx^2 + 2 Sxy^2 + Syy^2, as a function of the gradients.
class Bending {
 public:
  /// Triangles with a folded corner count 1/1024: enough for a vertex that has no others.
  Bending(std::span<const Vec2> points, IndexTriangles triangles, std::span<const std::uint8_t> folded = {});
  /// Sets the gradients of the vertices that are not `held` to those of least bending, from where they are, by
  /// conjugate gradients (their residual falls by 1e-5, at most 200 steps). Cost: about 1 us a vertex and step.
  void relax(std::vector<VertexJet>& data, const std::vector<std::uint8_t>& held) const;

 private:
  void multiply(const std::vector<double>& x, std::vector<double>& y) const;

  std::size_t count_;
  std::vector<std::uint32_t> begin_, vertex_;  // neighbours of each vertex, itself among them, ascending
  std::vector<std::array<double, 9>> block_;   // second derivatives of the bending
};

}  // namespace retalho
