// Adaptive meshes: Kuhn's tetrahedra of a few cubes, bisected where more is needed, always conforming.
//
// Maubach's bisection: the corners' order and the level say which edge is cut, so that only three shapes up to
// similarity arise, whatever the level. Lattice coordinates are whole, kUnit to a cube: no floating point in the
// topology.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "retalho/bernstein/tetrahedron.h"
#include "retalho/core/vec.h"
#include "retalho/tetraquad/half_faces.h"

namespace retalho {

class TetForest {
 public:
  using LatticePlace = std::array<std::int32_t, 3>;
  static constexpr std::int32_t kUnit = 1024;  ///< lattice units along a cube's edge
  static constexpr int kDeepest = 27;          ///< levels; three of them halve a tetrahedron's edges

  struct Node {
    TetCorners corners{};
    std::int32_t child = -1;  ///< of the two children the first; -1: a leaf
    std::uint8_t level = 0;
    /// Which corner is cut off corner 0.
    std::size_t tag() const { return 3U - level % 3U; }
  };

  TetForest() = default;
  /// Six roots a cube. Doubles are dropped. Throws BadInput for a cube 1000 or more from the origin.
  explicit TetForest(std::vector<LatticePlace> cubes);
  /// The forest that says `halved()` of itself on these cubes (ascending, each once). Throws BadInput when the marks
  /// are too few or too many, pass the deepest level, or leave a vertex in the middle of a leaf's edge.
  TetForest(std::vector<LatticePlace> cubes, std::span<const std::uint8_t> halved);

  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<LatticePlace>& vertices() const { return vertices_; }
  std::vector<std::uint32_t> leaves() const;  ///< ascending by root, children in order
  std::vector<LatticePlace> cubes() const;    ///< ascending
  /// For each node whether it is bisected: 1, or 0 for a leaf; roots ascending, a node before its children. With
  /// cubes() that is the whole forest, up to the numbers of nodes and vertices.
  std::vector<std::uint8_t> halved() const;

  /// Bisects these leaves (others and those at the deepest level are passed over), then whatever has a vertex in the
  /// middle of one of its edges, until nothing has: the leaves conform again.
  void bisect(std::span<const std::uint32_t> leaves);

  /// The leaf that holds the point (lattice coordinates) and its barycentric coordinates; -1 outside of all cubes.
  /// Exact up to the rounding of the fractions. Cost: the level.
  std::int64_t locate(Vec3 p, TetBarycentric* where = nullptr) const;

 private:
  std::uint32_t vertex(const LatticePlace& at);
  bool has_hanging_vertex(const Node& node) const;
  void bisect_one(std::uint32_t node);

  std::vector<Node> nodes_;
  std::vector<LatticePlace> vertices_;
  std::unordered_map<std::uint64_t, std::uint32_t> number_;  ///< of a vertex, by its key
  std::unordered_map<std::uint64_t, std::uint32_t> root_;    ///< of a cube, by its key: the first of six nodes
};

}  // namespace retalho
