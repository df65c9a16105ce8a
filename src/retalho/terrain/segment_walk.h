// The surface of a model over a straight segment: which triangles it passes, and the polynomial that each has there.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/terrain/evaluate.h"

namespace retalho {

/// A cubic in the fraction t of the way along the segment, on [begin, end], in Bernstein form.
struct SegmentPiece {
  double begin = 0, end = 0;
  std::array<double, 4> ordinates{};
};

/// Walks from triangle to triangle with exact signs; a segment through a vertex or along an edge is taken as one that
/// is moved aside by nothing, so a walk always ends. Safe to use from several threads at once; refers to the evaluator.
class SegmentWalk {
 public:
  explicit SegmentWalk(const TerrainEvaluator& evaluator, const Context& context = {});

  /// All triangles that hold `from` (several on an edge or a vertex), for walks that start there; empty outside.
  std::vector<std::uint32_t> around(Vec2 from) const;

  /// Calls visit(triangle, begin, end) for the triangles between `from` and `to`, in order, until it returns false or
  /// `to` or the border is reached. `start` is around(from). Cost: 20 ns a triangle.
  template <class Visit>
  void triangles(const std::vector<std::uint32_t>& start, Vec2 from, Vec2 to, const Visit& visit) const;

  /// The pieces of one triangle on [begin, end], in order; returns how many. Cost: 100 to 300 ns.
  int pieces(std::uint32_t triangle, Vec2 from, Vec2 to, double begin, double end,
             std::array<SegmentPiece, 6>& out) const;

  /// The surface is nowhere on the triangle higher: its largest ordinate.
  double highest(std::uint32_t triangle) const { return highest_[triangle]; }

  const TerrainEvaluator& evaluator() const { return *evaluator_; }

 private:
  /// How the walk leaves a triangle: over the edge from corner k to k + 1; -1: the line does not pass it.
  /// `aside`: on which side of the line a point on it counts.
  int exit_edge(std::uint32_t triangle, Vec2 from, Vec2 to, int aside) const;
  /// The fraction of the way where the line meets the line through that edge.
  double crossing(std::uint32_t triangle, int edge, Vec2 from, Vec2 to) const;
  /// Is `to` on the triangle's side of that edge?
  bool ends_before(std::uint32_t triangle, int edge, Vec2 to) const;
  Vec2 corner(std::uint32_t triangle, int k) const;

  const TerrainEvaluator* evaluator_;
  std::vector<double> highest_;
};

template <class Visit>
void SegmentWalk::triangles(const std::vector<std::uint32_t>& start, Vec2 from, Vec2 to, const Visit& visit) const {
  if (from == to) return;
  // Of the triangles around the start, the one that the line leaves last is the one ahead.
  std::uint32_t at = kNone;
  int edge = -1, aside = 1;
  for (const int side : {1, -1}) {
    double latest = 0;
    for (const std::uint32_t triangle : start) {
      const int k = exit_edge(triangle, from, to, side);
      if (k < 0) continue;
      const double t = crossing(triangle, k, from, to);
      if (at == kNone || t > latest) {
        latest = t;
        at = triangle;
        edge = k;
      }
    }
    aside = side;
    // Along the border of the triangulation only one of the two sides has triangles ahead.
    if (at != kNone && (latest > 0 || side < 0)) break;
    at = kNone;
  }
  double begin = 0;
  while (at != kNone) {
    const bool last = ends_before(at, edge, to);
    const double end = last ? 1 : std::min(1.0, std::max(begin, crossing(at, edge, from, to)));
    if (!visit(at, begin, end) || last) return;
    begin = end;
    at = evaluator_->terrain().tin.neighbors[at][static_cast<std::size_t>((edge + 2) % 3)];
    if (at != kNone) edge = exit_edge(at, from, to, aside);
    if (edge < 0) return;
  }
}

}  // namespace retalho
