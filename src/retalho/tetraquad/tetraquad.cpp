#include "retalho/tetraquad/tetraquad.h"

#include <algorithm>
#include <cmath>

namespace retalho {
namespace {

Vec3 to_vec(const LatticePoint& l) {
  return {static_cast<double>(l[0]), static_cast<double>(l[1]), static_cast<double>(l[2])};
}

}  // namespace

Quadric shifted(const Quadric& q, Vec3 d) {
  Quadric r = q;
  r[0] = polar(q, d, d);
  r[1] += 2 * q[4] * d.x + q[7] * d.y + q[8] * d.z;
  r[2] += 2 * q[5] * d.y + q[7] * d.x + q[9] * d.z;
  r[3] += 2 * q[6] * d.z + q[8] * d.x + q[9] * d.y;
  return r;
}

TetCubic ordinates(const std::array<Quadric, 4>& q, const std::array<Vec3, 4>& x) {
  TetCubic c{};
  for (std::size_t n = 0; n < 20; ++n) {
    const auto a = static_cast<std::size_t>(kTet.cubic[n][0]);
    const auto b = static_cast<std::size_t>(kTet.cubic[n][1]);
    const auto d = static_cast<std::size_t>(kTet.cubic[n][2]);
    c[n] = (polar(q[a], x[b] - x[a], x[d] - x[a]) + polar(q[b], x[d] - x[b], x[a] - x[b]) +
            polar(q[d], x[a] - x[d], x[b] - x[d])) /
           3;
  }
  return c;
}

TetCubic ordinates(const TetraQuad& surface, std::size_t tet) {
  std::array<Quadric, 4> q;
  std::array<Vec3, 4> x;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t v = surface.mesh.tets[tet][i];
    q[i] = surface.quadrics[v];
    x[i] = to_vec(surface.mesh.lattice[v]);
  }
  return ordinates(q, x);
}

Quadric interpolating_quadric(const Jet3& jet, double step) {
  Quadric q{};
  q[0] = jet.value / step;
  q[1] = jet.gradient.x * 2 / 3;
  q[2] = jet.gradient.y * 2 / 3;
  q[3] = jet.gradient.z * 2 / 3;
  for (std::size_t n = 0; n < 6; ++n) q[4 + n] = jet.hessian[n] * step / (n < 3 ? 6 : 3);
  return q;
}

TetraQuad quasi_interpolant(TetMesh mesh, const std::function<Jet3(Vec3)>& f) {
  TetraQuad surface;
  surface.quadrics.reserve(mesh.lattice.size());
  for (std::size_t v = 0; v < mesh.lattice.size(); ++v) {
    const Jet3 jet = f(mesh.position(v));
    surface.quadrics.push_back(interpolating_quadric(jet, mesh.step));
  }
  surface.mesh = std::move(mesh);
  return surface;
}

Quadric continued(const TetraQuad& surface, std::size_t tet, const LatticePoint& at) {
  const TetBarycentric b = surface.mesh.frame(tet).barycentric(to_vec(at));
  Quadric sum{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint32_t v = surface.mesh.tets[tet][i];
    const Quadric q = shifted(surface.quadrics[v], to_vec(at) - to_vec(surface.mesh.lattice[v]));
    for (std::size_t n = 0; n < 10; ++n) sum[n] += b[i] * q[n];
  }
  return sum;
}

TetraQuadField::TetraQuadField(const TetraQuad& surface) : surface_(&surface) {
  ordinates_.reserve(surface.mesh.tets.size());
  frames_.reserve(surface.mesh.tets.size());
  for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t) {
    ordinates_.push_back(retalho::ordinates(surface, t));
    frames_.push_back(surface.mesh.frame(t));
  }
}

Jet3 TetraQuadField::jet(std::size_t tet, const TetBarycentric& b) const {
  Jet3 jet = evaluate_jet(ordinates_[tet], frames_[tet], b);
  jet.value *= surface_->mesh.step;
  for (double& h : jet.hessian) h /= surface_->mesh.step;
  return jet;
}

Jet3 TetraQuadField::gradient(std::size_t tet, const TetBarycentric& b) const {
  Jet3 jet = evaluate_gradient(ordinates_[tet], frames_[tet], b);
  jet.value *= surface_->mesh.step;
  return jet;
}

std::optional<Jet3> TetraQuadField::jet(Vec3 p) const {
  TetBarycentric b;
  const std::int64_t tet = surface_->mesh.locate(p, &b);
  if (tet < 0) return std::nullopt;
  return jet(static_cast<std::size_t>(tet), b);
}

std::optional<TetraQuadField::Foot> TetraQuadField::project(Vec3 p, int steps) const {
  for (int n = 0; n <= steps; ++n) {
    TetBarycentric b;
    const std::int64_t tet = surface_->mesh.locate(p, &b);
    if (tet < 0) return std::nullopt;
    const double step = surface_->mesh.step * surface_->mesh.size(static_cast<std::size_t>(tet));
    const Jet3 jet = gradient(static_cast<std::size_t>(tet), b);
    const double slope2 = norm2(jet.gradient);
    if (!(slope2 > 0)) return std::nullopt;
    const double slope = std::sqrt(slope2), distance = jet.value / slope;
    if (std::abs(distance) <= 1e-12 * step || (n == steps && std::abs(distance) <= 1e-9 * step))
      return Foot{p, jet.gradient / slope};
    p = p - jet.gradient * (std::clamp(distance, -step, step) / slope);
  }
  return std::nullopt;
}

bool TetraQuadField::may_cross(std::size_t tet) const {
  const auto [low, high] = bounds(ordinates_[tet]);
  return low <= 0 && high >= 0;
}

bool TetraQuadField::crosses(std::size_t tet) const {
  if (!may_cross(tet)) return false;
  constexpr int parts = 6;
  bool below = false, above = false;
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j)
      for (int k = 0; i + j + k <= parts; ++k) {
        const TetBarycentric b = {static_cast<double>(i) / parts, static_cast<double>(j) / parts,
                                  static_cast<double>(k) / parts, static_cast<double>(parts - i - j - k) / parts};
        (evaluate(ordinates_[tet], b) < 0 ? below : above) = true;
        if (below && above) return true;
      }
  return false;
}

}  // namespace retalho
