#include "retalho/model/split_prediction.h"

#include <cmath>

namespace retalho {
namespace {

struct InscribedCircle {
  double radius, tangent;  ///< tangent: from `a` to the point where the circle touches a-b
};

InscribedCircle inscribed_circle(Vec2 a, Vec2 b, Vec2 apex) {
  const double ab = norm(b - a), a_apex = norm(apex - a), b_apex = norm(apex - b);
  return {std::abs(cross(b - a, apex - a)) / (ab + a_apex + b_apex), (ab + a_apex - b_apex) / 2};
}

Vec2 apex_of(const Tin& tin, const EdgeTable& edges, std::uint32_t edge, std::uint32_t triangle) {
  const auto& sides = edges.of_triangle[triangle];
  const std::size_t k = sides[0] == edge ? 0 : sides[1] == edge ? 1 : 2;
  return tin.points[tin.triangles[triangle][k]];
}

}  // namespace

std::vector<double> predict_splits(const Tin& tin, const EdgeTable& edges) {
  std::vector<double> splits(edges.vertices.size(), 0.5);
  for (std::uint32_t e = 0; e < splits.size(); ++e) {
    const auto [t0, t1] = edges.triangles[e];
    if (t1 == kNone) continue;
    const Vec2 a = tin.points[edges.vertices[e][0]], b = tin.points[edges.vertices[e][1]];
    const InscribedCircle c0 = inscribed_circle(a, b, apex_of(tin, edges, e, t0)),
                          c1 = inscribed_circle(a, b, apex_of(tin, edges, e, t1));
    const double split = (c1.radius * c0.tangent + c0.radius * c1.tangent) / (norm(b - a) * (c0.radius + c1.radius));
    if (split > 0 && split < 1) splits[e] = split;
  }
  return splits;
}

}  // namespace retalho
