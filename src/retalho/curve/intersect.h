// Where curves meet: two curves, or one with itself (docs/curves.md, "Crossings"). Halves whose control hulls are apart
// are dropped, which is a proof that they do not meet; what remains is polished by Newton's method.
#pragma once

#include <vector>

#include "retalho/curve/curve.h"

namespace retalho {

struct Crossing {
  double first = 0, second = 0;  ///< parameters on the two curves (on the one curve: first < second)
  Vec3 point;                    ///< on the first
  double distance = 0;           ///< between the two points: rounding, or up to the tolerance where curves only touch
  bool overlap = false;          ///< a stretch in common starts or ends here
};

struct CrossingOptions {
  double tolerance = 1e-9;  ///< curves this near to each other meet; relative to the size of both
};

/// All points in common, ascending by `first`. A common stretch gives its two ends, marked `overlap`.
std::vector<Crossing> intersections(const Curve& a, const Curve& b, const CrossingOptions& options = {});

/// All points that the curve passes at two parameters, ascending; the joins of neighbours do not count, nor does the
/// closing point of a closed curve.
std::vector<Crossing> self_intersections(const Curve& curve, const CrossingOptions& options = {});

}  // namespace retalho
