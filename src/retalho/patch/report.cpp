#include "retalho/patch/report.h"

#include <algorithm>

namespace retalho {

PatchReport assess(const Patch& patch, const PatchSurface& surface) {
  PatchReport report;
  constexpr int kPlaces = 1000;
  for (int side = 0; side < 3; ++side)
    for (int k = 0; k <= kPlaces; ++k) {
      const double s = static_cast<double>(k) / kPlaces;
      const Vec3 on_curve = patch.sides[static_cast<std::size_t>(side)].point(s);
      report.boundary_gap = std::max(report.boundary_gap, norm(surface.point(side_parameters(side, s)) - on_curve));
    }
  report.folds = find_folds(patch);
  constexpr std::size_t kMost = 20000;
  constexpr double kBeside = 1e-13;  // far enough to be in the other triangle, near enough for the limit
  const auto& triangles = patch.domain.triangles;
  const std::size_t stride = (triangles.size() + kMost - 1) / kMost;
  for (std::size_t t = 0; t < triangles.size(); t += stride) {
    const auto corner = [&](std::size_t k) { return patch.domain.parameters[triangles[t][k % 3]]; };
    for (std::size_t k = 0; k < 3; ++k)
      for (const double s : {0.2, 0.5, 0.7}) {
        const Vec2 m = corner(k) + s * (corner(k + 1) - corner(k)), in = (corner(k + 2) - m) / norm(corner(k + 2) - m);
        const Vec2 p = m + kBeside * in, q = m - kBeside * in;
        if (q.x < 0 || q.y < 0 || q.x + q.y > 1) continue;
        const SurfaceJet x = surface.jet(p), y = surface.jet(q);
        const double size = norm(x.du) + norm(x.dv);
        if (size > 0)
          report.gradient_jump = std::max({report.gradient_jump, norm(x.du - y.du) / size, norm(x.dv - y.dv) / size});
      }
    const auto& [i, j, l] = triangles[t];
    const Vec3 facet = cross(patch.positions[j] - patch.positions[i], patch.positions[l] - patch.positions[i]);
    bool turned = false;  // the centroids of the triangle and of its three micro-triangles
    for (const Vec2 weights :
         {Vec2{1.0 / 3, 1.0 / 3}, Vec2{4.0 / 9, 4.0 / 9}, Vec2{4.0 / 9, 1.0 / 9}, Vec2{1.0 / 9, 4.0 / 9}}) {
      const SurfaceJet jet =
          surface.jet(corner(2) + weights.x * (corner(0) - corner(2)) + weights.y * (corner(1) - corner(2)));
      turned = turned || !(dot(cross(jet.du, jet.dv), facet) > 0);
    }
    report.turned += turned ? 1 : 0;
  }
  return report;
}

}  // namespace retalho
