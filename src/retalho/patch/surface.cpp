#include "retalho/patch/surface.h"

#include <optional>

#include "retalho/core/error.h"
#include "retalho/patch/smooth_net.h"
#include "retalho/patch/spr.h"

namespace retalho {

struct PatchSurface::Data {
  explicit Data(const Patch& patch)
      : locator(patch.domain), recovery(patch.recovery), triangles(patch.domain.triangles) {}
  DomainLocator locator;
  Recovery recovery;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Vec2> parameters;
  std::vector<Vec3> positions, normals;   ///< barycentric
  std::vector<NodeQuadratic> quadratics;  ///< spr
  std::optional<SmoothNet> net;           ///< smooth

  void fill(const Patch& patch, const Context& context) {
    switch (recovery) {
      case Recovery::barycentric:
        positions = patch.positions;
        normals.assign(positions.size(), {});
        for (const auto& [a, b, c] : triangles) {
          const Vec3 n = cross(positions[b] - positions[a], positions[c] - positions[a]);
          for (const std::uint32_t v : {a, b, c}) normals[v] = normals[v] + n;
        }
        break;
      case Recovery::spr:
        parameters = patch.domain.parameters;
        quadratics = spr_quadratics(patch.domain, patch.positions);
        break;
      case Recovery::smooth:
        if (net)
          net->move(patch, context);
        else
          net.emplace(patch, context);
        break;
    }
  }

  template <int Order>
  SurfaceJet2 flat(const DomainPlace& p) const {
    const auto& [a, b, c] = triangles[p.triangle];
    const DomainLocator::Frame& f = locator.frame(p.triangle);
    const Vec3 x = positions[a], y = positions[b], z = positions[c];
    SurfaceJet2 jet;
    jet.point = p.l1 * x + p.l2 * y + p.l3 * z;
    jet.du = f.g2.x * (y - x) + f.g3.x * (z - x);
    jet.dv = f.g2.y * (y - x) + f.g3.y * (z - x);
    return jet;
  }

  /// V = sum of l_i M_i and its derivatives; `blended` gets sum of l_i grad M_i.
  template <int Order>
  SurfaceJet2 spr(const DomainPlace& p, SurfaceJet* blended = nullptr) const {
    const DomainLocator::Frame& f = locator.frame(p.triangle);
    const std::array<double, 3> l = {p.l1, p.l2, p.l3};
    const std::array<Vec2, 3> g = {-(f.g2 + f.g3), f.g2, f.g3};
    const auto& corner = triangles[p.triangle];
    Vec2 uv{};
    for (std::size_t i = 0; i < 3; ++i) uv = uv + l[i] * parameters[corner[i]];
    SurfaceJet2 jet;
    Vec3 smooth_u, smooth_v;
    for (std::size_t i = 0; i < 3; ++i) {
      const NodeQuadratic& q = quadratics[corner[i]];
      const Vec2 d = uv - parameters[corner[i]];
      const Vec3 m = q[0] + d.x * q[1] + d.y * q[2] + (d.x * d.x) * q[3] + (d.x * d.y) * q[4] + (d.y * d.y) * q[5];
      jet.point = jet.point + l[i] * m;
      if constexpr (Order >= 1) {
        const Vec3 mu = q[1] + (2 * d.x) * q[3] + d.y * q[4], mv = q[2] + d.x * q[4] + (2 * d.y) * q[5];
        smooth_u = smooth_u + l[i] * mu;
        smooth_v = smooth_v + l[i] * mv;
        jet.du = jet.du + g[i].x * m;
        jet.dv = jet.dv + g[i].y * m;
        if constexpr (Order >= 2) {
          jet.duu = jet.duu + (2 * g[i].x) * mu + (2 * l[i]) * q[3];
          jet.duv = jet.duv + g[i].x * mv + g[i].y * mu + l[i] * q[4];
          jet.dvv = jet.dvv + (2 * g[i].y) * mv + (2 * l[i]) * q[5];
        }
      }
    }
    jet.du = jet.du + smooth_u;
    jet.dv = jet.dv + smooth_v;
    if (blended) *blended = {jet.point, smooth_u, smooth_v};
    return jet;
  }

  template <int Order>
  SurfaceJet2 evaluate(const DomainPlace& place) const {
    if (recovery == Recovery::smooth) return net->evaluate<Order>(locator, place);
    return recovery == Recovery::spr ? spr<Order>(place) : flat<Order>(place);
  }
};

namespace {

Vec3 unit_normal(Vec3 du, Vec3 dv) {
  const Vec3 n = cross(du, dv);
  const double length = norm(n);
  return length > 0 ? n / length : Vec3{};
}

}  // namespace

PatchSurface::PatchSurface(const Patch& patch, const Context& context) : data_(std::make_unique<Data>(patch)) {
  data_->fill(patch, context);
}
PatchSurface::~PatchSurface() = default;
PatchSurface::PatchSurface(PatchSurface&&) noexcept = default;
PatchSurface& PatchSurface::operator=(PatchSurface&&) noexcept = default;

Vec3 PatchSurface::point(Vec2 uv) const {
  return data_->evaluate<0>(data_->locator.locate(uv)).point;
}

SurfaceJet PatchSurface::jet(Vec2 uv) const {
  const SurfaceJet2 jet = data_->evaluate<1>(data_->locator.locate(uv));
  return {jet.point, jet.du, jet.dv};
}

PatchJet PatchSurface::full_jet(Vec2 uv) const {
  const DomainPlace place = data_->locator.locate(uv);
  const SurfaceJet2 j = data_->evaluate<2>(place);
  return {j.point, j.du, j.dv, j.duu, j.duv, j.dvv, unit_normal(j.du, j.dv), place.inside};
}

PatchCurvature PatchSurface::curvature(Vec2 uv) const {
  const PatchJet j = full_jet(uv);
  const double e = dot(j.du, j.du), f = dot(j.du, j.dv), g = dot(j.dv, j.dv), area = e * g - f * f;
  if (!(area > 0)) return {};
  const double l = dot(j.duu, j.normal), m = dot(j.duv, j.normal), n = dot(j.dvv, j.normal);
  return {(l * n - m * m) / area, (e * n - 2 * f * m + g * l) / (2 * area)};
}

Vec3 PatchSurface::shading_normal(Vec2 uv) const {
  const DomainPlace place = data_->locator.locate(uv);
  if (data_->recovery == Recovery::spr) {
    SurfaceJet smooth;
    data_->spr<1>(place, &smooth);
    return unit_normal(smooth.du, smooth.dv);
  }
  if (data_->recovery == Recovery::barycentric) {
    const auto& [a, b, c] = data_->triangles[place.triangle];
    const Vec3 n = place.l1 * data_->normals[a] + place.l2 * data_->normals[b] + place.l3 * data_->normals[c];
    return norm(n) > 0 ? normalized(n) : n;
  }
  const SurfaceJet2 jet = data_->evaluate<1>(place);
  return unit_normal(jet.du, jet.dv);
}

void PatchSurface::move(const Patch& patch, const Context& context) {
  if (patch.recovery != data_->recovery || patch.domain.triangles != data_->triangles)
    throw UsageError("a surface is moved with another domain or recovery than it was made with: make a new one");
  data_->fill(patch, context);
}

const DomainLocator& PatchSurface::locator() const {
  return data_->locator;
}
Recovery PatchSurface::recovery() const {
  return data_->recovery;
}

}  // namespace retalho
