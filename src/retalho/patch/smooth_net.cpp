#include "retalho/patch/smooth_net.h"

#include <algorithm>

#include "retalho/core/parallel.h"

namespace retalho {
namespace {

/// Where T_ij stands in a net.
constexpr std::size_t t_index(std::size_t i, std::size_t j) {
  return 3 + 2 * i + (j > i ? j - 1 : j);
}
static_assert(t_index(0, 1) == 3 && t_index(0, 2) == 4 && t_index(1, 0) == 5 && t_index(1, 2) == 6 &&
              t_index(2, 0) == 7 && t_index(2, 1) == 8);

/// I_i, the mean of V_i and the two points next to it on the edges.
template <typename Net>
Vec3 inner_point(const Net& net, std::size_t i) {
  return (net[i] + net[3 + 2 * i] + net[4 + 2 * i]) * (1.0 / 3);
}

constexpr std::uint32_t kAway = 0xffffffffU;

}  // namespace

SmoothNet::SmoothNet(const Patch& patch, const Context& context) : fit_(patch.domain, context) {
  const Domain& domain = patch.domain;
  // Edges on sides: both ends are neighbours along the side.
  std::vector<std::array<std::uint32_t, 3>> place(domain.parameters.size(), {kAway, kAway, kAway});
  for (std::size_t side = 0; side < 3; ++side)
    for (std::uint32_t k = 0; k < domain.sides[side].size(); ++k) place[domain.sides[side][k]][side] = k;
  on_side_.assign(domain.triangles.size(), 0);
  first_edge_.assign(domain.triangles.size(), 0);
  for (std::uint32_t t = 0; t < domain.triangles.size(); ++t) {
    first_edge_[t] = static_cast<std::uint32_t>(edges_.size());
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t a = domain.triangles[t][static_cast<std::size_t>((corner + 1) % 3)],
                          b = domain.triangles[t][static_cast<std::size_t>((corner + 2) % 3)];
      for (int side = 0; side < 3; ++side) {
        const std::uint32_t ka = place[a][static_cast<std::size_t>(side)],
                            kb = place[b][static_cast<std::size_t>(side)];
        if (ka == kAway || kb == kAway || (ka + 1 != kb && kb + 1 != ka)) continue;
        edges_.push_back(
            {t, side, corner, side_argument(side, domain.parameters[a]), side_argument(side, domain.parameters[b])});
        ++on_side_[t];
      }
    }
  }
  nets_.resize(domain.triangles.size());
  move(patch, context);
}

void SmoothNet::move(const Patch& patch, const Context& context) {
  sides_ = patch.sides;
  const Domain& domain = patch.domain;
  const std::vector<Vec3>& x = patch.positions;
  const std::vector<Vec3> tangents = fit_.tangents(domain, patch.sides);
  std::vector<VertexCubic> cubics(x.size());
  parallel_chunks(x.size(), 2048, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) cubics[v] = fit_.cubic(v, x, tangents);
  });
  parallel_chunks(domain.triangles.size(), 2048, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& corner = domain.triangles[t];
      Net& net = nets_[t];
      std::array<Vec2, 3> at;
      std::array<std::array<Vec3, 2>, 3> g;
      for (std::size_t i = 0; i < 3; ++i) {
        at[i] = domain.parameters[corner[i]];
        net[i] = x[corner[i]];
        g[i] = gradient(fit_.frame(corner[i]), cubics[corner[i]], {0, 0});
      }
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
          if (i != j) {
            const Vec2 d = (at[j] - at[i]) / 3;
            net[t_index(i, j)] = net[i] + d.x * g[i][0] + d.y * g[i][1];
          }
      const auto inner = [&](std::size_t i) { return inner_point(net, i); };
      const Vec2 centre = (at[0] + at[1] + at[2]) / 3;
      for (std::size_t k = 0; k < 3; ++k) {
        std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        if (corner[j] < corner[i]) std::swap(i, j);  // the same arithmetic on both sides of an edge
        const Vec2 along = at[j] - at[i], middle = 0.5 * (at[i] + at[j]);
        const Vec2 normal = Vec2{-along.y, along.x} / norm(along);
        const auto gi = gradient(fit_.frame(corner[i]), cubics[corner[i]], middle - at[i]);
        const auto gj = gradient(fit_.frame(corner[j]), cubics[corner[j]], middle - at[j]);
        const Vec3 across = 0.5 * (normal.x * (gi[0] + gj[0]) + normal.y * (gi[1] + gj[1]));
        const Vec3 tij = net[t_index(i, j)], tji = net[t_index(j, i)];
        const Vec3 by_t = 0.75 * (tji + net[j] - net[i] - tij);
        const Vec2 to = centre - middle;
        const Vec3 inwards = (dot(to, along) / norm2(along)) * by_t + dot(to, normal) * across;
        net[9 + k] = 2 * (inwards / 3 - 0.25 * (inner(i) - 0.5 * net[i] - 0.5 * tij) -
                          0.25 * (inner(j) - 0.5 * net[j] - 0.5 * tji)) +
                     0.5 * (tij + tji);
      }
    }
  });
}

template <int Order>
void SmoothNet::correct(SurfaceJet2& jet, const Net& net, const Edge& edge, const DomainLocator::Frame& frame,
                        const std::array<double, 3>& l) const {
  const auto k = static_cast<std::size_t>(edge.corner), i = (k + 1) % 3, j = (k + 2) % 3;
  const double qi = l[j] + l[k], qj = l[i] + l[k];  // 1 - l_i, 1 - l_j
  if (!(qi > 1e-300) || !(qj > 1e-300)) return;     // at a corner of the triangle: R = 0
  const double t = std::clamp(l[j] + 0.5 * l[k], 0.0, 1.0), ds = edge.s2 - edge.s1;
  const SideJet curve = sides_[static_cast<std::size_t>(edge.side)].jet(edge.s1 + t * ds);
  const Vec3 b0 = net[i], b1 = net[t_index(i, j)], b2 = net[t_index(j, i)], b3 = net[j];
  const double s = 1 - t;
  const Vec3 c0 = s * b0 + t * b1, c1 = s * b1 + t * b2, c2 = s * b2 + t * b3, d0 = s * c0 + t * c1,
             d1 = s * c1 + t * c2;
  const Vec3 r = curve.point - (s * d0 + t * d1);
  const double ai = l[i] / qi, aj = l[j] / qj, phi = ai * ai * aj * aj;
  jet.point = jet.point + phi * r;
  if constexpr (Order >= 1) {
    const Vec3 r1 = ds * curve.first - 3 * (d1 - d0);
    const std::array<Vec2, 3> g = {-(frame.g2 + frame.g3), frame.g2, frame.g3};
    const Vec2 gt = g[j] + 0.5 * g[k];
    const double ai1 = 1 / (qi * qi), aj1 = 1 / (qj * qj);
    const double phi_i = 2 * ai * ai1 * aj * aj, phi_j = 2 * aj * aj1 * ai * ai;
    const Vec2 gphi = phi_i * g[i] + phi_j * g[j];
    jet.du = jet.du + (phi * gt.x) * r1 + gphi.x * r;
    jet.dv = jet.dv + (phi * gt.y) * r1 + gphi.y * r;
    if constexpr (Order >= 2) {
      const Vec3 r2 = (ds * ds) * curve.second - 6 * (c2 - 2 * c1 + c0);
      const double ai2 = 2 * ai1 / qi, aj2 = 2 * aj1 / qj;
      const double ii = 2 * (ai1 * ai1 + ai * ai2) * aj * aj, jj = 2 * (aj1 * aj1 + aj * aj2) * ai * ai,
                   ij = 4 * ai * ai1 * aj * aj1;
      const auto second = [&](double ti, double tj, double pi, double pj, double i1, double i2, double j1, double j2) {
        const double h = ii * i1 * i2 + jj * j1 * j2 + ij * (i1 * j2 + i2 * j1);
        return (phi * ti * tj) * r2 + (ti * pj + tj * pi) * r1 + h * r;
      };
      jet.duu = jet.duu + second(gt.x, gt.x, gphi.x, gphi.x, g[i].x, g[i].x, g[j].x, g[j].x);
      jet.duv = jet.duv + second(gt.x, gt.y, gphi.x, gphi.y, g[i].x, g[i].y, g[j].x, g[j].y);
      jet.dvv = jet.dvv + second(gt.y, gt.y, gphi.y, gphi.y, g[i].y, g[i].y, g[j].y, g[j].y);
    }
  }
}

template <int Order>
SurfaceJet2 SmoothNet::evaluate(const DomainLocator& locator, const DomainPlace& place) const {
  const Net& net = nets_[place.triangle];
  const DomainLocator::Frame& frame = locator.frame(place.triangle);
  const std::array<double, 3> l = {place.l1, place.l2, place.l3};
  const std::size_t k = l[0] <= l[1] ? (l[0] <= l[2] ? 0 : 2) : (l[1] <= l[2] ? 1 : 2);
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  const double r = l[i] - l[k], s = l[j] - l[k], t = 3 * l[k];
  const auto step = [&](Vec3 a, Vec3 b, Vec3 c) { return r * a + s * b + t * c; };
  // The micro-triangle (V_i, V_j, centre): its ten points, of which the inner ones are means of the stored ones.
  const Vec3 ii = inner_point(net, i), ij = inner_point(net, j), ik = inner_point(net, k);
  const Vec3 ci = net[9 + i], cj = net[9 + j], ck = net[9 + k];
  const Vec3 ji = (ii + cj + ck) * (1.0 / 3), jj = (ij + ci + ck) * (1.0 / 3), jk = (ik + ci + cj) * (1.0 / 3);
  const Vec3 centre = (ji + jj + jk) * (1.0 / 3);
  const Vec3 tij = net[t_index(i, j)], tji = net[t_index(j, i)];
  const Vec3 q200 = step(net[i], tij, ii), q110 = step(tij, tji, ck), q101 = step(ii, ck, ji),
             q020 = step(tji, net[j], ij), q011 = step(ck, ij, jj), q002 = step(ji, jj, centre);
  const Vec3 p100 = step(q200, q110, q101), p010 = step(q110, q020, q011), p001 = step(q101, q011, q002);
  SurfaceJet2 jet;
  jet.point = step(p100, p010, p001);
  if constexpr (Order >= 1) {
    const std::array<Vec2, 3> g = {-(frame.g2 + frame.g3), frame.g2, frame.g3};
    const Vec2 gr = g[i] - g[k], gs = g[j] - g[k], gt = 3 * g[k];
    const auto first = [&](double a, double b, double c) { return 3 * (a * p100 + b * p010 + c * p001); };
    jet.du = first(gr.x, gs.x, gt.x);
    jet.dv = first(gr.y, gs.y, gt.y);
    if constexpr (Order >= 2) {
      const auto second = [&](double ra, double sa, double ta, double rb, double sb, double tb) {
        return 6 * (ra * rb * q200 + sa * sb * q020 + ta * tb * q002 + (ra * sb + sa * rb) * q110 +
                    (ra * tb + ta * rb) * q101 + (sa * tb + ta * sb) * q011);
      };
      jet.duu = second(gr.x, gs.x, gt.x, gr.x, gs.x, gt.x);
      jet.duv = second(gr.x, gs.x, gt.x, gr.y, gs.y, gt.y);
      jet.dvv = second(gr.y, gs.y, gt.y, gr.y, gs.y, gt.y);
    }
  }
  for (std::uint32_t e = 0; e < on_side_[place.triangle]; ++e)
    correct<Order>(jet, net, edges_[first_edge_[place.triangle] + e], frame, l);
  return jet;
}

template SurfaceJet2 SmoothNet::evaluate<0>(const DomainLocator&, const DomainPlace&) const;
template SurfaceJet2 SmoothNet::evaluate<1>(const DomainLocator&, const DomainPlace&) const;
template SurfaceJet2 SmoothNet::evaluate<2>(const DomainLocator&, const DomainPlace&) const;

}  // namespace retalho
