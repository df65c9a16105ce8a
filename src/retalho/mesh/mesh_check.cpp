#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "retalho/core/error.h"
#include "retalho/mesh/mesh.h"
#include "retalho/mesh/open_edges.h"

namespace retalho {
namespace {

/// One triangle's side: its ends in order of their numbers, and whether the triangle runs from the lower one.
struct Side {
  std::uint32_t low, high;
  bool upwards;
  friend bool operator<(const Side& a, const Side& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; }
  bool along(const Side& o) const { return low == o.low && high == o.high; }
};

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  // Counting by the lower end first leaves only short runs to sort.
  const std::size_t n = mesh.positions.size();
  std::vector<std::size_t> start(n + 1, 0);
  const auto each = [&](auto&& use) {
    for (const auto& v : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = v[k], b = v[(k + 1) % 3];
        if (a != b) use(Side{std::min(a, b), std::max(a, b), a < b});
      }
  };
  each([&](const Side& s) { ++start[s.low + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Side> sides(start[n]);
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  each([&](const Side& s) { sides[next[s.low]++] = s; });
  for (std::size_t v = 0; v < n; ++v)
    std::sort(sides.begin() + static_cast<std::ptrdiff_t>(start[v]),
              sides.begin() + static_cast<std::ptrdiff_t>(start[v + 1]));
  return sides;
}

/// Do the two run along each other, in opposite directions, by more than a point (seen from above)?
bool runs_back(const OpenEdge& e, const OpenEdge& f) {
  constexpr double kShare = 1e-9;
  const Vec2 a{e.a.x, e.a.y}, d{e.b.x - e.a.x, e.b.y - e.a.y}, c{f.a.x, f.a.y}, g{f.b.x - f.a.x, f.b.y - f.a.y};
  const double length2 = norm2(d);
  if (length2 == 0) return e.a == f.b && e.b == f.a;
  if (!(dot(d, g) < 0)) return false;
  const double slack = kShare * std::max(length2, norm2(g));
  if (std::abs(cross(d, c - a)) > slack || std::abs(cross(d, c + g - a)) > slack) return false;
  const double from = dot(d, c + g - a) / length2, to = dot(d, c - a) / length2;  // f, turned round, in e's parameter
  return std::min(to, 1.0) - std::max(from, 0.0) > kShare;
}

bool degenerate(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& v) {
  if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return true;
  const Vec3 a = mesh.positions[v[0]];
  return norm2(cross(mesh.positions[v[1]] - a, mesh.positions[v[2]] - a)) == 0;
}

}  // namespace

/// Sweep over x with the edges that reach the sweep line kept by their strip of y.
std::size_t count_cracks(std::vector<OpenEdge> edges) {
  if (edges.size() < 2) return 0;
  const auto low_x = [](const OpenEdge& e) { return std::min(e.a.x, e.b.x); };
  const auto high_x = [](const OpenEdge& e) { return std::max(e.a.x, e.b.x); };
  std::sort(edges.begin(), edges.end(), [&](const OpenEdge& e, const OpenEdge& f) { return low_x(e) < low_x(f); });
  double low = edges[0].a.y, high = low;
  for (const OpenEdge& e : edges) low = std::min({low, e.a.y, e.b.y}), high = std::max({high, e.a.y, e.b.y});
  const std::size_t strips = std::max<std::size_t>(1, std::min<std::size_t>(edges.size() / 4, 1U << 16));
  const double height = std::max((high - low) / static_cast<double>(strips), 1e-300);
  const auto strip = [&](double y) {
    return std::min(strips - 1, static_cast<std::size_t>(std::max(0.0, (y - low) / height)));
  };
  std::vector<std::vector<std::uint32_t>> active(strips);
  std::vector<bool> cracked(edges.size(), false);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const std::size_t first = strip(std::min(edges[e].a.y, edges[e].b.y)),
                      last = strip(std::max(edges[e].a.y, edges[e].b.y));
    for (std::size_t s = first > 0 ? first - 1 : 0; s <= std::min(strips - 1, last + 1); ++s) {
      std::erase_if(active[s], [&](std::uint32_t f) { return high_x(edges[f]) < low_x(edges[e]); });
      for (const std::uint32_t f : active[s])
        if (runs_back(edges[e], edges[f])) cracked[e] = cracked[f] = true;
    }
    for (std::size_t s = first; s <= last; ++s) active[s].push_back(e);
  }
  return static_cast<std::size_t>(std::count(cracked.begin(), cracked.end(), true));
}

std::vector<std::uint32_t> parts_of(const TriangleMesh& mesh, std::size_t& count) {
  std::vector<std::uint32_t> parent(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<std::uint32_t> part(parent.size(), kNoPart);
  for (const auto& v : mesh.triangles) {
    for (const std::uint32_t k : v) part[k] = 0;
    parent[root(v[1])] = root(v[0]);
    parent[root(v[2])] = root(v[0]);
  }
  std::vector<std::uint32_t> number(parent.size(), kNoPart);
  count = 0;
  for (std::uint32_t v = 0; v < parent.size(); ++v) {
    if (part[v] == kNoPart) continue;
    std::uint32_t& n = number[root(v)];
    if (n == kNoPart) n = static_cast<std::uint32_t>(count++);
    part[v] = n;
  }
  return part;
}

MeshCheck check_mesh(const TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.positions.size())
        throw BadInput(fmt::format("triangle {} names vertex {} of {}", t, v, mesh.positions.size()));
  MeshCheck check;
  for (const auto& v : mesh.triangles) check.degenerate_triangles += degenerate(mesh, v);
  const std::vector<Side> sides = sorted_sides(mesh);
  std::vector<OpenEdge> open;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i, upwards = 0;
    for (; end < sides.size() && sides[end].along(sides[i]); ++end) upwards += sides[end].upwards;
    if (end - i == 1) {
      const Vec3 low = mesh.positions[sides[i].low], high = mesh.positions[sides[i].high];
      open.push_back(sides[i].upwards ? OpenEdge{low, high} : OpenEdge{high, low});
    } else if (end - i > 2 || upwards != 1) {
      ++check.nonmanifold_edges;
    }
    i = end;
  }
  check.open_edges = open.size();
  check.cracks = count_cracks(std::move(open));
  check.boundary_edges = check.open_edges - check.cracks;
  parts_of(mesh, check.components);
  return check;
}

}  // namespace retalho
