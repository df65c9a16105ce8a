#include "retalho/tin/scattered_mesh.h"

#include <cassert>
#include <utility>

#include "retalho/tin/predicates.h"

namespace retalho {
namespace {

constexpr std::array<std::uint32_t, 3> kNext{1, 2, 0}, kPrevious{2, 0, 1};

/// q, which is on the line through a and b, lies strictly between them.
bool between(Vec2 a, Vec2 b, Vec2 q) {
  return a.x != b.x ? (a.x < q.x) == (q.x < b.x) && q.x != a.x && q.x != b.x
                    : (a.y < q.y) == (q.y < b.y) && q.y != a.y && q.y != b.y;
}

}  // namespace

ScatteredMesh::ScatteredMesh(const std::vector<Vec2>& at, std::uint32_t a, std::uint32_t b, std::uint32_t c,
                             std::size_t expected)
    : at_(at) {
  if (orientation(at[a], at[b], at[c]) < 0) std::swap(b, c);
  triangles_.reserve(2 * expected + 2);
  triangles_.push_back({{a, b, c}, {1, 2, 3}});
  triangles_.push_back({{kGhost, c, b}, {0, 3, 2}});
  triangles_.push_back({{kGhost, a, c}, {0, 1, 3}});
  triangles_.push_back({{kGhost, b, a}, {0, 2, 1}});
}

bool ScatteredMesh::in_conflict(std::uint32_t t, Vec2 q) const {
  const auto& v = triangles_[t].v;
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (v[k] != kGhost) continue;
    const Vec2 a = at_[v[kNext[k]]], b = at_[v[kPrevious[k]]];
    const int side = orientation(a, b, q);
    return side > 0 || (side == 0 && between(a, b, q));
  }
  return in_circle(at_[v[0]], at_[v[1]], at_[v[2]], q) > 0;
}

std::uint32_t ScatteredMesh::locate(Vec2 q, std::uint32_t hint) const {
  // Visibility walk: it ends on a Delaunay triangulation, whichever edge is tried first.
  std::uint32_t t = hint, from = kNone;
  if (is_ghost(t))
    for (std::uint32_t k = 0; k < 3; ++k)
      if (triangles_[t].v[k] == kGhost) {
        t = triangles_[t].n[k];
        break;
      }
  for (;;) {
    const Triangle& tri = triangles_[t];
    std::uint32_t next = kNone;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (tri.n[k] == from) continue;
      if (orientation(at_[tri.v[kNext[k]]], at_[tri.v[kPrevious[k]]], q) < 0) {
        next = tri.n[k];
        break;
      }
    }
    if (next == kNone || is_ghost(next)) return next == kNone ? t : next;
    from = t;
    t = next;
  }
}

/// Finds the cavity of q into star_ and its border, counter-clockwise, into border_.
void ScatteredMesh::collect(std::uint32_t first, Vec2 q) {
  star_.clear();
  border_.clear();
  pending_.clear();
  star_.push_back(first);
  // Depth first, edges in order: the border comes out in order. A pending entry is one edge of a cavity triangle.
  for (std::uint32_t k = 3; k-- > 0;) pending_.push_back({first, k});
  while (!pending_.empty()) {
    const auto [t, k] = pending_.back();
    pending_.pop_back();
    const Triangle& tri = triangles_[t];
    const std::uint32_t other = tri.n[k];
    const auto& back = triangles_[other].n;
    // Two triangles share one edge only, save in the smallest meshes, where the shared vertices tell the edge.
    const std::uint32_t a = tri.v[kNext[k]];
    std::uint32_t slot = 0;
    while (back[slot] != t || triangles_[other].v[kPrevious[slot]] != a) ++slot;
    if (in_conflict(other, q)) {
      star_.push_back(other);
      pending_.push_back({other, kPrevious[slot]});
      pending_.push_back({other, kNext[slot]});
    } else {
      border_.push_back({a, tri.v[kPrevious[k]], other, slot});
    }
  }
}

std::uint32_t ScatteredMesh::insert(std::uint32_t p, std::uint32_t hint) {
  const Vec2 q = at_[p];
  const std::uint32_t first = locate(q, hint);
  assert(in_conflict(first, q));
  collect(first, q);
  removed_ = star_.size();
  while (star_.size() < border_.size()) {
    star_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    triangles_.push_back({});
  }
  const std::size_t count = border_.size();
  assert(count == removed_ + 2);
  std::uint32_t real = star_[0];
  for (std::size_t k = 0; k < count; ++k) {
    const BorderEdge& edge = border_[k];
    const std::uint32_t after = star_[k + 1 == count ? 0 : k + 1], before = star_[k == 0 ? count - 1 : k - 1];
    triangles_[star_[k]] = {{p, edge.from, edge.to}, {edge.outside, after, before}};
    triangles_[edge.outside].n[edge.slot] = star_[k];
    if (edge.from != kGhost && edge.to != kGhost) real = star_[k];
  }
  return real;
}

}  // namespace retalho
