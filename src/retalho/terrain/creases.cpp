#include "retalho/terrain/creases.h"

#include <algorithm>
#include <numeric>

#include "retalho/terrain/corners.h"
#include "retalho/terrain/gradients.h"

namespace retalho {
namespace {

std::size_t corner_at(const Tin& tin, std::uint32_t triangle, std::uint32_t vertex) {
  const auto& v = tin.triangles[triangle];
  return v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
}

/// Corners of triangles, joined into sectors; a set's root is its lowest corner.
class CornerSets {
 public:
  explicit CornerSets(std::size_t corners) : parent_(corners) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t c) {
    while (parent_[c] != c) c = parent_[c] = parent_[parent_[c]];
    return c;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// The derivative along a straight line through three heights' parabola, at the middle one, by unit of length.
double middle_slope(double before, double after, double rise_before, double rise_after) {
  const double s = rise_before / before, t = rise_after / after;
  return (s * after + t * before) / (before + after);
}

}  // namespace

void TriangleCorners::set_creased(const Terrain& terrain, std::uint32_t triangle) {
  const Tin& tin = terrain.tin;
  bool changed = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const Vec2 edge = point[j] - point[i];
    along[k] = {dot(gradient[i], edge), -dot(gradient[j], edge)};
    const std::uint32_t other = tin.neighbors[triangle][k];
    if (other == kNone) continue;
    const std::size_t ends[2] = {i, j};
    for (std::size_t e = 0; e < 2; ++e) {
      const std::uint32_t own = terrain.corner_gradients[triangle][ends[e]];
      const std::uint32_t theirs = terrain.corner_gradients[other][corner_at(tin, other, vertex[ends[e]])];
      if (own == theirs) continue;
      const double across = dot(terrain.gradients[theirs], edge);
      along[k][e] = (along[k][e] + (e == 0 ? across : -across)) / 2;
      changed = true;
    }
  }
  creased = changed;
  if (!changed) return;
  // The plane at a corner through both edges' slopes.
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const Vec2 to_i = point[i] - point[k], to_j = point[j] - point[k];
    const double slope_i = along[j][0], slope_j = along[i][1];  // edge j leaves corner k, edge i ends there
    if (slope_i == dot(gradient[k], to_i) && slope_j == dot(gradient[k], to_j)) continue;
    const double area2 = cross(to_i, to_j);
    gradient[k] = {(slope_i * to_j.y - slope_j * to_i.y) / area2, (to_i.x * slope_j - to_j.x * slope_i) / area2};
  }
}

std::vector<std::array<std::uint32_t, 3>> crease_sectors(const Tin& tin, const EdgeTable& edges,
                                                         std::span<const std::uint32_t> creases, std::size_t* nodes) {
  std::vector<char> is_crease(edges.vertices.size(), 0), split(tin.vertex_count(), 0);
  for (const std::uint32_t e : creases) {
    is_crease[e] = 1;
    for (const std::uint32_t v : edges.vertices[e]) split[v] = 1;
  }
  CornerSets sets(3 * tin.triangle_count());
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [t, o] = edges.triangles[e];
    if (o == kNone || is_crease[e]) continue;
    for (const std::uint32_t v : edges.vertices[e])
      if (split[v])
        sets.join(static_cast<std::uint32_t>(3 * t + corner_at(tin, t, v)),
                  static_cast<std::uint32_t>(3 * o + corner_at(tin, o, v)));
  }
  // Roots by vertex, then by corner.
  std::vector<std::array<std::uint32_t, 2>> roots;
  for (std::uint32_t t = 0; t < tin.triangle_count(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k)
      if (split[tin.triangles[t][k]] && sets.root(3 * t + k) == 3 * t + k)
        roots.push_back({tin.triangles[t][k], 3 * t + k});
  std::sort(roots.begin(), roots.end());
  std::vector<std::array<std::uint32_t, 3>> sectors = tin.triangles;
  auto next = static_cast<std::uint32_t>(tin.vertex_count());
  std::vector<std::uint32_t> number(3 * tin.triangle_count());
  for (std::size_t r = 0; r < roots.size(); ++r)
    number[roots[r][1]] = r > 0 && roots[r - 1][0] == roots[r][0] ? next++ : roots[r][0];
  for (std::uint32_t t = 0; t < tin.triangle_count(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k)
      if (split[tin.triangles[t][k]]) sectors[t][k] = number[sets.root(3 * t + k)];
  if (nodes) *nodes = next;
  return sectors;
}

std::vector<std::uint32_t> sector_vertices(const Tin& tin, std::span<const std::array<std::uint32_t, 3>> sectors,
                                           std::size_t nodes) {
  std::vector<std::uint32_t> vertex(nodes);
  std::iota(vertex.begin(), vertex.end(), 0U);
  for (std::size_t t = 0; t < sectors.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) vertex[sectors[t][k]] = tin.triangles[t][k];
  return vertex;
}

std::vector<Vec2> sector_gradients(const Tin& tin, const EdgeTable& edges, std::span<const std::uint32_t> creases,
                                   std::span<const std::array<std::uint32_t, 3>> sectors, GradientKind kind,
                                   const Context& context) {
  std::size_t nodes = tin.vertex_count();
  for (const auto& s : sectors)
    for (const std::uint32_t n : s) nodes = std::max<std::size_t>(nodes, n + std::size_t{1});
  const std::vector<std::uint32_t> vertex = sector_vertices(tin, sectors, nodes);
  Tin open;  // the TIN cut along its creases
  open.triangles.assign(sectors.begin(), sectors.end());
  for (const std::uint32_t v : vertex) {
    open.points.push_back(tin.points[v]);
    open.heights.push_back(tin.heights[v]);
  }
  build_neighbors(open);
  std::vector<Vec2> gradients = estimate_gradients(open, build_edges(open), kind, context);

  std::vector<std::array<std::uint32_t, 2>> next(tin.vertex_count(), {kNone, kNone});
  std::vector<std::uint32_t> count(tin.vertex_count(), 0);
  for (const std::uint32_t e : creases) {
    const auto [a, b] = edges.vertices[e];
    if (count[a]++ < 2) next[a][count[a] - 1] = b;
    if (count[b]++ < 2) next[b][count[b] - 1] = a;
  }
  for (std::size_t n = 0; n < nodes; ++n) {
    const std::uint32_t v = vertex[n];
    if (count[v] != 2) continue;
    const Vec2 back = tin.points[v] - tin.points[next[v][0]], on = tin.points[next[v][1]] - tin.points[v];
    const double before = norm(back), after = norm(on);
    if (dot(back, on) < 0.5 * before * after) continue;  // a corner of 60 degrees or more: no common direction
    Vec2 tangent = back / before + on / after;
    tangent = tangent / norm(tangent);
    const double slope =
        middle_slope(before, after, tin.heights[v] - tin.heights[next[v][0]], tin.heights[next[v][1]] - tin.heights[v]);
    gradients[n] = gradients[n] + (slope - dot(gradients[n], tangent)) * tangent;
  }
  return gradients;
}

}  // namespace retalho
