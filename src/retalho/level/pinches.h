// Internal to level/: places where the border of the valid area touches itself. A ring that runs through one twice is
// two rings that touch there, as simple-feature geometry wants it.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "retalho/level/bands.h"

namespace retalho {

class Pinches {
 public:
  Pinches() = default;
  /// The places where more than one piece of the border starts, or a line ends at such a start.
  Pinches(const std::vector<DirectedBorder>& border, const ContourSet& set);

  /// Replaces rings that run through a place more than once by their loops. Cost: O(points), nothing without places.
  void part(std::vector<std::vector<Vec2>>& rings) const;

 private:
  bool holds(Vec2 p) const { return places_.contains({p.x, p.y}); }

  std::set<std::pair<double, double>> places_;
};

}  // namespace retalho
