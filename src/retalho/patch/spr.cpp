#include "retalho/patch/spr.h"

#include <algorithm>
#include <cmath>

#include "retalho/patch/small_fit.h"
#include "retalho/patch/topology.h"

namespace retalho {
namespace {

constexpr double kCondition = 100;  ///< over which a patch takes in another ring of nodes
constexpr int kRings = 2;           ///< ... at most
constexpr std::uint32_t kFree = 0xffffffffU;

std::vector<std::uint32_t> breadth_first(const Domain& domain, const VertexNeighbors& around) {
  std::vector<std::uint32_t> order;
  if (domain.parameters.empty()) return order;
  const auto far = [&](std::uint32_t v) { return norm2(domain.parameters[v] - Vec2{1.0 / 3, 1.0 / 3}); };
  std::uint32_t start = 0;
  for (std::uint32_t v = 1; v < domain.parameters.size(); ++v)
    if (far(v) < far(start)) start = v;
  std::vector<std::uint8_t> seen(domain.parameters.size(), 0);
  order.push_back(start);
  seen[start] = 1;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (const std::uint32_t w : around.of(order[i]))
      if (seen[w] == 0) {
        seen[w] = 1;
        order.push_back(w);
      }
  return order;
}

}  // namespace

std::vector<std::uint32_t> spr_patches(const Domain& domain, std::size_t& count) {
  const std::size_t nodes = domain.parameters.size();
  const VertexNeighbors around = vertex_neighbors(domain.triangles, nodes);
  const VertexTriangles of = vertex_triangles(domain.triangles, nodes);
  const auto neighbors = triangle_neighbors(domain.triangles);
  std::vector<std::uint8_t> on_side(nodes, 0);
  for (const auto& side : domain.sides)
    for (const std::uint32_t v : side) on_side[v] = 1;
  std::vector<std::uint32_t> patch(domain.triangles.size(), kFree);
  std::vector<std::uint32_t> sizes;
  const auto order = breadth_first(domain, around);
  for (const int wanted : {0, 1})
    for (const std::uint32_t v : order) {
      const auto star = of.of(v);
      if (on_side[v] != wanted || star.size() < (wanted == 0 ? 3U : 2U)) continue;
      if (std::any_of(star.begin(), star.end(), [&](std::uint32_t t) { return patch[t] != kFree; })) continue;
      for (const std::uint32_t t : star) patch[t] = static_cast<std::uint32_t>(sizes.size());
      sizes.push_back(static_cast<std::uint32_t>(star.size()));
    }
  if (sizes.empty()) {  // one or two triangles: all of them are the patch
    count = 1;
    return std::vector<std::uint32_t>(domain.triangles.size(), 0);
  }
  for (bool left = true; left;) {
    left = false;
    for (std::uint32_t t = 0; t < patch.size(); ++t) {
      if (patch[t] != kFree) continue;
      std::uint32_t best = kFree;
      for (const std::uint32_t other : neighbors[t])
        if (other != kNoTriangle && patch[other] != kFree && (best == kFree || sizes[patch[other]] < sizes[best]))
          best = patch[other];
      if (best == kFree) {
        left = true;
      } else {
        patch[t] = best;
        ++sizes[best];
      }
    }
  }
  count = sizes.size();
  return patch;
}

std::vector<NodeQuadratic> spr_quadratics(const Domain& domain, const std::vector<Vec3>& positions) {
  std::size_t count = 0;
  const auto patch = spr_patches(domain, count);
  const VertexNeighbors around = vertex_neighbors(domain.triangles, positions.size());
  std::vector<std::vector<std::uint32_t>> members(count);
  for (std::size_t t = 0; t < patch.size(); ++t)
    members[patch[t]].insert(members[patch[t]].end(), domain.triangles[t].begin(), domain.triangles[t].end());
  Rings rings(around.first, around.vertices);
  SmallFit solver;
  std::vector<double> inverse;
  std::vector<NodeQuadratic> quadratics(count);
  std::vector<Vec2> centres(count);
  for (std::size_t p = 0; p < count; ++p) {
    auto& own = members[p];
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    for (int r = 0;; ++r) {
      std::vector<std::uint32_t> points = rings.grow(own, r == 0 ? 0 : positions.size(), r);
      std::sort(points.begin(), points.end());
      Vec2 centre{};
      for (const std::uint32_t v : points) centre = centre + domain.parameters[v] / static_cast<double>(points.size());
      double h = 0;
      for (const std::uint32_t v : points) {
        const Vec2 d = domain.parameters[v] - centre;
        h = std::max({h, std::abs(d.x), std::abs(d.y)});
      }
      const std::size_t m = points.size();
      const std::size_t n = m >= 6 ? 6 : 3;  // a mesh of fewer nodes: a plane
      solver.resize(m, n);
      for (std::size_t i = 0; i < m; ++i) {
        const Vec2 d = (domain.parameters[points[i]] - centre) / h;
        const std::array<double, 6> terms = {1, d.x, d.y, d.x * d.x, d.x * d.y, d.y * d.y};
        for (std::size_t j = 0; j < n; ++j) solver.at(i, j) = terms[j];
      }
      const double condition = solver.factor();
      const bool last = r == kRings || m == positions.size();
      if (!last && !(n == 6 && condition < kCondition)) continue;
      NodeQuadratic c{};
      if (std::isfinite(condition)) {
        solver.pseudo_inverse(inverse);
        const std::array<double, 6> scale = {1, h, h, h * h, h * h, h * h};
        for (std::size_t j = 0; j < n; ++j)
          for (std::size_t i = 0; i < m; ++i) c[j] = c[j] + (inverse[j * m + i] / scale[j]) * positions[points[i]];
      } else {
        for (const std::uint32_t v : points) c[0] = c[0] + positions[v] / static_cast<double>(m);
      }
      quadratics[p] = c;
      centres[p] = centre;
      break;
    }
  }
  const VertexTriangles of = vertex_triangles(domain.triangles, positions.size());
  std::vector<NodeQuadratic> nodes(positions.size());
  for (std::size_t v = 0; v < nodes.size(); ++v) {
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, of.of(v).size()));
    for (const std::uint32_t t : of.of(v)) {
      const NodeQuadratic& c = quadratics[patch[t]];
      const Vec2 d = domain.parameters[v] - centres[patch[t]];
      NodeQuadratic& q = nodes[v];
      q[0] = q[0] +
             share * (c[0] + d.x * c[1] + d.y * c[2] + (d.x * d.x) * c[3] + (d.x * d.y) * c[4] + (d.y * d.y) * c[5]);
      q[1] = q[1] + share * (c[1] + (2 * d.x) * c[3] + d.y * c[4]);
      q[2] = q[2] + share * (c[2] + d.x * c[4] + (2 * d.y) * c[5]);
      for (std::size_t j = 3; j < 6; ++j) q[j] = q[j] + share * c[j];
    }
  }
  return nodes;
}

}  // namespace retalho
