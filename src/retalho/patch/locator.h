// Which triangle of a domain holds a point, by a grid with about two triangles a cell.
#pragma once

#include <cstdint>
#include <vector>

#include "retalho/patch/domain.h"

namespace retalho {

/// A point of the domain: its triangle and the barycentric coordinates there, of the corners in the triangle's order.
struct DomainPlace {
  std::uint32_t triangle = 0;
  double l1 = 0, l2 = 0, l3 = 0;
  bool inside = true;  ///< false: the point was outside of the parameter triangle, and the nearest one in it was taken
};

class DomainLocator {
 public:
  /// Cost: about 60 ns a triangle. Keeps no reference to the domain. Triangles must cover the parameter triangle.
  explicit DomainLocator(const Domain& domain);

  /// On an edge or at a node: one of the triangles there. Cost: 20 ns where everything is in the cache.
  DomainPlace locate(Vec2 uv) const;

  /// Gradients of l2 and l3 by (u, v), and the first corner: l2 = g2 . (uv - a), l3 = g3 . (uv - a), l1 = 1 - l2 - l3.
  struct Frame {
    Vec2 a, g2, g3;
  };
  const Frame& frame(std::uint32_t triangle) const { return frames_[triangle]; }

 private:
  std::uint32_t cells_ = 1;  ///< a side of the square grid over [0, 1]^2
  std::vector<Frame> frames_;
  std::vector<std::uint32_t> first_, triangles_;
};

/// The point of the parameter triangle that is nearest in (u, v).
Vec2 clamp_to_domain(Vec2 uv);

}  // namespace retalho
