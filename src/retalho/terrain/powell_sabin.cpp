#include "retalho/terrain/powell_sabin.h"

#include "retalho/core/parallel.h"
#include "retalho/terrain/corners.h"

namespace retalho {
namespace {

struct InscribedCircle {
  double radius, tangent;  ///< tangent: from the edge's first end to the point where the circle touches
};

/// Of triangle (a, b, apex) with the edge a-b.
InscribedCircle inscribed_circle(Vec2 a, Vec2 b, Vec2 apex) {
  const double ab = norm(b - a), a_apex = norm(apex - a), b_apex = norm(apex - b);
  return {std::abs(cross(b - a, apex - a)) / (ab + a_apex + b_apex), (ab + a_apex - b_apex) / 2};
}

std::uint32_t apex(const Tin& tin, const EdgeTable& edges, std::uint32_t edge, std::uint32_t triangle) {
  for (std::size_t k = 0; k < 3; ++k)
    if (edges.of_triangle[triangle][k] == edge) return tin.triangles[triangle][k];
  return kNone;  // not reached: the table says that the triangle has the edge
}

double split_of(const Tin& tin, const EdgeTable& edges, std::uint32_t edge) {
  const auto [t0, t1] = edges.triangles[edge];
  if (t1 == kNone) return 0.5;
  return powell_sabin_split(tin.points[edges.vertices[edge][0]], tin.points[edges.vertices[edge][1]],
                            tin.points[apex(tin, edges, edge, t0)], tin.points[apex(tin, edges, edge, t1)]);
}

}  // namespace

double powell_sabin_split(Vec2 a, Vec2 b, Vec2 apex, Vec2 other_apex) {
  const InscribedCircle c0 = inscribed_circle(a, b, apex), c1 = inscribed_circle(a, b, other_apex);
  const double split = (c1.radius * c0.tangent + c0.radius * c1.tangent) / (norm(b - a) * (c0.radius + c1.radius));
  // A convex combination of numbers in (0, 1); only for triangles that are flat to the last digit does rounding leave
  // it.
  return split > 0 && split < 1 ? split : 0.5;
}

std::array<double, 3> incentre_weights(Vec2 a, Vec2 b, Vec2 c) {
  const double wa = norm(c - b), wb = norm(a - c), wc = norm(b - a);
  const double sum = wa + wb + wc;
  return {wa / sum, wb / sum, wc / sum};
}

std::vector<double> powell_sabin_splits(const Tin& tin, const EdgeTable& edges, const Context& context) {
  std::vector<double> splits(edges.vertices.size());
  parallel_chunks(splits.size(), 8192, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) splits[e] = split_of(tin, edges, static_cast<std::uint32_t>(e));
  });
  return splits;
}

TriangleFrame PowellSabinElement::frame(int piece, const TriangleFrame& macro) const {
  const Map map(*this, piece);
  const Barycentric along_x = map({macro.grad_r.x, macro.grad_s.x, macro.grad_t.x});
  const Barycentric along_y = map({macro.grad_r.y, macro.grad_s.y, macro.grad_t.y});
  TriangleFrame frame;
  frame.grad_r = {along_x.r, along_y.r};
  frame.grad_s = {along_x.s, along_y.s};
  frame.grad_t = {along_x.t, along_y.t};
  return frame;
}

PowellSabinElement powell_sabin_element(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle) {
  const auto& sides = edges.of_triangle[triangle];
  return powell_sabin_element(
      TriangleCorners(terrain, triangle),
      {terrain.edge_split[sides[0]], terrain.edge_split[sides[1]], terrain.edge_split[sides[2]]});
}

PowellSabinElement powell_sabin_element(const TriangleCorners& c, const std::array<double, 3>& splits) {
  PowellSabinElement e;
  e.weight = incentre_weights(c.point[0], c.point[1], c.point[2]);
  e.corner = c.height;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const Vec2 to_centre = e.weight[i] * (c.point[i] - c.point[k]) + e.weight[j] * (c.point[j] - c.point[k]);
    e.spoke[k] = c.height[k] + dot(c.gradient[k], to_centre) / 2;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t low = (k + 1) % 3, high = (k + 2) % 3;
    const bool forward = c.vertex[low] < c.vertex[high];
    if (!forward) std::swap(low, high);
    // From the lower-index end, whichever side asks: the same bits on both sides of the edge.
    const double fraction = splits[k];
    const Vec2 along = c.point[high] - c.point[low];
    const double from_low = c.creased ? c.along[k][forward ? 0 : 1] : dot(c.gradient[low], along);
    const double from_high = c.creased ? -c.along[k][forward ? 1 : 0] : dot(c.gradient[high], along);
    const double near_low = c.height[low] + fraction / 2 * from_low;
    const double near_high = c.height[high] - (1 - fraction) / 2 * from_high;
    e.split_value[k] = fraction * near_high + (1 - fraction) * near_low;
    e.rib[k] = fraction * e.spoke[high] + (1 - fraction) * e.spoke[low];
    e.split[k] = forward ? fraction : 1 - fraction;
    e.first[k] = forward ? near_low : near_high;
    e.second[k] = forward ? near_high : near_low;
  }
  e.centre = e.weight[0] * e.spoke[0] + e.weight[1] * e.spoke[1] + e.weight[2] * e.spoke[2];
  return e;
}

}  // namespace retalho
