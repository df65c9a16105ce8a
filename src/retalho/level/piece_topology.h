// Internal to level/: which edge each side of a triangle's pieces lies on, for every kind of terrain surface
// (terrain/terrain.h says how the pieces are ordered).
#pragma once

#include <array>

#include "retalho/terrain/terrain.h"

namespace retalho {

/// Outer: half `half` (0 or 1, counter-clockwise; 0 where edges are whole) of edge `index`, which lies opposite corner
/// `index`. Inner: edge `index` inside the triangle, against its own direction when `reversed`.
struct PieceSide {
  bool outer;
  int index, half;
  bool reversed;
};

/// An inner edge has the direction of side `side` of piece `piece`.
struct InnerEdge {
  int piece, side;
};

template <SurfaceKind Kind>
struct PieceTopology;

template <>
struct PieceTopology<SurfaceKind::linear> {
  static constexpr int kDegree = 1, kPieces = 1, kHalves = 1, kInner = 0;
  static constexpr std::array<InnerEdge, 0> kInnerEdges{};
  static constexpr std::array<std::array<PieceSide, 3>, 1> kSides{
      {{{{true, 2, 0, false}, {true, 0, 0, false}, {true, 1, 0, false}}}}};
  /// Piece and side of half h of edge k.
  static constexpr InnerEdge outer(int k, int) { return {0, (k + 1) % 3}; }
};

template <>
struct PieceTopology<SurfaceKind::clough_tocher> {
  static constexpr int kDegree = 3, kPieces = 3, kHalves = 1, kInner = 3;
  /// Inner edge j runs from corner j to the centroid.
  static constexpr std::array<InnerEdge, 3> kInnerEdges{{{1, 1}, {2, 1}, {0, 1}}};
  static constexpr std::array<std::array<PieceSide, 3>, 3> kSides{{
      {{{true, 0, 0, false}, {false, 2, 0, false}, {false, 1, 0, true}}},
      {{{true, 1, 0, false}, {false, 0, 0, false}, {false, 2, 0, true}}},
      {{{true, 2, 0, false}, {false, 1, 0, false}, {false, 0, 0, true}}},
  }};
  static constexpr InnerEdge outer(int k, int) { return {k, 0}; }
};

template <>
struct PieceTopology<SurfaceKind::powell_sabin> {
  static constexpr int kDegree = 2, kPieces = 6, kHalves = 2, kInner = 6;
  /// Inner edge j < 3 runs from the centre to corner j, edge 3 + k from the centre to the split of edge k.
  static constexpr std::array<InnerEdge, 6> kInnerEdges{{{4, 0}, {0, 0}, {2, 0}, {1, 0}, {3, 0}, {5, 0}}};
  static constexpr std::array<std::array<PieceSide, 3>, 6> kSides{{
      {{{false, 1, 0, false}, {true, 0, 0, false}, {false, 3, 0, true}}},
      {{{false, 3, 0, false}, {true, 0, 1, false}, {false, 2, 0, true}}},
      {{{false, 2, 0, false}, {true, 1, 0, false}, {false, 4, 0, true}}},
      {{{false, 4, 0, false}, {true, 1, 1, false}, {false, 0, 0, true}}},
      {{{false, 0, 0, false}, {true, 2, 0, false}, {false, 5, 0, true}}},
      {{{false, 5, 0, false}, {true, 2, 1, false}, {false, 1, 0, true}}},
  }};
  static constexpr InnerEdge outer(int k, int half) { return {2 * k + half, 1}; }
};

}  // namespace retalho
