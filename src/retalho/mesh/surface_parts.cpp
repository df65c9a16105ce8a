#include "retalho/mesh/surface_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"

namespace retalho {
namespace {

constexpr std::uint32_t kNone = ~0U;

Vec3 middle_of(const TriangleMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3;
}

/// Numbers from 0 up, in the order of the triangles.
std::vector<std::uint32_t> joined_by_vertices(const TriangleMesh& mesh, std::size_t& count) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&parent](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 1; i < 3; ++i) parent[root(t[i])] = root(t[0]);
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone), joined;
  joined.reserve(mesh.triangles.size());
  count = 0;
  for (const auto& t : mesh.triangles) {
    std::uint32_t& at = number[root(t[0])];
    if (at == kNone) at = static_cast<std::uint32_t>(count++);
    joined.push_back(at);
  }
  return joined;
}

/// The triangles in each tetrahedron: those whose middle it holds.
class TrianglesOfTets {
 public:
  TrianglesOfTets(const TriangleMesh& mesh, const TetMesh& tets) {
    for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n)
      if (const std::int64_t t = tets.locate(middle_of(mesh, n)); t >= 0)
        pairs_.emplace_back(static_cast<std::uint32_t>(t), n);
    std::sort(pairs_.begin(), pairs_.end());
  }
  /// All pairs of a tetrahedron and a triangle, ascending.
  const std::vector<std::pair<std::uint32_t, std::uint32_t>>& all() const { return pairs_; }

  template <typename Visit>
  void in(std::uint32_t tet, const Visit& visit) const {
    for (auto at = std::lower_bound(pairs_.begin(), pairs_.end(), std::pair{tet, 0U});
         at != pairs_.end() && at->first == tet; ++at)
      visit(at->second);
  }

 private:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;
};

/// The part of the triangle next to the point's foot, or kNone.
std::uint32_t part_near(const TriangleMesh& mesh, const TetraQuadField& field, const TrianglesOfTets& triangles,
                        const std::vector<std::uint32_t>& of_triangle, Vec3 p) {
  if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return kNone;
  const auto foot = field.project(p);
  if (!foot) return kNone;
  const TetMesh& tets = field.surface().mesh;
  const std::int64_t tet = tets.locate(foot->point);
  if (tet < 0 || norm(foot->point - p) > tets.step * tets.size(static_cast<std::size_t>(tet))) return kNone;
  double nearest = std::numeric_limits<double>::infinity();
  std::uint32_t part = kNone;
  triangles.in(static_cast<std::uint32_t>(tet), [&](std::uint32_t n) {
    const double distance = norm2(middle_of(mesh, n) - foot->point);
    if (distance >= nearest) return;
    nearest = distance;
    part = of_triangle[n];
  });
  return part;
}

void count_points(const TriangleMesh& mesh, const TetraQuadField& field, const PointCloud& points, SurfaceParts& found,
                  const Context& context) {
  constexpr std::size_t grain = 4096;
  const TrianglesOfTets triangles(mesh, field.surface().mesh);
  std::vector<std::vector<std::size_t>> counts((points.positions.size() + grain - 1) / grain);
  parallel_chunks(points.positions.size(), grain, context, [&](std::size_t begin, std::size_t end) {
    std::vector<std::size_t>& own = counts[begin / grain];
    own.assign(found.parts.size(), 0);
    for (std::size_t k = begin; k < end; ++k)
      if (const std::uint32_t part = part_near(mesh, field, triangles, found.of_triangle, points.positions[k]);
          part != kNone)
        ++own[part];
  });
  for (const std::vector<std::size_t>& own : counts)
    for (std::size_t n = 0; n < own.size(); ++n) found.parts[n].points += own[n];
}

}  // namespace

SurfaceParts find_parts(const TriangleMesh& mesh, const TetraQuadField& field, const PointCloud& points,
                        const Context& context) {
  SurfaceParts found;
  std::size_t count = 0;
  found.of_triangle = joined_by_vertices(mesh, count);
  found.parts.resize(count);
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    SurfacePart& part = found.parts[found.of_triangle[n]];
    const auto& t = mesh.triangles[n];
    if (part.triangles++ == 0) part.low = part.high = mesh.positions[t[0]];
    part.area +=
        0.5 * norm(cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]));
    for (const std::uint32_t v : t) {
      const Vec3 p = mesh.positions[v];
      part.low = {std::min(part.low.x, p.x), std::min(part.low.y, p.y), std::min(part.low.z, p.z)};
      part.high = {std::max(part.high.x, p.x), std::max(part.high.y, p.y), std::max(part.high.z, p.z)};
    }
  }
  if (count == 1) found.parts[0].points = points.positions.size();
  if (count < 2) return found;
  count_points(mesh, field, points, found, context);
  std::vector<std::uint32_t> order(count), place(count);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const SurfacePart &x = found.parts[a], &y = found.parts[b];
    return std::tie(x.points, x.area) > std::tie(y.points, y.area);
  });
  std::vector<SurfacePart> sorted;
  for (const std::uint32_t n : order) {
    place[n] = static_cast<std::uint32_t>(sorted.size());
    sorted.push_back(found.parts[n]);
  }
  found.parts = std::move(sorted);
  for (std::uint32_t& part : found.of_triangle) part = place[part];
  return found;
}

std::vector<char> choose_parts(const SurfaceParts& found, const PartChoice& choice) {
  if (choice.most < 1) throw UsageError("parts must be 1 or more", {}, "parts");
  std::vector<char> keep(found.parts.size(), 1);
  for (std::size_t n = 0; n < keep.size(); ++n)
    if (n >= choice.most || found.parts[n].points < choice.points) keep[n] = 0;
  if (!keep.empty() && keep[0] == 0)
    throw UsageError(fmt::format("no part of the surface has {} points near it, the largest has {}: ask for fewer",
                                 choice.points, found.parts[0].points),
                     {}, "part_points");
  return keep;
}

TriangleMesh keep_parts(const TriangleMesh& mesh, const SurfaceParts& parts, const std::vector<char>& keep) {
  TriangleMesh kept = mesh;
  kept.triangles.clear();
  std::vector<std::uint32_t> number(mesh.positions.size(), kNone);
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    if (keep[parts.of_triangle[n]] == 0) continue;
    kept.triangles.push_back(mesh.triangles[n]);
    for (const std::uint32_t v : mesh.triangles[n]) number[v] = 0;
  }
  std::uint32_t count = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    number[v] = count;
    kept.positions[count] = mesh.positions[v];
    if (!mesh.normals.empty()) kept.normals[count] = mesh.normals[v];
    if (!mesh.texture.empty()) kept.texture[count] = mesh.texture[v];
    ++count;
  }
  kept.positions.resize(count);
  if (!mesh.normals.empty()) kept.normals.resize(count);
  if (!mesh.texture.empty()) kept.texture.resize(count);
  for (auto& t : kept.triangles)
    for (std::uint32_t& v : t) v = number[v];
  return kept;
}

std::vector<char> tetrahedra_left_out(const TriangleMesh& mesh, const TetraQuadField& field, const SurfaceParts& parts,
                                      std::vector<char>& keep) {
  const TrianglesOfTets triangles(mesh, field.surface().mesh);
  std::vector<char> left_out(field.surface().mesh.tets.size(), 0);
  for (bool is_settled = false; !is_settled;) {
    is_settled = true;
    std::fill(left_out.begin(), left_out.end(), 0);
    for (const auto& [tet, triangle] : triangles.all()) left_out[tet] = 1;
    for (const auto& [tet, triangle] : triangles.all())
      if (keep[parts.of_triangle[triangle]] != 0) left_out[tet] = 0;
    for (const auto& [tet, triangle] : triangles.all()) {
      char& mark = keep[parts.of_triangle[triangle]];
      if (left_out[tet] != 0 || mark != 0) continue;
      mark = 1;
      is_settled = false;
    }
  }
  return left_out;
}

}  // namespace retalho
