// Internal to level/: the affine map from a patch's parameters to local coordinates, and how far it stretches.
#pragma once

#include <cmath>

#include "retalho/core/vec.h"

namespace retalho {

struct Frame {
  Vec2 origin, e1, e2;  ///< place(u, v) = origin + u e1 + v e2

  Vec2 place(Vec2 uv) const { return origin + uv.x * e1 + uv.y * e2; }
  Vec2 parameters(Vec2 p) const {
    const Vec2 d = p - origin;
    const double det = cross(e1, e2);
    return {cross(d, e2) / det, cross(e1, d) / det};
  }
  /// The local gradient with these parameter derivatives.
  Vec2 gradient(Vec2 derivatives) const {
    const double det = cross(e1, e2);
    return {(derivatives.x * e2.y - derivatives.y * e1.y) / det, (derivatives.y * e1.x - derivatives.x * e2.x) / det};
  }
  /// The parameter direction whose image is the unit vector along the gradient with these parameter derivatives; (0, 0)
  /// for no gradient.
  [[gnu::always_inline]] Vec2 uphill(Vec2 derivatives) const {
    const Vec2 g = gradient(derivatives);
    const double length = norm(g);
    if (!(length > 0) || !std::isfinite(length)) return {};
    return direction(g / length);
  }
  /// The parameter direction of a local vector.
  Vec2 direction(Vec2 local) const {
    const double det = cross(e1, e2);
    return {cross(local, e2) / det, cross(e1, local) / det};
  }
};

}  // namespace retalho
