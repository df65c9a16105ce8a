// Internal to level/: the narrow rectangle around a chord that holds the arc it stands for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "retalho/core/vec.h"
#include "retalho/level/frame.h"
#include "retalho/level/lanes.h"

namespace retalho {

struct Strip {
  Vec2 start, along;  ///< unit vector; uphill is to its left
  double length = 0;
  double low = 0, high = 0;  ///< offsets to the left

  Vec2 left() const { return {-along.y, along.x}; }

  /// May a convex polygon touch it? Never wrongly no.
  template <std::size_t N>
  bool touches(const std::array<Vec2, N>& corners) const {
    double a0 = 1e300, a1 = -1e300, b0 = 1e300, b1 = -1e300;
    for (const Vec2 p : corners) {
      const double a = dot(p - start, along), b = cross(along, p - start);
      a0 = std::min(a0, a);
      a1 = std::max(a1, a);
      b0 = std::min(b0, b);
      b1 = std::max(b1, b);
    }
    const double slack = 1e-9 * ((a1 - a0) + (b1 - b0) + length);
    return a0 <= length + slack && a1 >= -slack && b0 <= high + slack && b1 >= low - slack;
  }
};

template <class Patch>
auto frame_corners(const Frame& f) {
  if constexpr (Patch::kSides == 3)
    return std::array<Vec2, 3>{f.origin, f.origin + f.e1, f.origin + f.e2};
  else
    return std::array<Vec2, 4>{f.origin, f.origin + f.e1, f.origin + f.e1 + f.e2, f.origin + f.e2};
}

/// A patch's ordinates and those of its partial derivatives.
template <class Patch>
struct PatchSlopes {
  typename Patch::template Net<double> net;
  std::array<double, static_cast<std::size_t>(Patch::kGradients)> du, dv;
  double largest_u = 0, largest_v = 0;  ///< magnitudes

  PatchSlopes() = default;
  explicit PatchSlopes(const typename Patch::template Net<double>& ordinates) : net(ordinates) {
    Patch::template gradients<double>(net, du, dv);
    for (std::size_t i = 0; i < du.size(); ++i) {
      largest_u = std::max(largest_u, std::abs(du[i]));
      largest_v = std::max(largest_v, std::abs(dv[i]));
    }
  }
};

/// Between which directions a patch's gradients lie, where they lie within less than a right angle of one of them: most
/// strips are judged by these two alone.
struct SlopeSector {
  Vec2 first, last;    ///< unit vectors; all gradients of the net lie between them
  double least = 0;    ///< length of the shortest gradient over that of the longest; 0: nothing is known
  double longest = 0;  ///< of the gradients, ordinates a local unit

  SlopeSector() = default;
  template <class Patch>
  SlopeSector(const PatchSlopes<Patch>& slopes, const Frame& frame) {
    std::array<Vec2, static_cast<std::size_t>(Patch::kGradients)> g{};
    Vec2 sum;
    for (std::size_t i = 0; i < g.size(); ++i) {
      g[i] = frame.gradient({slopes.du[i], slopes.dv[i]});
      sum = sum + g[i];
    }
    double low = 1e300, high = -1e300, shortest = 1e300, most = 0;
    std::size_t at_low = 0, at_high = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      const double ahead = dot(sum, g[i]), aside = cross(sum, g[i]);
      if (!(ahead > 0)) return;
      const double place = aside / ahead, size = norm2(g[i]);
      if (place < low) {
        low = place;
        at_low = i;
      }
      if (place > high) {
        high = place;
        at_high = i;
      }
      shortest = std::min(shortest, size);
      most = std::max(most, size);
    }
    if (!(shortest > 0) || !std::isfinite(most)) return;
    first = g[at_low] / norm(g[at_low]);
    last = g[at_high] / norm(g[at_high]);
    least = std::sqrt(shortest / most);
    longest = std::sqrt(most) * Patch::kDegree;
  }
  /// Every gradient points to the strip's left, by more than rounding can take: then the polynomial grows across it.
  bool across(const Strip& strip) const {
    const Vec2 left = strip.left();
    return std::min(dot(first, left), dot(last, left)) * least > 1e-9;
  }
};

/// Does the polynomial grow along the strip's left everywhere in the part of the patch that the strip may touch?
/// `steepest`: raised to the largest growth, in ordinates a local unit. The patch is halved `depth` times at most.
template <class Patch>
bool grows_across(const PatchSlopes<Patch>& patch, const Frame& frame, const Strip& strip, int depth, double scale,
                  double& steepest) {
  const Vec2 d = frame.direction(strip.left());
  double low = 0, high = 0;
  range_of<static_cast<std::size_t>(Patch::kGradients)>(
      [&](std::size_t i) { return d.x * patch.du[i] + d.y * patch.dv[i]; }, low, high);
  if (low > 1e-12 * (std::abs(d.x) * patch.largest_u + std::abs(d.y) * patch.largest_v)) {
    steepest = std::max(steepest, Patch::kDegree * high / scale);
    return true;
  }
  if (depth == 0) return false;
  std::array<typename Patch::template Net<double>, 4> nets;
  Patch::template split<double>(patch.net, nets);
  for (int c = 0; c < 4; ++c) {
    const Frame child = Patch::child_frame(frame, c);
    if (!strip.touches(frame_corners<Patch>(child))) continue;
    if (!grows_across(PatchSlopes<Patch>(nets[static_cast<std::size_t>(c)]), child, strip, depth - 1,
                      scale * (1 << Patch::kBitsADepth), steepest))
      return false;
  }
  return true;
}

}  // namespace retalho
