// Internal to level/: what the kinds of patches share.
#pragma once

#include <algorithm>
#include <array>

#include "retalho/core/vec.h"

namespace retalho {

/// Ranges of the second derivatives over a box.
struct SecondRanges {
  std::array<double, 2> uu{}, uv{}, vv{};

  /// How far the polynomial can be from its chord: max |f - chord| on a segment with this parameter vector.
  [[gnu::always_inline]] double chord_bound(Vec2 d) const {
    const double a = d.x * d.x, b = d.y * d.y, m = 2 * d.x * d.y;
    const double low = a * uu[0] + b * vv[0] + (m > 0 ? m * uv[0] : m * uv[1]);
    const double high = a * uu[1] + b * vv[1] + (m > 0 ? m * uv[1] : m * uv[0]);
    return 0.125 * (1 + 1e-12) * std::max(-low, high);
  }
};

/// Where a side of a child comes from.
struct ChildSide {
  bool inner;     ///< a new edge inside the parent, else a half of one of the parent's sides
  int index;      ///< of the new edge or of the side
  int half;       ///< of the side, in the side's own direction
  bool reversed;  ///< runs against the new edge
};

}  // namespace retalho
