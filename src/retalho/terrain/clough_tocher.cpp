#include "retalho/terrain/clough_tocher.h"

#include <algorithm>

#include "retalho/core/parallel.h"
#include "retalho/terrain/corners.h"

namespace retalho {
namespace {

/// The corner of `neighbor` that is not on the edge it shares as edge number `edge`.
std::size_t opposite_corner(const EdgeTable& edges, std::uint32_t neighbor, std::uint32_t edge) {
  const auto& sides = edges.of_triangle[neighbor];
  return sides[0] == edge ? 0 : sides[1] == edge ? 1 : 2;
}

/// Both triangles taken as single cubics with one free ordinate each: the value that makes the second derivatives
/// across the edge agree in the mean. The same surface from both sides; cubics are reproduced.
double cubic_interior(const TriangleCorners& c, const CloughTocherElement& e, std::size_t k, Vec2 apex,
                      double apex_height, Vec2 apex_gradient) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  const double area2 = cross(c.point[i] - c.point[k], c.point[j] - c.point[k]);
  const double r = cross(c.point[j] - apex, c.point[k] - apex) / area2;
  const double s = cross(c.point[k] - apex, c.point[i] - apex) / area2;
  const double t = 1 - r - s;
  const double across_i = apex_height + dot(apex_gradient, c.point[i] - apex) / 3;
  const double across_j = apex_height + dot(apex_gradient, c.point[j] - apex) / 3;
  const double b300 = c.height[i], b030 = c.height[j], b210 = e.first[k], b120 = e.second[k];
  // Edge j runs from corner k to corner i, edge i from corner j to corner k.
  const double b201 = e.second[j], b102 = e.first[j], b021 = e.first[i], b012 = e.second[i];
  return (across_i + across_j - r * r * (b300 + b210) - 2 * r * s * (b210 + b120) - 2 * r * t * b201 -
          s * s * (b120 + b030) - 2 * s * t * b021 - t * t * (b102 + b012)) /
         (2 * t * (1 - t));
}

/// Linear along edge k in the direction perpendicular to it: the paper's rule.
double perpendicular_face(const TriangleCorners& c, const CloughTocherElement& e, std::size_t k) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  const Vec2 along = c.point[j] - c.point[i];
  const Vec2 to_centroid = (along + (c.point[k] - c.point[i])) / 3;
  const double theta = dot(to_centroid, along) / norm2(along);
  return (e.spoke[i] + e.spoke[j] + (theta - 1) * e.corner[i] + (2 - 3 * theta) * e.first[k] +
          (3 * theta - 1) * e.second[k] - theta * e.corner[j]) /
         2;
}

void set_cubic_faces(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle, const TriangleCorners& c,
                     CloughTocherElement& e) {
  double sum = 0;  // of the interior ordinates that the neighbours ask for
  int count = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t edge = edges.of_triangle[triangle][k], neighbor = terrain.tin.neighbors[triangle][k];
    if (neighbor == kNone) continue;
    if (terrain.edge_fallback[edge]) {
      e.face[k] = perpendicular_face(c, e, k);
      continue;
    }
    const std::size_t corner = opposite_corner(edges, neighbor, edge);
    const std::uint32_t apex = terrain.tin.triangles[neighbor][corner];
    const double interior = cubic_interior(c, e, k, terrain.tin.points[apex], terrain.tin.heights[apex],
                                           terrain.gradients[gradient_of(terrain, neighbor, corner)]);
    e.face[k] = (e.first[k] + e.second[k] + interior) / 3;
    sum += interior;
    ++count;
  }
  // Nobody looks at a border edge from the other side: the mean of what the inner edges ask for keeps cubics exact;
  // where they ask for nothing, the value that is exact for quadratics.
  const double border = count > 0
                            ? sum / count
                            : (e.first[0] + e.first[1] + e.first[2] + e.second[0] + e.second[1] + e.second[2]) / 4 -
                                  (c.height[0] + c.height[1] + c.height[2]) / 6;
  for (std::size_t k = 0; k < 3; ++k)
    if (terrain.tin.neighbors[triangle][k] == kNone) e.face[k] = (e.first[k] + e.second[k] + border) / 3;
}

bool too_unlike(Vec2 a, Vec2 b, Vec2 own_apex, Vec2 other_apex) {
  const double area2 = cross(b - a, own_apex - a);
  const double r = cross(b - other_apex, own_apex - other_apex) / area2;
  const double s = cross(own_apex - other_apex, a - other_apex) / area2;
  const double t = 1 - r - s;
  const double reach = std::max(std::abs(r), std::abs(s));
  const bool sound = t <= -0.1 && t >= -10 && reach <= 10 && reach <= 10 * std::abs(t);
  return !sound;  // also where a flat triangle gave no number
}

}  // namespace

std::vector<std::uint8_t> cubic_fallbacks(const Tin& tin, const EdgeTable& edges, const Context& context) {
  std::vector<std::uint8_t> fallback(edges.vertices.size(), 0);
  parallel_chunks(fallback.size(), 8192, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const auto [t0, t1] = edges.triangles[e];
      if (t1 == kNone) continue;
      const auto edge = static_cast<std::uint32_t>(e);
      const std::size_t k0 = opposite_corner(edges, t0, edge), k1 = opposite_corner(edges, t1, edge);
      const auto& v = tin.triangles[t0];
      fallback[e] = too_unlike(tin.points[v[(k0 + 1) % 3]], tin.points[v[(k0 + 2) % 3]], tin.points[v[k0]],
                               tin.points[tin.triangles[t1][k1]]);
    }
  });
  return fallback;
}

TriangleFrame CloughTocherElement::frame(int piece, const TriangleFrame& macro) const {
  const std::array<Vec2, 3> grad{macro.grad_r, macro.grad_s, macro.grad_t};
  const auto k = static_cast<std::size_t>(piece);
  TriangleFrame frame;
  frame.grad_r = grad[(k + 1) % 3] - grad[k];
  frame.grad_s = grad[(k + 2) % 3] - grad[k];
  frame.grad_t = 3 * grad[k];
  return frame;
}

namespace {

/// Everything that stands before the faces.
CloughTocherElement outer_ordinates(const TriangleCorners& c) {
  CloughTocherElement e;
  e.corner = c.height;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    // Each from its own corner alone: the same bits on both sides of the edge.
    const double from_i = c.creased ? c.along[k][0] : dot(c.gradient[i], c.point[j] - c.point[i]);
    const double from_j = c.creased ? c.along[k][1] : dot(c.gradient[j], c.point[i] - c.point[j]);
    e.first[k] = c.height[i] + from_i / 3;
    e.second[k] = c.height[j] + from_j / 3;
    const Vec2 to_centroid = ((c.point[i] - c.point[k]) + (c.point[j] - c.point[k])) / 3;
    e.spoke[k] = c.height[k] + dot(c.gradient[k], to_centroid) / 3;
  }
  return e;
}

void set_perpendicular_faces(const TriangleCorners& c, CloughTocherElement& e) {
  for (std::size_t k = 0; k < 3; ++k) e.face[k] = perpendicular_face(c, e, k);
}

void set_inner_ordinates(CloughTocherElement& e) {
  for (std::size_t k = 0; k < 3; ++k) e.inner[k] = (e.spoke[k] + e.face[(k + 1) % 3] + e.face[(k + 2) % 3]) / 3;
  e.centre = (e.inner[0] + e.inner[1] + e.inner[2]) / 3;
}

}  // namespace

CloughTocherElement clough_tocher_element(const TriangleCorners& corners) {
  CloughTocherElement e = outer_ordinates(corners);
  set_perpendicular_faces(corners, e);
  set_inner_ordinates(e);
  return e;
}

CloughTocherElement clough_tocher_element(const Terrain& terrain, const EdgeTable& edges, std::uint32_t triangle) {
  const TriangleCorners c(terrain, triangle);
  if (terrain.cross_derivative != CrossDerivative::cubic) return clough_tocher_element(c);
  CloughTocherElement e = outer_ordinates(c);
  set_cubic_faces(terrain, edges, triangle, c, e);
  set_inner_ordinates(e);
  return e;
}

}  // namespace retalho
