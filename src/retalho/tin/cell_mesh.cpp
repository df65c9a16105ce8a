#include "retalho/tin/cell_mesh.h"

#include <algorithm>

namespace retalho {
namespace {

using greedy::area2;
using greedy::Cell;

/// > 0: counter-clockwise seen from above (rows run south).
std::int64_t turn(Cell a, Cell b, Cell c) {
  return area2(a, c, b);
}
bool inside_circle(Cell a, Cell b, Cell c, Cell p) {  // a, b, c counter-clockwise from above
  return greedy::in_circle(a, c, b, p);
}
std::uint32_t corner_of(const std::array<std::uint32_t, 3>& t, std::uint32_t vertex) {
  return t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
}

}  // namespace

CellMesh::CellMesh(std::vector<Cell> hull) {
  std::reverse(hull.begin(), hull.end());  // counter-clockwise from above
  cells_ = hull;
  triangle_at_.assign(hull.size(), 0);
  std::vector<std::uint32_t> ring(hull.size());
  for (std::uint32_t v = 0; v < ring.size(); ++v) ring[v] = v;
  const std::vector<std::uint32_t> outside(hull.size(), kNone);
  std::vector<std::uint32_t> slots;
  for (std::size_t k = 0; k + 2 < hull.size(); ++k) slots.push_back(add_triangle({0, 0, 0}, {kNone, kNone, kNone}));
  fill_polygon(ring, outside, slots);
  restore();
}

bool CellMesh::on_border(std::uint32_t vertex) const {
  const std::uint32_t first = triangle_at_[vertex];
  std::uint32_t t = first;
  do {
    const std::uint32_t k = corner_of(triangles_[t], vertex);
    t = neighbors_[t][(k + 1) % 3];
  } while (t != kNone && t != first);
  return t == kNone;
}

void CellMesh::star(std::uint32_t vertex, Star& star) const {
  star.triangles.clear();
  star.ring.clear();
  // Clockwise to the outline, if there is one; then counter-clockwise.
  const std::uint32_t begin = triangle_at_[vertex];
  std::uint32_t first = begin;
  star.closed = false;
  while (true) {
    const std::uint32_t next = neighbors_[first][(corner_of(triangles_[first], vertex) + 2) % 3];
    if (next == kNone) break;
    first = next;
    if (first == begin) {
      star.closed = true;
      break;
    }
  }
  std::uint32_t t = first;
  do {
    const std::uint32_t k = corner_of(triangles_[t], vertex);
    star.triangles.push_back(t);
    star.ring.push_back(triangles_[t][(k + 1) % 3]);
    const std::uint32_t next = neighbors_[t][(k + 1) % 3];
    if (next == kNone) star.ring.push_back(triangles_[t][(k + 2) % 3]);
    t = next;
  } while (t != kNone && t != first);
}

std::uint32_t CellMesh::locate(Cell p, std::uint32_t from) const {
  std::uint32_t t = from;
  // The turn of the first edge looked at changes from step to step, so that the walk cannot go round in circles on
  // meshes that are not Delaunay for the moment; the bound is never met on others.
  for (std::size_t step = 0; step <= 4 * triangles_.size() + 16; ++step) {
    const auto& v = triangles_[t];
    bool moved = false;
    for (std::uint32_t i = 0; i < 3 && !moved; ++i) {
      const std::uint32_t k = (i + static_cast<std::uint32_t>(step)) % 3;
      if (turn(cells_[v[(k + 1) % 3]], cells_[v[(k + 2) % 3]], p) >= 0) continue;
      if (neighbors_[t][k] == kNone) return kNone;
      t = neighbors_[t][k];
      moved = true;
    }
    if (!moved) return t;
  }
  return kNone;
}

std::uint32_t CellMesh::insert(Cell p, std::uint32_t from) {
  const std::uint32_t t = locate(p, from);
  if (t == kNone) return kNone;
  const auto v = triangles_[t];
  std::uint32_t on_edge = kNone;
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (cells_[v[k]] == p) return kNone;
    if (turn(cells_[v[(k + 1) % 3]], cells_[v[(k + 2) % 3]], p) == 0) on_edge = k;
  }
  const auto vertex = static_cast<std::uint32_t>(cells_.size());
  cells_.push_back(p);
  triangle_at_.push_back(t);
  if (on_edge == kNone)
    split(t, vertex);
  else
    split_edge(t, on_edge, vertex);
  return vertex;
}

void CellMesh::split(std::uint32_t t, std::uint32_t vertex) {
  const auto v = triangles_[t], n = neighbors_[t];
  const std::uint32_t t1 = add_triangle({vertex, v[1], v[2]}, {n[0], kNone, t});
  const std::uint32_t t2 = add_triangle({vertex, v[2], v[0]}, {n[1], t, t1});
  set_triangle(t, {vertex, v[0], v[1]}, {n[2], t1, t2});
  neighbors_[t1][1] = t2;
  neighbors_[t1][2] = t;
  relink(n[0], t, t1);
  relink(n[1], t, t2);
  std::vector<std::uint32_t> stack{t, t1, t2};
  legalise(stack);
}

void CellMesh::split_edge(std::uint32_t t, std::uint32_t k, std::uint32_t vertex) {
  const auto v = triangles_[t], n = neighbors_[t];
  const std::uint32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3];
  const std::uint32_t other = n[k], across_b = n[(k + 1) % 3], across_c = n[(k + 2) % 3];
  // (a, b, c) becomes (vertex, a, b) and (vertex, c, a).
  const std::uint32_t u = add_triangle({vertex, c, a}, {across_b, t, kNone});
  set_triangle(t, {vertex, a, b}, {across_c, kNone, u});
  relink(across_b, t, u);
  std::vector<std::uint32_t> stack{t, u};
  if (other != kNone) {
    const auto w = triangles_[other], m = neighbors_[other];
    const std::uint32_t e = (corner_of(w, b) + 1) % 3;  // (c -> b side) w = (d, c, b) in some rotation: after b comes d
    const std::uint32_t d = w[e];
    const std::uint32_t d_c = m[corner_of(w, b)], b_d = m[corner_of(w, c)];
    // (d, c, b) becomes (vertex, b, d) and (vertex, d, c).
    const std::uint32_t x = add_triangle({vertex, d, c}, {d_c, u, other});
    set_triangle(other, {vertex, b, d}, {b_d, x, t});
    relink(d_c, other, x);
    neighbors_[t][1] = other;
    neighbors_[u][2] = x;
    stack.push_back(other);
    stack.push_back(x);
  }
  triangle_at_[vertex] = t;
  legalise(stack);
}

/// Around a new vertex that is corner 0 of all triangles of the stack.
void CellMesh::legalise(std::vector<std::uint32_t>& stack) {
  while (!stack.empty()) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    if (!wants_flip(t, 0)) continue;
    const std::uint32_t n = neighbors_[t][0];
    flip(t, 0);
    stack.push_back(t);
    stack.push_back(n);
  }
}

bool CellMesh::wants_flip(std::uint32_t t, std::uint32_t k) const {
  const std::uint32_t n = neighbors_[t][k];
  if (n == kNone) return false;
  const auto &v = triangles_[t], &w = triangles_[n];
  const Cell far = cells_[w[(corner_of(w, v[(k + 1) % 3]) + 1) % 3]];
  const Cell near = cells_[v[k]], left = cells_[v[(k + 1) % 3]], right = cells_[v[(k + 2) % 3]];
  const int side = greedy::circle_side(near, right, left, far);
  if (side != 0) return side > 0;
  // On one circle: the diagonal at the first of the four, whatever the order of the edits. With more than four this
  // makes the fan around the first of them (the pulling triangulation).
  return std::min(near, far) < std::min(left, right);
}

/// t = (a, b, c) with a its corner k, and (d, c, b) across b-c, become t = (a, b, d) and (a, d, c).
void CellMesh::flip(std::uint32_t t, std::uint32_t k) {
  const auto v = triangles_[t], n = neighbors_[t];
  const std::uint32_t a = v[k], b = v[(k + 1) % 3], c = v[(k + 2) % 3], other = n[k];
  const auto w = triangles_[other], m = neighbors_[other];
  const std::uint32_t d = w[(corner_of(w, b) + 1) % 3];
  const std::uint32_t across_b = n[(k + 1) % 3], across_c = n[(k + 2) % 3];
  const std::uint32_t d_c = m[corner_of(w, b)], b_d = m[corner_of(w, c)];
  set_triangle(t, {a, b, d}, {b_d, other, across_c});
  set_triangle(other, {a, d, c}, {d_c, across_b, t});
  relink(b_d, other, t);
  relink(across_b, t, other);
}

bool CellMesh::remove(std::uint32_t vertex) {
  Star s;
  star(vertex, s);
  if (!s.closed && turn(cells_[s.ring.front()], cells_[vertex], cells_[s.ring.back()]) != 0) return false;
  std::vector<std::uint32_t> outside;
  for (const std::uint32_t t : s.triangles) outside.push_back(neighbors_[t][corner_of(triangles_[t], vertex)]);
  if (!s.closed) outside.push_back(kNone);  // the outline closes the ring
  fill_polygon(s.ring, outside, s.triangles);
  restore({s.triangles.begin(), s.triangles.begin() + static_cast<std::ptrdiff_t>(s.ring.size()) - 2});
  // The polygon needs fewer triangles than the star had; the rest goes, the highest number first.
  std::vector<std::uint32_t> spare(s.triangles.begin() + static_cast<std::ptrdiff_t>(s.ring.size()) - 2,
                                   s.triangles.end());
  std::sort(spare.rbegin(), spare.rend());
  for (const std::uint32_t t : spare) drop_triangle(t);
  const auto last = static_cast<std::uint32_t>(cells_.size() - 1);
  if (vertex != last) {
    star(last, s);
    for (const std::uint32_t t : s.triangles) {
      triangles_[t][corner_of(triangles_[t], last)] = vertex;
      changed_[t] = 1;
    }
    cells_[vertex] = cells_[last];
    triangle_at_[vertex] = triangle_at_[last];
  }
  cells_.pop_back();
  triangle_at_.pop_back();
  return true;
}

/// Delaunay triangles of a polygon (counter-clockwise; edge i from ring[i] to ring[i + 1] with outside[i] beyond it),
/// by ears whose circle holds no other vertex of the polygon. Uses the first of the slots.
void CellMesh::fill_polygon(std::vector<std::uint32_t> ring, std::vector<std::uint32_t> outside,
                            const std::vector<std::uint32_t>& slots) {
  std::size_t next = 0;
  const auto attach = [&](std::uint32_t beyond, std::uint32_t t, std::uint32_t from) {
    // The triangle beyond an edge has it the other way round: opposite the corner after `from`.
    if (beyond != kNone) neighbors_[beyond][(corner_of(triangles_[beyond], from) + 1) % 3] = t;
  };
  while (ring.size() >= 3) {
    const std::size_t n = ring.size();
    std::size_t best = n, second = n;
    for (std::size_t i = 0; i < n && best == n; ++i) {
      const Cell a = cells_[ring[i]], b = cells_[ring[(i + 1) % n]], c = cells_[ring[(i + 2) % n]];
      if (turn(a, b, c) <= 0) continue;
      bool empty = true, ear = true;
      for (std::size_t j = 3; j < n && ear; ++j) {
        const Cell p = cells_[ring[(i + j) % n]];
        if (inside_circle(a, b, c, p)) empty = false;
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) ear = false;
      }
      if (!ear) continue;
      if (second == n) second = i;
      if (empty) best = i;
    }
    const std::size_t i = best != n ? best : second, j = (i + 1) % n, k = (i + 2) % n;
    const std::uint32_t t = slots[next++];
    set_triangle(t, {ring[i], ring[j], ring[k]}, {outside[j], n == 3 ? outside[k] : kNone, outside[i]});
    attach(outside[i], t, ring[i]);
    attach(outside[j], t, ring[j]);
    if (n == 3) {
      attach(outside[k], t, ring[k]);
      return;
    }
    outside[i] = t;
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(j));
    outside.erase(outside.begin() + static_cast<std::ptrdiff_t>(j));
  }
}

bool CellMesh::can_move(std::uint32_t vertex, Cell to) const {
  Star s;
  star(vertex, s);
  if (!s.closed) {
    const Cell first = cells_[s.ring.front()], last = cells_[s.ring.back()];
    if (turn(first, cells_[vertex], last) != 0 || turn(first, to, last) != 0) return false;
  }
  for (std::size_t k = 0; k < s.triangles.size(); ++k)
    if (turn(to, cells_[s.ring[k]], cells_[s.ring[(k + 1) % s.ring.size()]]) <= 0) return false;
  return true;
}

void CellMesh::displace(std::uint32_t vertex, Cell to) {
  cells_[vertex] = to;
  Star s;
  star(vertex, s);
  for (const std::uint32_t t : s.triangles) changed_[t] = 1;
}

void CellMesh::restore() {
  std::vector<std::uint32_t> stack;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) stack.push_back(t);
  restore(std::move(stack));
}

void CellMesh::restore(std::vector<std::uint32_t> stack) {
  while (!stack.empty()) {
    const std::uint32_t t = stack.back();
    stack.pop_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!wants_flip(t, k)) continue;
      stack.push_back(neighbors_[t][k]);
      flip(t, k);
      stack.push_back(t);
      break;
    }
  }
}

std::vector<std::uint32_t> CellMesh::changed() const {
  std::vector<std::uint32_t> list;
  for (std::uint32_t t = 0; t < changed_.size(); ++t)
    if (changed_[t] != 0) list.push_back(t);
  return list;
}

void CellMesh::clear_changed() {
  std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
}

std::uint32_t CellMesh::add_triangle(std::array<std::uint32_t, 3> corners, std::array<std::uint32_t, 3> links) {
  const auto t = static_cast<std::uint32_t>(triangles_.size());
  triangles_.emplace_back();
  neighbors_.emplace_back();
  changed_.push_back(1);
  set_triangle(t, corners, links);
  return t;
}

void CellMesh::set_triangle(std::uint32_t t, std::array<std::uint32_t, 3> corners, std::array<std::uint32_t, 3> links) {
  triangles_[t] = corners;
  neighbors_[t] = links;
  changed_[t] = 1;
  for (const std::uint32_t v : corners) triangle_at_[v] = t;
}

void CellMesh::relink(std::uint32_t t, std::uint32_t from, std::uint32_t to) {
  if (t == kNone) return;
  for (std::uint32_t& n : neighbors_[t])
    if (n == from) {
      n = to;
      return;
    }
}

void CellMesh::drop_triangle(std::uint32_t t) {
  const auto last = static_cast<std::uint32_t>(triangles_.size() - 1);
  if (t != last) {
    for (const std::uint32_t n : neighbors_[last]) relink(n, last, t);
    set_triangle(t, triangles_[last], neighbors_[last]);
  }
  triangles_.pop_back();
  neighbors_.pop_back();
  changed_.pop_back();
}

}  // namespace retalho
