#include "retalho/level/band_nesting.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "retalho/level/edge_slices.h"

namespace retalho {

double doubled_area(const std::vector<Vec2>& ring) {
  double area = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) area += cross(ring[i] - ring[0], ring[(i + 1) % ring.size()] - ring[0]);
  return area;
}

namespace {

/// A place on a ring, near its leftmost point but not on it: there other rings may touch it. Of the two edges that
/// meet at the point the outer one is taken, so that none of the ring's own lies to the left.
Vec2 beside_leftmost(const std::vector<Vec2>& ring) {
  const auto at = static_cast<std::size_t>(
      std::min_element(ring.begin(), ring.end(), [](Vec2 a, Vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }) -
      ring.begin());
  const Vec2 p = ring[at], a = ring[(at + ring.size() - 1) % ring.size()] - p, b = ring[(at + 1) % ring.size()] - p;
  // Steepness decides: dx / |dy| is smaller for the outer edge; the horizontal one is never taken.
  const Vec2 edge = a.x * std::abs(b.y) < b.x * std::abs(a.y) ? a : b;
  return p + 0x1p-10 * edge;
}

/// Is the area not to be told from the rounding of the coordinates? Such a ring may be left at a cell's corner.
bool has_no_area(const std::vector<Vec2>& ring) {
  double length = 0, size = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    length += norm(ring[i] - ring[i > 0 ? i - 1 : ring.size() - 1]);
    size = std::max({size, std::abs(ring[i].x), std::abs(ring[i].y)});
  }
  return ring.size() < 3 || std::abs(doubled_area(ring)) <= 0x1p-50 * size * length;
}

}  // namespace

void nest_rings(int band, std::vector<std::vector<Vec2>> rings, std::vector<BandPolygon>& polygons) {
  // Where the border runs through a cell's corner it may stand still there.
  for (auto& ring : rings) {
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
  }
  std::erase_if(rings, has_no_area);
  std::vector<std::size_t> polygon_of(rings.size(), kNoRing), beside(rings.size(), kNoRing);
  std::vector<std::size_t> holes;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    if (doubled_area(rings[r]) > 0) {
      polygon_of[r] = polygons.size();
      polygons.push_back({band, {}, {}});
    } else {
      holes.push_back(r);
    }
  }
  if (!holes.empty()) {
    const EdgeSlices slices(rings);
    // What lies to the left of a hole is a region's border, or another hole of the same region, farther to the west.
    for (const std::size_t h : holes) beside[h] = slices.left_of(beside_leftmost(rings[h]), h);
    for (const std::size_t h : holes) {
      std::size_t r = h;
      for (std::size_t steps = 0; r != kNoRing && polygon_of[r] == kNoRing && steps <= holes.size(); ++steps)
        r = beside[r];
      if (r != kNoRing) polygon_of[h] = polygon_of[r];
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

BandLocator::BandLocator(const BandSet& bands) {
  for (const BandPolygon& polygon : bands.polygons) {
    rings_.push_back(polygon.outer.points);
    for (const BandRing& hole : polygon.holes) rings_.push_back(hole.points);
    band_.resize(rings_.size(), polygon.band);
  }
  slices_ = std::make_unique<EdgeSlices>(rings_);
}
BandLocator::~BandLocator() = default;

int BandLocator::band_at(Vec2 p) const {
  const std::size_t ring = slices_->region_of(p);
  return ring == kNoRing ? -1 : band_[ring];
}

}  // namespace retalho
