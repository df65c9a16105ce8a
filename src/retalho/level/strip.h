// Internal to level/: the narrow rectangle around a chord that holds the arc it stands for.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "retalho/core/variants.h"
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
  typename Patch::Slopes du, dv;
  double largest_u = 0, largest_v = 0;  ///< magnitudes

  PatchSlopes() = default;
  [[gnu::always_inline]] explicit PatchSlopes(const typename Patch::template Net<double>& ordinates) : net(ordinates) {
    Patch::template gradients<double>(net, du, dv);
    double low = 0, high = 0;
    range_of(du, low, high);
    largest_u = std::max(-low, high);
    range_of(dv, low, high);
    largest_v = std::max(-low, high);
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
  [[gnu::always_inline]] SlopeSector(const PatchSlopes<Patch>& slopes, const Frame& frame) {
    constexpr auto kCount = static_cast<std::size_t>(Patch::kGradients);
    // Local gradients, four at a time; what fills the last four up is one of them again.
    typename Patch::Slopes x, y, place, size;
    const double det = cross(frame.e1, frame.e2);
    for (std::size_t i = 0; i < x.size(); i += 4) {
      const Four u = *fours(&slopes.du[i]), v = *fours(&slopes.dv[i]);
      *reinterpret_cast<Four*>(&x[i]) = (u * frame.e2.y - v * frame.e1.y) / det;
      *reinterpret_cast<Four*>(&y[i]) = (v * frame.e1.x - u * frame.e2.x) / det;
    }
    Vec2 sum;
    for (std::size_t i = 0; i < kCount; ++i) sum = sum + Vec2{x[i], y[i]};
    for (std::size_t i = 0; i < x.size(); i += 4) {
      const Four u = *fours(&x[i]), v = *fours(&y[i]);
      const Four ahead = sum.x * u + sum.y * v, aside = sum.x * v - sum.y * u;
      if (!(least_of(ahead) > 0)) return;
      *reinterpret_cast<Four*>(&place[i]) = aside / ahead;
      *reinterpret_cast<Four*>(&size[i]) = u * u + v * v;
    }
    std::size_t at_low = 0, at_high = 0;
    for (std::size_t i = 1; i < kCount; ++i) {
      if (place[i] < place[at_low]) at_low = i;
      if (place[i] > place[at_high]) at_high = i;
    }
    double shortest = 0, most = 0;
    range_of(size, shortest, most);
    if (!(shortest > 0) || !std::isfinite(most)) return;
    const auto unit = [&](std::size_t i) {
      const Vec2 g{x[i], y[i]};
      return g / norm(g);
    };
    first = unit(at_low);
    last = unit(at_high);
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
RETALHO_TWO_VARIANTS bool grows_across(const PatchSlopes<Patch>& patch, const Frame& frame, const Strip& strip,
                                       int depth, double scale, double& steepest) {
  const Vec2 d = frame.direction(strip.left());
  const auto [low, high, size] = range_of_sums(d.x, patch.du, d.y, patch.dv);
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
