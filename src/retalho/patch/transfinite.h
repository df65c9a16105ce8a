// Three curves to a surface: the three-sided Gordon-Hall projector (docs/triangular-patches.md, "The map").
//
//   2 S = [u b(v) + w p(1-v)]/(1-v) + [v p(w) + u a(1-w)]/(1-w) + [w a(u) + v b(1-u)]/(1-u) - u b(0) - v p(0) - w a(0)
//
// with b, p, a the sides U to V, V to W, W to U. S runs through its sides, reproduces quadratic surfaces, and gives for
// polynomial sides of degree d a Bézier triangle of degree d. It may fold: patch/mesh.h looks for that.
#pragma once

#include "retalho/patch/sides.h"

namespace retalho {

/// Point and first derivatives by (u, v).
struct SurfaceJet {
  Vec3 point, du, dv;
};

/// Six evaluations of curves a point; nothing is stored. (u, v) in the parameter triangle.
Vec3 transfinite_point(const PatchSides& sides, Vec2 uv);
/// The gradient at a corner is that of its two side tangents, which is the limit.
SurfaceJet transfinite_jet(const PatchSides& sides, Vec2 uv);

/// Node (i, j) of n divisions is at u = i/n, v = j/n; i from 0, then j from 0 to n - i. Looks its six curve points up
/// in one table of each side, so (n+1)(n+2)/2 nodes cost 3 (n + 1) evaluations of curves.
std::vector<Vec3> transfinite_grid(const PatchSides& sides, std::size_t n);

}  // namespace retalho
