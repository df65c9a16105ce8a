// Cubics about the nodes, the data of the smooth recovery: linear maps from node positions and side tangents, made once
// for a domain (docs/triangular-patches.md, "Smooth"). Internal to the room patch.
#pragma once

#include <array>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/patch/patch.h"

namespace retalho {

/// q(d) = X + c0 a + c1 b + c2 a^2 + c3 a b + c4 b^2 + c5 a^3 + c6 a^2 b + c7 a b^2 + c8 b^3 with
/// a = t . d / h, b = n . d / h, n = t turned left, d = uv - uv of the node.
struct VertexFrame {
  Vec2 t{1, 0};
  double h = 1;
};
using VertexCubic = std::array<Vec3, 9>;

/// d/du and d/dv of q at d.
std::array<Vec3, 2> gradient(const VertexFrame& frame, const VertexCubic& cubic, Vec2 d);

class VertexFit {
 public:
  explicit VertexFit(const Domain& domain, const Context& context = {});
  const VertexFrame& frame(std::size_t vertex) const { return frames_[vertex]; }
  /// Least squares over the rings about the node; on sides the derivative along the side is the curve's.
  VertexCubic cubic(std::size_t vertex, const std::vector<Vec3>& positions, const std::vector<Vec3>& tangents) const;
  /// dC/ds at the nodes of the three sides, one side after the other.
  std::vector<Vec3> tangents(const Domain& domain, const PatchSides& sides) const;

 private:
  std::vector<VertexFrame> frames_;
  std::vector<std::size_t> first_;      ///< columns of vertex i: [first_[i], first_[i + 1])
  std::vector<std::uint32_t> sources_;  ///< a vertex, or kTangent + a tangent
  std::vector<std::array<double, 9>> columns_;
  static constexpr std::uint32_t kTangent = 0x80000000U;
};

}  // namespace retalho
