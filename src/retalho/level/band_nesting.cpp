#include "retalho/level/band_nesting.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace retalho {
namespace {

constexpr std::size_t kNoRing = static_cast<std::size_t>(-1);

/// Edges of all rings by horizontal slices, to find the one that lies next to the left of a point.
class EdgeSlices {
 public:
  explicit EdgeSlices(const std::vector<std::vector<Vec2>>& rings) : rings_(rings) {
    double high = -1e300;
    std::size_t edges = 0;
    for (const auto& ring : rings) {
      edges += ring.size();
      for (const Vec2 p : ring) {
        low_ = std::min(low_, p.y);
        high = std::max(high, p.y);
      }
    }
    const auto slices = static_cast<std::size_t>(std::sqrt(static_cast<double>(edges))) + 1;
    per_slice_ = high > low_ ? static_cast<double>(slices) / (high - low_) : 0;
    slices_.resize(slices + 1);
    for (std::uint32_t r = 0; r < rings.size(); ++r)
      for (std::uint32_t i = 0; i < rings[r].size(); ++i) {
        const double a = rings[r][i].y, b = rings[r][(i + 1) % rings[r].size()].y;
        for (std::size_t s = slice(std::min(a, b)); s <= slice(std::max(a, b)); ++s) slices_[s].push_back({r, i});
      }
  }

  /// The ring of the next edge to the left of p (or through it), not counting `own`.
  std::size_t left_of(Vec2 p, std::size_t own) const {
    double best = -1e300;
    std::size_t found = kNoRing;
    for (const auto& [r, i] : slices_[slice(p.y)]) {
      if (r == own) continue;
      const Vec2 a = rings_[r][i], b = rings_[r][(i + 1) % rings_[r].size()];
      if ((a.y <= p.y) == (b.y <= p.y)) continue;
      const double x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
      if (x <= p.x && x > best) {
        best = x;
        found = r;
      }
    }
    return found;
  }

 private:
  struct Edge {
    std::uint32_t ring, at;
  };
  std::size_t slice(double y) const { return static_cast<std::size_t>((y - low_) * per_slice_); }

  const std::vector<std::vector<Vec2>>& rings_;
  double low_ = 1e300, per_slice_ = 0;
  std::vector<std::vector<Edge>> slices_;
};

}  // namespace

double doubled_area(const std::vector<Vec2>& ring) {
  double area = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) area += cross(ring[i] - ring[0], ring[(i + 1) % ring.size()] - ring[0]);
  return area;
}

void nest_rings(int band, std::vector<std::vector<Vec2>> rings, std::vector<BandPolygon>& polygons) {
  std::erase_if(rings, [](const auto& ring) { return ring.size() < 3 || doubled_area(ring) == 0; });
  std::vector<std::size_t> polygon_of(rings.size(), kNoRing);
  std::vector<std::size_t> holes;
  std::vector<Vec2> leftmost(rings.size());
  for (std::size_t r = 0; r < rings.size(); ++r) {
    if (doubled_area(rings[r]) > 0) {
      polygon_of[r] = polygons.size();
      polygons.push_back({band, {}, {}});
    } else {
      holes.push_back(r);
      leftmost[r] = *std::min_element(rings[r].begin(), rings[r].end(),
                                      [](Vec2 a, Vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    }
  }
  if (!holes.empty()) {
    const EdgeSlices slices(rings);
    // From the west: what lies to the left of a hole is a region's border, or a hole of the same region seen before.
    std::sort(holes.begin(), holes.end(), [&](std::size_t a, std::size_t b) {
      return leftmost[a].x != leftmost[b].x ? leftmost[a].x < leftmost[b].x : a < b;
    });
    for (const std::size_t h : holes) {
      const std::size_t beside = slices.left_of(leftmost[h], h);
      if (beside != kNoRing) polygon_of[h] = polygon_of[beside];
    }
  }
  for (std::size_t r = 0; r < rings.size(); ++r) {
    if (polygon_of[r] == kNoRing) continue;
    BandPolygon& polygon = polygons[polygon_of[r]];
    if (doubled_area(rings[r]) > 0)
      polygon.outer.points = std::move(rings[r]);
    else
      polygon.holes.push_back({std::move(rings[r])});
  }
}

}  // namespace retalho
