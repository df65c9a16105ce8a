// The exact-boundary Clough-Tocher surface of a patch (docs/triangular-patches.md, "Smooth"): three cubics a
// triangle, and on the sides a correction that brings the edge's cubic onto the curve. Internal to the room patch.
#pragma once

#include <array>
#include <vector>

#include "retalho/patch/locator.h"
#include "retalho/patch/vertex_fit.h"

namespace retalho {

/// Point, first and second derivatives by (u, v).
struct SurfaceJet2 {
  Vec3 point, du, dv, duu, duv, dvv;
};

class SmoothNet {
 public:
  SmoothNet(const Patch& patch, const Context& context);
  /// New positions and sides on the same domain.
  void move(const Patch& patch, const Context& context);

  /// Order 0, 1 or 2: what is not asked for stays zero.
  template <int Order>
  SurfaceJet2 evaluate(const DomainLocator& locator, const DomainPlace& place) const;

 private:
  struct Edge {  ///< of a triangle on a side
    std::uint32_t triangle = 0;
    int side = 0, corner = 0;  ///< the corner opposite
    double s1 = 0, s2 = 0;     ///< s at the corners after `corner`
  };
  /// Of the 19 control points those that the others are means of: V1 V2 V3, T12 T13 T21 T23 T31 T32, C1 C2 C3. Fetching
  /// them from memory is what an evaluation waits for, so the seven means are made anew each time.
  using Net = std::array<Vec3, 12>;

  template <int Order>
  void correct(SurfaceJet2& jet, const Net& net, const Edge& edge, const DomainLocator::Frame& frame,
               const std::array<double, 3>& l) const;

  VertexFit fit_;
  PatchSides sides_;
  std::vector<Net> nets_;
  std::vector<Edge> edges_;                ///< by triangle
  std::vector<std::uint32_t> first_edge_;  ///< of each triangle where `on_side_` says so
  std::vector<std::uint8_t> on_side_;      ///< how many edges of a triangle are on sides
};

}  // namespace retalho
