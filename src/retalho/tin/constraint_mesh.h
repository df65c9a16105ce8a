// A triangulation whose edges can be forced to follow given segments, by flips alone (Sloan, A fast algorithm for
// generating constrained Delaunay triangulations, 1993), with exact predicates. Internal to tin/.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "retalho/tin/tin.h"

namespace retalho {

class ConstraintMesh {
 public:
  /// Starts from a Delaunay triangulation; `tin` must outlive the mesh.
  explicit ConstraintMesh(const Tin& tin);

  /// Makes the segment between two vertices an edge, or a chain of edges where vertices lie on it, and fixes it.
  /// Edges around it are made Delaunay again as far as fixed edges allow. Throws BadInput where it crosses a fixed edge
  /// between their ends. Cost: about the square of the edges it crosses, which are few.
  void insert(std::uint32_t a, std::uint32_t b);

  struct Triangle {
    std::array<std::uint32_t, 3> v;  ///< counter-clockwise
    std::array<std::uint32_t, 3> n;  ///< across the edge opposite v[k]; kNone: border
    std::array<bool, 3> fixed;
  };
  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  using Ends = std::array<std::uint32_t, 2>;
  struct Side {
    std::uint32_t triangle = kNone;
    std::uint32_t slot = 0;  ///< the edge opposite this corner
  };

  std::uint32_t corner_of(std::uint32_t triangle, std::uint32_t vertex) const;
  /// Calls `visit(triangle, corner)` for the triangles around a vertex until it returns true.
  template <class Visit>
  void around(std::uint32_t vertex, const Visit& visit) const;
  Side find(Ends edge) const;
  Side other(Side side) const;
  bool flips(Side side) const;
  Ends flip(Side side);
  void fix(Side side);
  /// The next vertex on the way from `from` to `to` that an edge can reach, once `crossed` have been flipped away.
  std::uint32_t reach(std::uint32_t from, std::uint32_t to, std::vector<Ends>& crossed) const;
  void clear(std::uint32_t from, std::uint32_t to, std::vector<Ends>& crossed);
  void legalize(std::vector<Ends>& suspects);

  const std::vector<Vec2>& at_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> triangle_at_;  ///< one triangle of each vertex
};

}  // namespace retalho
