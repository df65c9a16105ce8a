// Internal to level/: which hole lies in which region.
#pragma once

#include <memory>
#include <vector>

#include "retalho/level/contours.h"

namespace retalho {

/// Twice the signed area.
double doubled_area(const std::vector<Vec2>& ring);

/// Rings of one band, outer ones counter-clockwise, to polygons: each hole goes to the smallest region around it.
void nest_rings(int band, std::vector<std::vector<Vec2>> rings, std::vector<BandPolygon>& polygons);

class EdgeSlices;

/// Which band a place lies in. Cost: O(edges) to make; a search looks at the edges of one horizontal slice.
class BandLocator {
 public:
  explicit BandLocator(const BandSet& bands);
  ~BandLocator();
  BandLocator(const BandLocator&) = delete;
  BandLocator& operator=(const BandLocator&) = delete;
  /// -1: outside of all.
  int band_at(Vec2 p) const;

 private:
  std::vector<std::vector<Vec2>> rings_;
  std::vector<int> band_;
  std::unique_ptr<EdgeSlices> slices_;
};

}  // namespace retalho
