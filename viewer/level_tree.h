// Squares over a rectangle, small where the eye is near: a quadtree whose neighbours differ by one level at most, so
// that its triangles fit together without cracks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_set>
#include <vector>

namespace retalho::viewer {

/// Square (i, j) of a level, from west and from north; at level 0 there are as many as the tree has columns and rows.
struct LevelSquare {
  int level = 0;
  std::uint32_t i = 0, j = 0;
};

class LevelTree {
 public:
  static constexpr int kDeepest = 24;

  /// `columns`, `rows`: squares at level 0, 1 to 64 each.
  LevelTree(int columns, int rows);

  /// Halves the square with the largest `want` again and again, and with it those neighbours that would be more than a
  /// level larger, until there are `most` squares, none wants more than `enough`, or all are at `deepest` (at most
  /// kDeepest). The same tree for the same answers. Cost: O(squares log squares).
  void refine(const std::function<double(const LevelSquare&)>& want, double enough, int deepest, std::size_t most);

  /// Squares that are not halved.
  std::size_t leaves() const { return leaves_; }
  int deepest() const { return deepest_; }

  /// Places count in halves of the smallest squares: each leaf as a fan of triangles (counter-clockwise, north up)
  /// round its middle, with the corners of finer neighbours on its sides.
  struct Fans {
    int halves = 2;  ///< places along a side of a square of level 0
    std::vector<std::array<std::uint32_t, 2>> places;
    std::vector<std::array<std::uint32_t, 3>> triangles;
  };
  Fans fans() const;

 private:
  static std::uint64_t key(const LevelSquare& s) {
    return (static_cast<std::uint64_t>(s.level) << 58) | (static_cast<std::uint64_t>(s.i) << 29) | s.j;
  }
  bool inside(int level, std::int64_t i, std::int64_t j) const;
  bool halved(const LevelSquare& s) const { return halved_.contains(key(s)); }
  template <class Take>
  void halve(const LevelSquare& s, const Take& take);
  template <class Take>
  void each_leaf(const LevelSquare& s, const Take& take) const;

  std::uint32_t columns_, rows_;
  std::size_t leaves_;
  int deepest_ = 0;
  std::unordered_set<std::uint64_t> halved_;
};

}  // namespace retalho::viewer
