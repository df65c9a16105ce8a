// Internal to level/: what tracing a piece of a surface leaves: points, and which point follows which.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "retalho/core/vec.h"
#include "retalho/level/contours.h"

namespace retalho {

inline constexpr std::uint32_t kNoPoint = 0xffffffffU;

/// A root of one level on an edge, in lists ordered by level and, within a level, along the edge's own direction.
struct EdgeRoot {
  int level;
  std::uint32_t point;
};

/// A root on the border of the valid area.
struct BorderRoot {
  std::uint32_t point;
  Vec2 place;
};

/// The level line from a point to the next as a rational quadratic curve with weights 1, `weight`, 1.
struct ConicLink {
  Vec2 control;
  double weight = 0;  ///< 0: a straight link, by rule
};

/// High ground lies to the left of point -> next[point], in local coordinates.
struct Trace {
  std::vector<Vec2> points;
  std::vector<std::uint32_t> next;
  std::vector<std::int32_t> level;
  std::vector<std::uint32_t> cell;  ///< the triangle that the point lies in; empty for grids
  bool keep_conics = false;         ///< pieces of degree 2: arcs are left whole, as conics
  std::vector<ConicLink> conics;    ///< of point -> next[point], where asked for
  std::vector<SingularPlace> singular;
  std::size_t pairs = 0, certified = 0, boxes = 0, undecided_edges = 0;
  int depth = 0;

  /// Empties it; the memory stays.
  void clear() {
    points.clear();
    next.clear();
    level.clear();
    cell.clear();
    conics.clear();
    singular.clear();
    pairs = certified = boxes = undecided_edges = 0;
    depth = 0;
  }
  std::uint32_t add(Vec2 p, int of_level) {
    points.push_back(p);
    next.push_back(kNoPoint);
    level.push_back(of_level);
    if (keep_conics) conics.emplace_back();
    return static_cast<std::uint32_t>(points.size() - 1);
  }
  /// A stretch of an edge, from a to b, on which the roots could not be told apart.
  void leave_undecided(int of_level, Vec2 a, Vec2 b) {
    ++undecided_edges;
    singular.push_back({of_level, {std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}});
  }
};

}  // namespace retalho
