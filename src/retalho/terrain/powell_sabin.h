// Powell-Sabin on one triangle: six quadratic pieces around the incentre, C1 with the neighbours
// (docs/mathematics.md, "Powell-Sabin"; Powell and Sabin 1977; the paper's eqs. 7-27 with its slips put right).
//
// Everything is written in the barycentric coordinates of the whole triangle, so that a point finds its piece, and its
// place in the piece, without any division by the area of a piece.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/bernstein/triangle.h"
#include "retalho/core/context.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct TriangleCorners;

/// Where a point lies inside a split triangle.
struct PiecePoint {
  int piece = 0;
  Barycentric at;  ///< in the piece
};

/// Edge k lies opposite corner k and runs from corner k + 1 to corner k + 2 (indices modulo 3). Pieces 2k and 2k + 1
/// are (centre, corner k + 1, split k) and (centre, split k, corner k + 2).
struct PowellSabinElement {
  static constexpr int kDegree = 2;
  static constexpr int kPieces = 6;

  std::array<double, 3> weight;  ///< barycentric coordinates of the incentre, all > 0
  std::array<double, 3> split;   ///< of edge k: fraction from corner k + 1, in (0, 1)
  double centre;                 ///< ordinates from here on
  std::array<double, 3> corner;
  std::array<double, 3> spoke;        ///< between the centre and corner k
  std::array<double, 3> split_value;  ///< at the split of edge k
  std::array<double, 3> rib;          ///< between the centre and the split of edge k
  std::array<double, 3> first;        ///< on edge k between corner k + 1 and the split
  std::array<double, 3> second;       ///< on edge k between the split and corner k + 2

  /// From the whole triangle's coordinates, of a point or of a direction, to the piece's: linear.
  struct Map {
    Map() = default;
    Map(const PowellSabinElement& e, int piece);
    Barycentric operator()(Barycentric macro) const;

   private:
    std::size_t k_ = 0;
    bool second_half_ = false;
    double per_weight_ = 0, weight_i_ = 0, weight_j_ = 0, per_length_ = 0, other_length_ = 0;
  };

  /// The piece that holds a point.
  int piece(Barycentric macro) const;
  PiecePoint find(Barycentric macro) const {
    const int number = piece(macro);
    return {number, Map(*this, number)(macro)};
  }
  TriangleNet<2> net(int piece) const;
  /// Gradients of the piece's barycentric coordinates, from those of the whole triangle.
  TriangleFrame frame(int piece, const TriangleFrame& macro) const;
};

PowellSabinElement powell_sabin_element(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle);
/// `splits`: where edge k is cut, from the end with the lower vertex number.
PowellSabinElement powell_sabin_element(const TriangleCorners& corners, const std::array<double, 3>& splits);

/// The point where the line through the incentres of its two triangles meets each edge, as a fraction from the edge's
/// lower-index end; 1/2 on the border. Always strictly inside the edge.
double powell_sabin_split(Vec2 a, Vec2 b, Vec2 apex, Vec2 other_apex);  // an inner edge a-b, one rule for all
std::vector<double> powell_sabin_splits(const Tin& tin, const EdgeTable& edges, const Context& context = {});

/// Incentre of a triangle in its barycentric coordinates.
std::array<double, 3> incentre_weights(Vec2 a, Vec2 b, Vec2 c);

inline int PowellSabinElement::piece(Barycentric macro) const {
  const std::array<double, 3> u{macro.r, macro.s, macro.t};
  // The centre's share of the point, seen from edge k, is u[k] / weight[k]; the smallest share belongs to the edge
  // whose two pieces hold the point.
  std::size_t k = 0;
  if (u[1] * weight[0] < u[0] * weight[1]) k = 1;
  if (u[2] * weight[k] < u[k] * weight[2]) k = 2;
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  // Beside the rib when, without the centre's share, the point divides edge k as the split does.
  const double ui = u[i] * weight[k] - u[k] * weight[i], uj = u[j] * weight[k] - u[k] * weight[j];
  return static_cast<int>(2 * k) + (uj * (1 - split[k]) > ui * split[k]);
}

inline PowellSabinElement::Map::Map(const PowellSabinElement& e, int piece)
    : k_(static_cast<std::size_t>(piece) / 2),
      second_half_(piece % 2 != 0),
      per_weight_(1 / e.weight[k_]),
      weight_i_(e.weight[(k_ + 1) % 3]),
      weight_j_(e.weight[(k_ + 2) % 3]) {
  const double length = second_half_ ? 1 - e.split[k_] : e.split[k_];
  per_length_ = 1 / length;
  other_length_ = 1 - length;
}

inline Barycentric PowellSabinElement::Map::operator()(Barycentric macro) const {
  const std::array<double, 3> u{macro.r, macro.s, macro.t};
  const double centre_part = u[k_] * per_weight_;
  const double ui = u[(k_ + 1) % 3] - centre_part * weight_i_, uj = u[(k_ + 2) % 3] - centre_part * weight_j_;
  const double part = (second_half_ ? ui : uj) * per_length_;
  const double corner_part = (second_half_ ? uj : ui) - part * other_length_;
  if (second_half_) return {centre_part, part, corner_part};
  return {centre_part, corner_part, part};
}

inline TriangleNet<2> PowellSabinElement::net(int piece) const {
  const auto k = static_cast<std::size_t>(piece / 2);
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  if (piece % 2 == 0) return {centre, spoke[i], rib[k], corner[i], first[k], split_value[k]};
  return {centre, rib[k], spoke[j], split_value[k], second[k], corner[j]};
}

}  // namespace retalho
