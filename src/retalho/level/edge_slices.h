// Internal to level/: which ring lies beside a point.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "retalho/core/vec.h"

namespace retalho {

inline constexpr std::size_t kNoRing = static_cast<std::size_t>(-1);

/// Edges of all rings by horizontal slices, to find the one that lies next to the left of a point.
class EdgeSlices {
 public:
  explicit EdgeSlices(const std::vector<std::vector<Vec2>>& rings) : rings_(rings) {
    std::size_t edges = 0;
    for (const auto& ring : rings) {
      edges += ring.size();
      for (const Vec2 p : ring) {
        low_ = std::min(low_, p.y);
        high_ = std::max(high_, p.y);
      }
    }
    const auto slices = static_cast<std::size_t>(std::sqrt(static_cast<double>(edges))) + 1;
    per_slice_ = high_ > low_ ? static_cast<double>(slices) / (high_ - low_) : 0;
    slices_.resize(slices + 1);
    for (std::uint32_t r = 0; r < rings.size(); ++r)
      for (std::uint32_t i = 0; i < rings[r].size(); ++i) {
        const double a = rings[r][i].y, b = rings[r][(i + 1) % rings[r].size()].y;
        for (std::size_t s = slice(std::min(a, b)); s <= slice(std::max(a, b)); ++s) slices_[s].push_back({r, i});
      }
  }

  /// The ring of the next edge to the left of p (or through it), not counting `own`.
  std::size_t left_of(Vec2 p, std::size_t own) const {
    return next_to_the_left(p, [&](std::size_t ring, Vec2, Vec2) { return ring != own; });
  }
  /// The ring around p's region, where every ring has its region on its left: of the edges through one place the one
  /// that runs down bounds what lies to the right.
  std::size_t region_of(Vec2 p) const {
    return next_to_the_left(p, [](std::size_t, Vec2 a, Vec2 b) { return a.y > b.y; });
  }

 private:
  template <class Wanted>
  std::size_t next_to_the_left(Vec2 p, const Wanted& wanted) const {
    if (!(p.y >= low_ && p.y <= high_)) return kNoRing;
    double best = -1e300;
    std::size_t found = kNoRing;
    for (const auto& [r, i] : slices_[slice(p.y)]) {
      const Vec2 a = rings_[r][i], b = rings_[r][(i + 1) % rings_[r].size()];
      if ((a.y <= p.y) == (b.y <= p.y) || !wanted(r, a, b)) continue;
      const double x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
      if (x <= p.x && x > best) {
        best = x;
        found = r;
      }
    }
    return found;
  }

  struct Edge {
    std::uint32_t ring, at;
  };
  std::size_t slice(double y) const { return static_cast<std::size_t>((y - low_) * per_slice_); }

  const std::vector<std::vector<Vec2>>& rings_;
  double low_ = 1e300, high_ = -1e300, per_slice_ = 0;
  std::vector<std::vector<Edge>> slices_;
};

}  // namespace retalho
