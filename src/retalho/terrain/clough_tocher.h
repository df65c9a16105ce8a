// Clough-Tocher on one triangle: three cubic pieces around the centroid, C1 with the neighbours
// (docs/mathematics.md, "Clough-Tocher"; Clough and Tocher 1965; the paper's list after eq. 27, its slips put right).
// Two ways to set the derivative across the edges (CrossDerivative): perpendicular, and of cubic precision.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "retalho/bernstein/triangle.h"
#include "retalho/core/context.h"
#include "retalho/terrain/powell_sabin.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct TriangleCorners;

/// Edge k lies opposite corner k and runs from corner k + 1 to corner k + 2 (indices modulo 3). Piece k is
/// (corner k + 1, corner k + 2, centroid).
struct CloughTocherElement {
  static constexpr int kDegree = 3;
  static constexpr int kPieces = 3;

  double centre;
  std::array<double, 3> corner;
  std::array<double, 3> first;   ///< on edge k next to corner k + 1
  std::array<double, 3> second;  ///< on edge k next to corner k + 2
  std::array<double, 3> spoke;   ///< next to corner k towards the centroid
  std::array<double, 3> inner;   ///< next to the centroid towards corner k
  std::array<double, 3> face;    ///< inside piece k: the only freedom of the element

  /// From the whole triangle's coordinates, of a point or of a direction, to the piece's: linear.
  struct Map {
    Map() = default;
    Map(const CloughTocherElement&, int piece) : k_(static_cast<std::size_t>(piece)) {}
    Barycentric operator()(Barycentric macro) const {
      const std::array<double, 3> u{macro.r, macro.s, macro.t};
      return {u[(k_ + 1) % 3] - u[k_], u[(k_ + 2) % 3] - u[k_], 3 * u[k_]};
    }

   private:
    std::size_t k_ = 0;
  };

  /// The piece that holds a point.
  int piece(Barycentric macro) const { return macro.t < std::min(macro.r, macro.s) ? 2 : macro.s < macro.r ? 1 : 0; }
  PiecePoint find(Barycentric macro) const {
    const int number = piece(macro);
    return {number, Map(*this, number)(macro)};
  }
  TriangleNet<3> net(int piece) const;
  /// Gradients of the piece's barycentric coordinates, from those of the whole triangle.
  TriangleFrame frame(int piece, const TriangleFrame& macro) const;
};

CloughTocherElement clough_tocher_element(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle);
/// With CrossDerivative::perpendicular, which asks nothing of the neighbours.
CloughTocherElement clough_tocher_element(const TriangleCorners& corners);

/// For CrossDerivative::cubic, once for each edge: 1 where the two triangles are so unlike each other that the cubic
/// rule would multiply the errors of the gradients, and the perpendicular rule is used instead.
std::vector<std::uint8_t> cubic_fallbacks(const Tin& tin, const EdgeTable& edges, const Context& context = {});

inline TriangleNet<3> CloughTocherElement::net(int piece) const {
  const auto k = static_cast<std::size_t>(piece);
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  return {corner[i], first[k], spoke[i], second[k], face[k], inner[i], corner[j], spoke[j], inner[j], centre};
}

}  // namespace retalho
