#include "retalho/terrain/height_range.h"

#include <algorithm>

namespace retalho {

HeightRange height_range(const Terrain& terrain, Vec2 origin) {
  const Tin& tin = terrain.tin;
  HeightRange range;
  bool any = false;
  for (std::size_t v = 0; v < tin.heights.size(); ++v) {
    if (!terrain.grid.has_data(tin.points[v] - origin)) continue;
    const double z = tin.heights[v];
    range = any ? HeightRange{std::min(range.low, z), std::max(range.high, z)} : HeightRange{z, z};
    any = true;
  }
  if (any || tin.heights.empty()) return range;
  const auto [low, high] = std::minmax_element(tin.heights.begin(), tin.heights.end());
  return {*low, *high};
}

}  // namespace retalho
