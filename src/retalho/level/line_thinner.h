// Internal to level/: the walk along a line that looks for the farthest vertex each chord may reach. `Surface` offers
//   bool across(const Strip&, std::uint32_t hint, double& steepest)
// which tells whether the surface grows across the strip (level/strip.h) and how steeply at most.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "retalho/level/strip.h"

namespace retalho {

template <class Surface>
class LineThinner {
 public:
  /// Chords stay within `tolerance` of the arcs, which lie within `raw` of the given vertices' chords.
  LineThinner(Surface& surface, double tolerance, double raw) : surface_(surface), tolerance_(tolerance), raw_(raw) {}

  /// Sets keep[i] for the points that stay. `tube`: how far a chord may leave the level, in ordinates.
  void thin(std::span<const Vec2> points, std::span<const std::uint32_t> cells, bool closed, double tube,
            std::span<std::uint8_t> keep) {
    points_ = points;
    cells_ = cells;
    tube_ = tube;
    const std::size_t n = points.size(), last = closed ? n : n - 1;
    if (n <= 2 || (closed && n <= 3)) {
      std::fill(keep.begin(), keep.end(), std::uint8_t{1});
      return;
    }
    keep[0] = 1;
    const std::size_t kept = walk(0, last, keep);
    if (!closed) keep[last] = 1;
    if (closed && kept < 3) {
      std::fill(keep.begin(), keep.end(), std::uint8_t{1});  // cannot happen: both chords would have uphill on the left
      return;
    }
    if (!closed && kept == 1) {
      // A line that cuts off a piece of a border side: the bare chord might lie on that side.
      std::size_t farthest = 1;
      double distance = -1;
      const Vec2 chord = points[last] - points[0];
      for (std::size_t i = 1; i < last; ++i) {
        const double d = std::abs(cross(chord, points[i] - points[0]));
        if (d > distance) {
          distance = d;
          farthest = i;
        }
      }
      keep[farthest] = 1;
      walk(0, farthest, keep);
      walk(farthest, last, keep);
    }
  }

 private:
  Vec2 at(std::size_t i) const { return points_[i == points_.size() ? 0 : i]; }

  /// From `begin` to `end` by chords as long as they may be; marks what is kept but `end`, returns how many chords.
  std::size_t walk(std::size_t begin, std::size_t end, std::span<std::uint8_t> keep) {
    std::size_t chords = 0;
    for (std::size_t i = begin; i < end; ++chords) {
      keep[i] = 1;
      std::size_t good = i + 1, bad = end + 1, stride = 2;
      while (good < end) {
        const std::size_t next = std::min(i + stride, end);
        if (!admissible(i, next)) {
          bad = next;
          break;
        }
        good = next;
        stride *= 2;
      }
      while (bad <= end && bad - good > 1) {
        const std::size_t middle = good + (bad - good) / 2;
        (admissible(i, middle) ? good : bad) = middle;
      }
      i = good;
    }
    return chords;
  }

  bool admissible(std::size_t i, std::size_t j) {
    const Vec2 p = at(i), chord = at(j) - p;
    const double length = norm(chord);
    if (!(length > 0)) return false;
    const Vec2 along = chord / length;
    double low = 0, high = 0;
    const double reach = tolerance_ - raw_;
    for (std::size_t k = i + 1; k < j; ++k) {
      const Vec2 d = at(k) - p;
      const double a = dot(d, along), t = cross(along, d);
      if (!(a >= 0 && a <= length && t <= reach && -t <= reach)) return false;
      low = std::min(low, t);
      high = std::max(high, t);
    }
    const Strip strip{p, along, length, low - raw_, high + raw_};
    double steepest = 0;
    if (!surface_.across(strip, cells_.empty() ? 0 : cells_[i], steepest)) return false;
    return steepest * std::max(-strip.low, strip.high) <= tube_;
  }

  Surface& surface_;
  double tolerance_, raw_, tube_ = 0;
  std::span<const Vec2> points_;
  std::span<const std::uint32_t> cells_;
};

}  // namespace retalho
