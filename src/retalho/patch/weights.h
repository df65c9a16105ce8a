// Floater's weights of one vertex. Internal to the room patch.
#pragma once

#include <span>
#include <vector>

#include "retalho/core/vec.h"
#include "retalho/patch/parameterize.h"

namespace retalho {

/// Positive weights of the neighbours of `centre`, which stand in cyclic order, with sum 1.
class NeighborWeights {
 public:
  void compute(Vec3 centre, std::span<const Vec3> neighbors, Weights kind, std::vector<double>& out);

 private:
  void mean_value(std::vector<double>& out) const;
  void shape_preserving(std::vector<double>& out);

  std::vector<double> length_, angle_;  ///< to neighbour k; between neighbours k and k + 1
  std::vector<double> theta_;
  std::vector<Vec2> flat_;
};

}  // namespace retalho
