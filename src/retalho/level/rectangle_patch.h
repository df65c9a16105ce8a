// Internal to level/: what the tracer needs to know of a bicubic patch on the unit square (u, v); ordinate [4 * i + j],
// i along v, j along u.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "retalho/level/exact_roots.h"
#include "retalho/level/frame.h"
#include "retalho/level/lanes.h"
#include "retalho/level/patch_parts.h"

namespace retalho {

struct RectanglePatch {
  static constexpr int kDegree = 3;  ///< along a side
  static constexpr int kSides = 4;   ///< bottom and top run along u, right and left along v
  static constexpr int kOrdinates = 16;
  static constexpr int kInner = 4;  ///< new edges when it is cut in four
  static constexpr int kGradients = 16;
  static constexpr int kBitsADepth = 6;
  /// A side's ordinates carry factors of two that its own halving does not need; none are divided out.
  template <class I>
  using Net = std::array<I, kOrdinates>;

  /// The box's boundary, counter-clockwise in (u, v), runs along the side's own direction or against it.
  static constexpr std::array<bool, kSides> kAgainst{false, false, true, true};
  /// Inner edge k is side kInnerSide[k][1] of child kInnerSide[k][0]. Child = 2 * upper + right.
  static constexpr std::array<std::array<int, 2>, kInner> kInnerSide{{{0, 1}, {2, 1}, {0, 2}, {1, 2}}};
  static constexpr std::array<std::array<ChildSide, kSides>, 4> kChildren{{
      {{{false, 0, 0, false}, {true, 0, 0, false}, {true, 2, 0, false}, {false, 3, 0, false}}},
      {{{false, 0, 1, false}, {false, 1, 0, false}, {true, 3, 0, false}, {true, 0, 0, false}}},
      {{{true, 2, 0, false}, {true, 1, 0, false}, {false, 2, 0, false}, {false, 3, 1, false}}},
      {{{true, 3, 0, false}, {false, 1, 1, false}, {false, 2, 1, false}, {true, 1, 0, false}}},
  }};
  /// Side s, first half: side s of child kHalf[s].
  static constexpr std::array<int, kSides> kFirstHalf{0, 1, 2, 0};

  template <class I>
  static EdgeNet<3, I> edge(const Net<I>& b, int side) {
    switch (side) {
      case 0:
        return {b[0], b[1], b[2], b[3]};
      case 1:
        return {b[3], b[7], b[11], b[15]};
      case 2:
        return {b[12], b[13], b[14], b[15]};
      default:
        return {b[0], b[4], b[8], b[12]};
    }
  }
  static std::array<Vec2, 2> ends(const Frame& f, int side) {
    switch (side) {
      case 0:
        return {f.origin, f.place({1, 0})};
      case 1:
        return {f.place({1, 0}), f.place({1, 1})};
      case 2:
        return {f.place({0, 1}), f.place({1, 1})};
      default:
        return {f.origin, f.place({0, 1})};
    }
  }
  static Frame child_frame(const Frame& f, int child) {
    const Vec2 e1 = 0.5 * f.e1, e2 = 0.5 * f.e2;
    Vec2 origin = f.origin;
    if ((child & 1) != 0) origin = origin + e1;
    if ((child & 2) != 0) origin = origin + e2;
    return {origin, e1, e2};
  }
  /// The four children, every ordinate multiplied by 64.
  template <class I>
  static void split(const Net<I>& b, std::array<Net<I>, 4>& children) {
    std::array<std::array<I, 4>, 7> tall{};
    EdgeNet<3, I> first{}, second{};
    for (std::size_t j = 0; j < 4; ++j) {
      halve_edge<3, I>({b[j], b[4 + j], b[8 + j], b[12 + j]}, first, second);
      for (std::size_t i = 0; i < 4; ++i) {
        tall[i][j] = first[i];
        tall[3 + i][j] = second[i];
      }
    }
    for (std::size_t i = 0; i < 7; ++i) {
      halve_edge<3, I>(tall[i], first, second);
      for (std::size_t j = 0; j < 4; ++j) {
        if (i <= 3) {
          children[0][4 * i + j] = first[j];
          children[1][4 * i + j] = second[j];
        }
        if (i >= 3) {
          children[2][4 * (i - 3) + j] = first[j];
          children[3][4 * (i - 3) + j] = second[j];
        }
      }
    }
  }
  /// Ordinates of both partial derivatives, raised to degree (3, 3) and divided by 3.
  template <class I>
  static void gradients(const Net<I>& b, std::array<double, kGradients>& du, std::array<double, kGradients>& dv) {
    for (std::size_t i = 0; i < 4; ++i) {
      const double d0 = static_cast<double>(b[4 * i + 1] - b[4 * i]),
                   d1 = static_cast<double>(b[4 * i + 2] - b[4 * i + 1]),
                   d2 = static_cast<double>(b[4 * i + 3] - b[4 * i + 2]);
      du[4 * i] = d0;
      du[4 * i + 1] = (d0 + 2 * d1) * (1 / 3.0);
      du[4 * i + 2] = (2 * d1 + d2) * (1 / 3.0);
      du[4 * i + 3] = d2;
    }
    for (std::size_t j = 0; j < 4; ++j) {
      const double d0 = static_cast<double>(b[4 + j] - b[j]), d1 = static_cast<double>(b[8 + j] - b[4 + j]),
                   d2 = static_cast<double>(b[12 + j] - b[8 + j]);
      dv[j] = d0;
      dv[4 + j] = (d0 + 2 * d1) * (1 / 3.0);
      dv[8 + j] = (2 * d1 + d2) * (1 / 3.0);
      dv[12 + j] = d2;
    }
  }
  template <class I>
  static SecondRanges second(const Net<I>& b) {
    SecondRanges s;
    const auto difference = [&](std::size_t i, std::size_t step) {
      return static_cast<double>(b[i + 2 * step] - 2 * b[i + step] + b[i]);
    };
    range_of<8>([&](std::size_t k) { return difference(4 * (k / 2) + k % 2, 1); }, s.uu[0], s.uu[1]);
    range_of<8>([&](std::size_t k) { return difference(k, 4); }, s.vv[0], s.vv[1]);
    range_of<9>(
        [&](std::size_t k) {
          const std::size_t i = 4 * (k / 3) + k % 3;
          return static_cast<double>(b[i + 5] - b[i + 4] - b[i + 1] + b[i]);
        },
        s.uv[0], s.uv[1]);
    for (std::size_t i = 0; i < 2; ++i) {
      s.uu[i] *= 6;
      s.uv[i] *= 9;
      s.vv[i] *= 6;
    }
    return s;
  }
  /// Value and both partial derivatives.
  static void evaluate(const Net<double>& b, Vec2 p, double& f, Vec2& derivatives) {
    const double s = 1 - p.x, x = p.x, t = 1 - p.y, y = p.y;
    const std::array<double, 4> bx{s * s * s, 3 * s * s * x, 3 * s * x * x, x * x * x};
    const std::array<double, 4> dx{-3 * s * s, 3 * s * s - 6 * s * x, 6 * s * x - 3 * x * x, 3 * x * x};
    const std::array<double, 4> by{t * t * t, 3 * t * t * y, 3 * t * y * y, y * y * y};
    const std::array<double, 4> dy{-3 * t * t, 3 * t * t - 6 * t * y, 6 * t * y - 3 * y * y, 3 * y * y};
    // Down the columns first: four sums side by side.
    std::array<double, 4> column{}, slope{};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        column[j] += by[i] * b[4 * i + j];
        slope[j] += dy[i] * b[4 * i + j];
      }
    f = (bx[0] * column[0] + bx[1] * column[1]) + (bx[2] * column[2] + bx[3] * column[3]);
    derivatives = {(dx[0] * column[0] + dx[1] * column[1]) + (dx[2] * column[2] + dx[3] * column[3]),
                   (bx[0] * slope[0] + bx[1] * slope[1]) + (bx[2] * slope[2] + bx[3] * slope[3])};
  }
  /// How many steps of d fit into the patch from p.
  static double room(Vec2 p, Vec2 d) {
    double r = 1e300;
    if (d.x > 0) r = std::min(r, (1 - p.x) / d.x);
    if (d.x < 0) r = std::min(r, -p.x / d.x);
    if (d.y > 0) r = std::min(r, (1 - p.y) / d.y);
    if (d.y < 0) r = std::min(r, -p.y / d.y);
    return std::max(r, 0.0);
  }
  static Vec2 clamp(Vec2 p) { return {std::clamp(p.x, 0.0, 1.0), std::clamp(p.y, 0.0, 1.0)}; }
};

}  // namespace retalho
