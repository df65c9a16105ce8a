#include "retalho/patch/transfinite.h"

#include <vector>

namespace retalho {
namespace {

/// A blend of two points that is exact where one of the weights is zero or the points are one.
Vec3 blend(double a, Vec3 p, double b, Vec3 q) {
  if (b == 0) return p;
  if (a == 0) return q;
  return (1 / (a + b)) * (a * p + b * q);
}

/// S from the six curve points; `c` are the corners U, V, W.
Vec3 combine(double u, double v, double w, const std::array<Vec3, 6>& p, const std::array<Vec3, 3>& c) {
  const Vec3 pv = v < 1 ? blend(u, p[0], w, p[1]) : c[1];
  const Vec3 pw = w < 1 ? blend(v, p[2], u, p[3]) : c[2];
  const Vec3 pu = u < 1 ? blend(w, p[4], v, p[5]) : c[0];
  // On a side the blend of that side is the answer, and the two others cancel against the corners' plane.
  if (u == 0) return v == 0 ? c[2] : w == 0 ? c[1] : p[2];
  if (v == 0) return w == 0 ? c[0] : p[4];
  if (w == 0) return p[0];
  return 0.5 * (pv + pw + pu - (u * c[0] + v * c[1] + w * c[2]));
}

}  // namespace

Vec3 transfinite_point(const PatchSides& sides, Vec2 uv) {
  const double u = uv.x, v = uv.y, w = 1 - u - v;
  const auto& [b, p, a] = sides;
  return combine(u, v, w, {b.point(v), p.point(1 - v), p.point(w), a.point(1 - w), a.point(u), b.point(1 - u)},
                 {b.start(), p.start(), a.start()});
}

SurfaceJet transfinite_jet(const PatchSides& sides, Vec2 uv) {
  const double u = uv.x, v = uv.y, w = 1 - u - v;
  const auto& [b, p, a] = sides;
  if (u >= 1) return {b.start(), a.jet(1).first, b.jet(0).first + a.jet(1).first};
  if (v >= 1) return {p.start(), -p.jet(0).first - b.jet(1).first, -p.jet(0).first};
  if (w >= 1) return {a.start(), a.jet(0).first, -p.jet(1).first};
  const SideJet bv = b.jet(v), pv = p.jet(1 - v), pw = p.jet(w), aw = a.jet(1 - w), au = a.jet(u), bu = b.jet(1 - u);
  const Vec3 cu = b.start(), cv = p.start(), cw = a.start();
  const double iv = 1 / (u + w), iw = 1 / (u + v), iu = 1 / (v + w);  // sums: near a corner 1 - u has lost digits
  const Vec3 blend_v = iv * (u * bv.point + w * pv.point), blend_w = iw * (v * pw.point + u * aw.point),
             blend_u = iu * (w * au.point + v * bu.point);
  const Vec3 along_w = -v * pw.first + u * aw.first - blend_w;  // what both derivatives of the second blend share
  SurfaceJet jet;
  jet.point = transfinite_point(sides, uv);
  jet.du = 0.5 * (iv * (bv.point - pv.point) + iw * (aw.point + along_w) +
                  iu * (-au.point + w * au.first - v * bu.first + blend_u) - cu + cw);
  jet.dv = 0.5 * (iv * (u * bv.first - pv.point - w * pv.first + blend_v) + iw * (pw.point + along_w) +
                  iu * (bu.point - au.point) - cv + cw);
  return jet;
}

std::vector<Vec3> transfinite_grid(const PatchSides& sides, std::size_t n) {
  std::array<std::vector<Vec3>, 3> at;
  for (std::size_t side = 0; side < 3; ++side) {
    at[side].reserve(n + 1);
    for (std::size_t k = 0; k <= n; ++k) at[side].push_back(sides[side].node(k, n));
  }
  const auto& [b, p, a] = at;
  const std::array<Vec3, 3> corner = {b[0], p[0], a[0]};
  std::vector<Vec3> points;
  points.reserve((n + 1) * (n + 2) / 2);
  const double size = static_cast<double>(n);
  for (std::size_t i = 0; i <= n; ++i)
    for (std::size_t j = 0; i + j <= n; ++j) {
      const std::size_t k = n - i - j;
      points.push_back(combine(static_cast<double>(i) / size, static_cast<double>(j) / size,
                               static_cast<double>(k) / size, {b[j], p[n - j], p[k], a[n - k], a[i], b[n - i]},
                               corner));
    }
  return points;
}

}  // namespace retalho
