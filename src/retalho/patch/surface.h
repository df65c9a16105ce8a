// The surface between the nodes of a patch, in one of three recoveries (docs/triangular-patches.md):
//
//   barycentric  flat triangles; second order.
//   spr          the paper's adapted patches: quadratics blended by barycentric coordinates. Continuous, not C1; misses
//                nodes and sides by O(h^3). Third order on regular meshes, erratic on irregular ones.
//   smooth       exact-boundary Clough-Tocher: through every node and exactly through the side curves, C1, fourth
//   order.
#pragma once

#include <cstdint>
#include <memory>

#include "retalho/core/context.h"
#include "retalho/patch/locator.h"
#include "retalho/patch/patch.h"

namespace retalho {

/// What can be asked of a point. All derivatives are those of `point` itself.
struct PatchJet {
  Vec3 point, du, dv, duu, duv, dvv;
  Vec3 normal;         ///< unit, along du x dv; zero where the two are parallel
  bool inside = true;  ///< false: the nearest point of the parameter triangle answered
};

/// Curvatures at a point; zero where there is no normal.
struct PatchCurvature {
  double gaussian = 0, mean = 0;  ///< mean: positive where the surface bends towards its normal
};

class PatchSurface {
 public:
  /// Cost of `smooth`: about 10 us a node, 300 bytes a triangle and 2 kB a node; of the others a tenth.
  explicit PatchSurface(const Patch& patch, const Context& context = {});
  ~PatchSurface();
  PatchSurface(PatchSurface&&) noexcept;
  PatchSurface& operator=(PatchSurface&&) noexcept;

  Vec3 point(Vec2 uv) const;
  SurfaceJet jet(Vec2 uv) const;
  PatchJet full_jet(Vec2 uv) const;
  PatchCurvature curvature(Vec2 uv) const;

  /// Only for looks: `spr` gives the unit normal of the paper's smoothed derivative, sum of c_i grad M_i, which is
  /// continuous but the derivative of nothing; the others give the surface's normal (`barycentric`: averaged at nodes).
  Vec3 shading_normal(Vec2 uv) const;

  /// New points and sides on the same domain (move_sides): what depends on the domain alone is kept, so that a dragged
  /// curve costs the sums only. Throws UsageError when the domain has other nodes or triangles, or the recovery
  /// differs.
  void move(const Patch& patch, const Context& context = {});

  const DomainLocator& locator() const;
  Recovery recovery() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace retalho
