#include "retalho/tin/scattered_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "retalho/core/error.h"
#include "retalho/tin/predicates.h"

namespace retalho {
namespace {

/// Position of a cell of a 2^32 x 2^32 square along its Hilbert curve.
std::uint64_t hilbert(std::uint32_t x, std::uint32_t y) {
  std::uint64_t key = 0;
  for (std::uint32_t s = 1U << 31; s > 0; s >>= 1) {
    const std::uint32_t rx = (x & s) ? 1 : 0, ry = (y & s) ? 1 : 0;
    key = (key << 2) | ((3 * rx) ^ ry);
    if (ry == 0) {
      if (rx == 1) x = ~x, y = ~y;
      std::swap(x, y);
    }
  }
  return key;
}

struct Keyed {
  std::uint64_t key;
  std::uint32_t point;
};

struct Box {
  Vec2 low, high;
};

Box check_and_bound(std::span<const Vec3> points) {
  constexpr double kFar = 1e100;
  if (points.size() < 3) throw BadInput(fmt::format("{} points: a triangulation needs three", points.size()));
  if (points.size() >= kNone / 2)
    throw BadInput(fmt::format("{} points: at most {} can be triangulated", points.size(), kNone / 2 - 1));
  Box box{{points[0].x, points[0].y}, {points[0].x, points[0].y}};
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3& p = points[k];
    if (!(std::abs(p.x) <= kFar && std::abs(p.y) <= kFar && std::abs(p.z) <= kFar))
      throw BadInput(
          fmt::format("point {} has the coordinates ({}, {}, {}): leave out what is not a place", k, p.x, p.y, p.z), {},
          fmt::format("point {}", k));
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
  }
  return box;
}

std::vector<Keyed> along_the_curve(std::span<const Vec3> points, const Box& box) {
  // One scale for both axes: square cells, so that the curve's neighbours are neighbours.
  const double extent = std::max(box.high.x - box.low.x, box.high.y - box.low.y);
  const double scale = extent > 0 ? 4294967295.0 / extent : 0;
  std::vector<Keyed> order(points.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    const double x = std::min((points[k].x - box.low.x) * scale, 4294967295.0);
    const double y = std::min((points[k].y - box.low.y) * scale, 4294967295.0);
    order[k] = {hilbert(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), k};
  }
  std::sort(order.begin(), order.end(), [&](const Keyed& a, const Keyed& b) {
    if (a.key != b.key) return a.key < b.key;
    const Vec3 &p = points[a.point], &q = points[b.point];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    return p.z < q.z;
  });
  return order;
}

/// Bits that look random and are always the same (the finalizer of splitmix64).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

}  // namespace

Places make_places(std::span<const Vec3> points, ScatteredNotes& notes) {
  const std::vector<Keyed> order = along_the_curve(points, check_and_bound(points));
  Places places;
  places.at.reserve(points.size());
  places.heights.reserve(points.size());
  notes = {};
  notes.points = points.size();
  for (std::size_t k = 0; k < order.size();) {
    const Vec3& first = points[order[k].point];
    std::size_t end = k;
    double sum = 0;  // lowest first, so that the mean does not depend on the input's order
    for (; end < order.size() && points[order[end].point].x == first.x && points[order[end].point].y == first.y; ++end)
      sum += points[order[end].point].z;
    const auto count = static_cast<double>(end - k);
    notes.largest_spread = std::max(notes.largest_spread, points[order[end - 1].point].z - first.z);
    places.at.push_back({first.x, first.y});
    places.heights.push_back(end - k == 1 ? first.z : sum / count);
    k = end;
  }
  notes.places = places.at.size();
  notes.repeated = notes.points - notes.places;
  return places;
}

std::vector<std::uint32_t> insertion_order(std::size_t places) {
  // Each round holds about a quarter of the places of the next one.
  const auto last = static_cast<unsigned>(std::bit_width(places) / 2);
  const auto round_of = [last](std::size_t k) {
    return last - std::min(last, static_cast<unsigned>(std::countr_zero(mix(k)) / 2));
  };
  std::vector<std::size_t> start(last + 2);
  for (std::size_t k = 0; k < places; ++k) ++start[round_of(k) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<std::uint32_t> order(places);
  for (std::size_t k = 0; k < places; ++k) order[start[round_of(k)]++] = static_cast<std::uint32_t>(k);
  return order;
}

std::vector<std::uint32_t> convex_hull(const std::vector<Vec2>& at) {
  std::vector<std::uint32_t> sorted(at.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    return at[a].x != at[b].x ? at[a].x < at[b].x : at[a].y < at[b].y;
  });
  std::vector<std::uint32_t> hull;
  const auto run = [&](auto begin, auto end) {  // one chain of Andrew's algorithm
    const std::size_t base = hull.size();
    for (auto it = begin; it != end; ++it) {
      while (hull.size() >= base + 2 && orientation(at[hull[hull.size() - 2]], at[hull.back()], at[*it]) <= 0)
        hull.pop_back();
      hull.push_back(*it);
    }
    hull.pop_back();  // the first of the other chain
  };
  run(sorted.begin(), sorted.end());
  run(sorted.rbegin(), sorted.rend());
  if (hull.size() < 3)
    throw BadInput(fmt::format("all {} places lie on one line: there is no area to triangulate", at.size()));
  return hull;
}

}  // namespace retalho
