#include "retalho/terrain/locate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "retalho/core/parallel.h"
#include "retalho/terrain/side.h"

namespace retalho {
namespace {

bool holds(const Corners& c, Vec2 p) {
  return side_of(c[0], c[1], p) >= 0 && side_of(c[1], c[2], p) >= 0 && side_of(c[2], c[0], p) >= 0;
}

/// The corner of `triangle` at vertex `v`.
std::size_t corner_of(const Tin& tin, std::uint32_t triangle, std::uint32_t v) {
  const auto& t = tin.triangles[triangle];
  return t[0] == v ? 0 : t[1] == v ? 1 : 2;
}

}  // namespace

PointLocator::PointLocator(const Tin& tin, const Context& context) : tin_(tin) {
  const double inf = std::numeric_limits<double>::infinity();
  low_ = {inf, inf};
  high_ = {-inf, -inf};
  for (const auto& t : tin.triangles)
    for (const std::uint32_t v : t) {
      const Vec2 p = tin.points[v];
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
      high_ = {std::max(high_.x, p.x), std::max(high_.y, p.y)};
    }
  convex_ = outline_is_convex();
  if (tin.triangles.empty()) return;
  facets_.resize(tin.triangles.size());
  parallel_chunks(facets_.size(), 16384, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto& v = tin.triangles[t];
      facets_[t] = {{tin.points[v[0]], tin.points[v[1]], tin.points[v[2]]}, tin.neighbors[t]};
    }
  });
  const double width = high_.x - low_.x, height = high_.y - low_.y;
  // Four cells a triangle: the hint is mostly the triangle itself or its neighbour.
  const double side = std::sqrt(width * height / (4 * static_cast<double>(tin.triangles.size())));
  const auto cells = [&](double length) { return static_cast<int>(std::clamp(length / side, 1.0, 32768.0)); };
  if (side > 0) {
    columns_ = cells(width);
    rows_ = cells(height);
    per_x_ = columns_ / width;
    per_y_ = rows_ / height;
  }
  hints_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  parallel_chunks(static_cast<std::size_t>(rows_), 16, context, [&](std::size_t begin, std::size_t end) {
    std::uint32_t at = 0;
    for (std::size_t r = begin; r < end; ++r)
      for (int k = 0; k < columns_; ++k) {
        const int c = (r - begin) % 2 == 0 ? k : columns_ - 1 - k;  // to and fro: each walk starts near its goal
        const Vec2 centre{low_.x + (c + 0.5) * width / columns_,
                          low_.y + (static_cast<double>(r) + 0.5) * height / rows_};
        at = walk(centre, at).triangle;
        hints_[r * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] = at;
      }
  });
}

std::uint32_t PointLocator::quick_walk(Vec2 p, std::uint32_t& from) const {
  for (int step = 0; step < 64; ++step) {
    const Facet& f = facets_[from];
    // The three sides at once, each with the bound of its rounding (side.h): one branch in the usual
    // case.
    std::array<double, 3> det, bound;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 a = f.corners[(k + 1) % 3] - p, b = f.corners[(k + 2) % 3] - p;
      const double left = a.x * b.y, right = a.y * b.x;
      det[k] = left - right;
      bound[k] = kSideBound * (std::abs(left) + std::abs(right));
    }
    if (std::min(det[0] - bound[0], std::min(det[1] - bound[1], det[2] - bound[2])) > 0) return from;
    std::size_t k = det[1] < det[0] ? 1 : 0;
    k = det[2] < det[k] ? 2 : k;
    if (!(det[k] < -bound[k]) || f.neighbors[k] == kNone) return kNone;
    from = f.neighbors[k];
  }
  return kNone;
}

PointLocator::Step PointLocator::walk(Vec2 p, std::uint32_t from) const {
  std::uint32_t t = from, previous = kNone;
  // On a Delaunay triangulation the walk cannot turn in a circle; on another the changing first edge breaks circles,
  // and the limit sends hopeless cases to the full search.
  const std::size_t limit = 64 + 4 * tin_.triangles.size();
  for (std::size_t step = 0; step < limit; ++step) {
    const Corners& c = facets_[t].corners;
    const auto& n = facets_[t].neighbors;
    const std::size_t first = step < 4096 ? 0 : (step * 2654435761U >> 7) % 3;
    bool moved = false, border = false, on_edge = false;
    for (std::size_t m = 0; m < 3 && !moved; ++m) {
      const std::size_t k = (first + m) % 3;
      if (n[k] != kNone && n[k] == previous) continue;  // it came through this edge: p is on this side
      const int turn = side_of(c[(k + 1) % 3], c[(k + 2) % 3], p);
      on_edge |= turn == 0;
      if (turn >= 0) continue;
      if (n[k] == kNone) {
        border = true;
        continue;  // another edge may lead on
      }
      previous = t;
      t = n[k];
      moved = true;
    }
    if (!moved) return {t, !border, on_edge};
  }
  return {t, false, false};
}

std::uint32_t PointLocator::owner(Vec2 p, std::uint32_t triangle) const {
  std::uint32_t best = triangle;
  const auto& v = tin_.triangles[triangle];
  for (std::size_t k = 0; k < 3; ++k) {
    if (tin_.points[v[k]] == p) {  // at a vertex: all triangles around it
      for (const std::size_t turn : {std::size_t{1}, std::size_t{2}}) {
        std::uint32_t t = triangle;
        do {
          t = tin_.neighbors[t][(corner_of(tin_, t, v[k]) + turn) % 3];
          if (t != kNone) best = std::max(best, t);
        } while (t != kNone && t != triangle);
        if (t == triangle) return best;
      }
      return best;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t across = tin_.neighbors[triangle][k];
    if (across != kNone && across > best && side_of(tin_.points[v[(k + 1) % 3]], tin_.points[v[(k + 2) % 3]], p) == 0)
      best = across;
  }
  return best;
}

std::uint32_t PointLocator::locate(Vec2 p, std::uint32_t hint) const {
  const std::uint32_t near = this->hint(p);
  if (near == kNone) return kNone;
  if (hint >= tin_.triangles.size()) hint = near;
  if (quick_walk(p, hint) != kNone) return hint;
  const Step end = walk(p, hint);
  if (end.inside) return end.on_edge ? owner(p, end.triangle) : end.triangle;
  return convex_ ? kNone : search_all(p);
}

std::uint32_t PointLocator::search_all(Vec2 p) const {
  for (auto t = static_cast<std::uint32_t>(tin_.triangles.size()); t-- > 0;)
    if (holds(facets_[t].corners, p)) return t;
  return kNone;
}

bool PointLocator::outline_is_convex() const {
  // One closed border that turns left, or goes straight on, at each of its vertices.
  std::vector<std::uint32_t> next(tin_.points.size(), kNone);
  std::size_t sides = 0;
  std::uint32_t start = kNone;
  for (std::uint32_t t = 0; t < tin_.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (tin_.neighbors[t][k] != kNone) continue;
      const std::uint32_t from = tin_.triangles[t][(k + 1) % 3];
      if (next[from] != kNone) return false;
      next[from] = tin_.triangles[t][(k + 2) % 3];
      start = from;
      ++sides;
    }
  if (start == kNone) return false;
  std::size_t seen = 0;
  std::uint32_t a = start;
  do {
    const std::uint32_t b = next[a];
    if (b == kNone) return false;
    const std::uint32_t c = next[b];
    if (c == kNone || side_of(tin_.points[a], tin_.points[b], tin_.points[c]) < 0) return false;
    a = b;
    ++seen;
  } while (a != start && seen <= sides);
  return seen == sides;
}

}  // namespace retalho
