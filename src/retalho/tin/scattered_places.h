// Scattered points made ready: one place for each (x, y), along a Hilbert curve. Internal to tin/.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retalho/core/vec.h"
#include "retalho/tin/scattered.h"

namespace retalho {

struct Places {
  std::vector<Vec2> at;         // along the Hilbert curve
  std::vector<double> heights;  // mean of the points at each place
};

/// Throws BadInput as triangulate_points does, but for points on one line.
Places make_places(std::span<const Vec3> points, ScatteredNotes& notes);

/// The order in which places are inserted: rounds of growing size, each along the curve.
std::vector<std::uint32_t> insertion_order(std::size_t places);

/// Corners of the convex hull, counter-clockwise, without places on its sides. Throws BadInput when there is no area.
std::vector<std::uint32_t> convex_hull(const std::vector<Vec2>& at);

}  // namespace retalho
