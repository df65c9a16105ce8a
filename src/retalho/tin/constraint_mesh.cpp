#include "retalho/tin/constraint_mesh.h"

#include <fmt/format.h>

#include <deque>

#include "retalho/core/error.h"
#include "retalho/tin/predicates.h"

namespace retalho {
namespace {

constexpr std::array<std::uint32_t, 3> kNext{1, 2, 0}, kPrevious{2, 0, 1};

bool ahead(Vec2 from, Vec2 to, Vec2 p) {
  return dot(to - from, p - from) > 0;
}

}  // namespace

ConstraintMesh::ConstraintMesh(const Tin& tin) : at_(tin.points), triangle_at_(tin.points.size(), kNone) {
  triangles_.reserve(tin.triangles.size());
  for (std::uint32_t t = 0; t < tin.triangles.size(); ++t) {
    triangles_.push_back({tin.triangles[t], tin.neighbors[t], {false, false, false}});
    for (const std::uint32_t v : tin.triangles[t]) triangle_at_[v] = t;
  }
}

std::uint32_t ConstraintMesh::corner_of(std::uint32_t triangle, std::uint32_t vertex) const {
  const auto& v = triangles_[triangle].v;
  return v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
}

template <class Visit>
void ConstraintMesh::around(std::uint32_t vertex, const Visit& visit) const {
  const std::uint32_t first = triangle_at_[vertex];
  std::uint32_t t = first;
  do {
    const std::uint32_t corner = corner_of(t, vertex);
    if (visit(t, corner)) return;
    t = triangles_[t].n[kNext[corner]];
  } while (t != kNone && t != first);
  if (t == first) return;
  // The border was met: the rest lies the other way round.
  t = triangles_[first].n[kPrevious[corner_of(first, vertex)]];
  while (t != kNone) {
    const std::uint32_t corner = corner_of(t, vertex);
    if (visit(t, corner)) return;
    t = triangles_[t].n[kPrevious[corner]];
  }
}

ConstraintMesh::Side ConstraintMesh::find(Ends edge) const {
  Side side;
  around(edge[0], [&](std::uint32_t t, std::uint32_t corner) {
    const auto& v = triangles_[t].v;
    if (v[kNext[corner]] == edge[1]) side = {t, kPrevious[corner]};
    if (v[kPrevious[corner]] == edge[1]) side = {t, kNext[corner]};
    return side.triangle != kNone;
  });
  return side;
}

ConstraintMesh::Side ConstraintMesh::other(Side side) const {
  const Triangle& triangle = triangles_[side.triangle];
  const std::uint32_t across = triangle.n[side.slot];
  if (across == kNone) return {};
  return {across, kPrevious[corner_of(across, triangle.v[kPrevious[side.slot]])]};
}

/// Is the quadrilateral around the edge strictly convex?
bool ConstraintMesh::flips(Side side) const {
  const Side back = other(side);
  const Triangle& t = triangles_[side.triangle];
  const Vec2 x = at_[t.v[side.slot]], y = at_[triangles_[back.triangle].v[back.slot]];
  return orientation(x, at_[t.v[kNext[side.slot]]], y) > 0 && orientation(x, y, at_[t.v[kPrevious[side.slot]]]) > 0;
}

/// Turns the edge into the other diagonal; returns that one's ends.
ConstraintMesh::Ends ConstraintMesh::flip(Side side) {
  const Side back = other(side);
  const std::uint32_t t = side.triangle, o = back.triangle;
  const std::uint32_t i = side.slot, j = back.slot;
  const Triangle one = triangles_[t], two = triangles_[o];
  const std::uint32_t x = one.v[i], l = one.v[kNext[i]], r = one.v[kPrevious[i]], y = two.v[j];
  // two is (y, r, l): its edge opposite r is l-y, opposite l is y-r. one is (x, l, r).
  const auto link = [&](std::uint32_t neighbor, std::uint32_t from, std::uint32_t to) {
    if (neighbor == kNone) return;
    for (std::uint32_t& n : triangles_[neighbor].n)
      if (n == from) n = to;
  };
  triangles_[t] = {
      {x, l, y}, {two.n[kNext[j]], o, one.n[kPrevious[i]]}, {two.fixed[kNext[j]], false, one.fixed[kPrevious[i]]}};
  triangles_[o] = {
      {x, y, r}, {two.n[kPrevious[j]], one.n[kNext[i]], t}, {two.fixed[kPrevious[j]], one.fixed[kNext[i]], false}};
  link(two.n[kNext[j]], o, t);
  link(one.n[kNext[i]], t, o);
  triangle_at_[x] = triangle_at_[l] = triangle_at_[y] = t;
  triangle_at_[r] = o;
  return {x, y};
}

void ConstraintMesh::fix(Side side) {
  const Side back = other(side);
  triangles_[side.triangle].fixed[side.slot] = true;
  if (back.triangle != kNone) triangles_[back.triangle].fixed[back.slot] = true;
}

std::uint32_t ConstraintMesh::reach(std::uint32_t from, std::uint32_t to, std::vector<Ends>& crossed) const {
  const Vec2 a = at_[from], b = at_[to];
  std::uint32_t found = kNone;
  Side at;
  around(from, [&](std::uint32_t t, std::uint32_t corner) {
    const std::uint32_t p = triangles_[t].v[kNext[corner]], q = triangles_[t].v[kPrevious[corner]];
    const int side_p = orientation(a, b, at_[p]), side_q = orientation(a, b, at_[q]);
    if (p == to || q == to)
      found = to;
    else if (side_p == 0 && ahead(a, b, at_[p]))
      found = p;
    else if (side_q == 0 && ahead(a, b, at_[q]))
      found = q;
    else if (side_p < 0 && side_q > 0)
      at = {t, corner};
    return found != kNone || at.triangle != kNone;
  });
  while (found == kNone) {
    const Triangle& triangle = triangles_[at.triangle];
    const std::uint32_t r = triangle.v[kNext[at.slot]], l = triangle.v[kPrevious[at.slot]];
    if (triangle.fixed[at.slot])
      throw BadInput(fmt::format("two breaklines cross near {}, {}: their crossing has no vertex", at_[r].x, at_[r].y));
    crossed.push_back({l, r});
    const Side back = other(at);
    const std::uint32_t apex = triangles_[back.triangle].v[back.slot];
    const int side = orientation(a, b, at_[apex]);
    if (apex == to || side == 0) {
      found = apex;
    } else {
      // Out through the edge that keeps one end on each side: opposite r's corner when the apex takes r's place.
      at = {back.triangle, corner_of(back.triangle, side < 0 ? r : l)};
    }
  }
  return found;
}

void ConstraintMesh::clear(std::uint32_t from, std::uint32_t to, std::vector<Ends>& crossed) {
  std::deque<Ends> pending(crossed.begin(), crossed.end());
  crossed.clear();  // from here on: the edges that were made
  while (!pending.empty()) {
    const Ends edge = pending.front();
    pending.pop_front();
    const Side side = find(edge);
    if (!flips(side)) {
      pending.push_back(edge);
      continue;
    }
    const Ends made = flip(side);
    const bool touches = made[0] == from || made[0] == to || made[1] == from || made[1] == to;
    const bool crosses =
        !touches && orientation(at_[from], at_[to], at_[made[0]]) * orientation(at_[from], at_[to], at_[made[1]]) < 0;
    (crosses ? pending.push_back(made) : crossed.push_back(made));
  }
}

/// Flips edges that are not locally Delaunay, from the given ones on.
void ConstraintMesh::legalize(std::vector<Ends>& suspects) {
  while (!suspects.empty()) {
    const Ends edge = suspects.back();
    suspects.pop_back();
    const Side side = find(edge);
    if (side.triangle == kNone || triangles_[side.triangle].fixed[side.slot]) continue;
    const Side back = other(side);
    if (back.triangle == kNone) continue;
    const auto& v = triangles_[side.triangle].v;
    const std::uint32_t y = triangles_[back.triangle].v[back.slot];
    if (in_circle(at_[v[0]], at_[v[1]], at_[v[2]], at_[y]) <= 0) continue;
    const std::uint32_t x = v[side.slot], l = v[kNext[side.slot]], r = v[kPrevious[side.slot]];
    flip(side);
    for (const Ends& e : {Ends{x, l}, Ends{l, y}, Ends{y, r}, Ends{r, x}}) suspects.push_back(e);
  }
}

void ConstraintMesh::insert(std::uint32_t a, std::uint32_t b) {
  std::vector<Ends> edges;
  while (a != b) {
    edges.clear();
    const std::uint32_t stop = reach(a, b, edges);
    clear(a, stop, edges);
    fix(find({a, stop}));
    legalize(edges);
    a = stop;
  }
}

}  // namespace retalho
