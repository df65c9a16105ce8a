// Internal to level/: what the tracer needs to know of a bicubic patch on the unit square (u, v); ordinate [4 * i + j],
// i along v, j along u.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

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
  using Slopes = Fours<kGradients>;

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
  [[gnu::always_inline]] static void gradients(const Net<I>& b, Slopes& du, Slopes& dv) {
    const Differences<I> d(b);
    auto *u = reinterpret_cast<Four*>(du.data()), *v = reinterpret_cast<Four*>(dv.data());
    for (std::size_t i = 0; i < 4; ++i) {
      // The outer differences stay, each inner ordinate is (an outer one + 2 the middle one) / 3.
      const Four outer = __builtin_shufflevector(d.u[i], d.u[i], 0, 0, 3, 3);
      const Four inner = (outer + 2 * d.u[i]) * (1 / 3.0);
      u[i] = __builtin_shufflevector(d.u[i], inner, 0, 5, 6, 3);
    }
    v[0] = d.v[0];
    v[1] = (d.v[0] + 2 * d.v[1]) * (1 / 3.0);
    v[2] = (2 * d.v[1] + d.v[2]) * (1 / 3.0);
    v[3] = d.v[2];
  }
  template <class I>
  [[gnu::always_inline]] static SecondRanges second(const Net<I>& b) {
    SecondRanges s;
    if constexpr (std::is_same_v<I, double>) {
      const Four* row = fours(b.data());
      const auto range =
          [](const Four& x, const Four& y, double factor, std::array<double, 2>& r) __attribute__((always_inline)) {
        const Four low = x < y ? x : y, high = x > y ? x : y;
        r = {least_of(low) * factor, most_of(high) * factor};
      };
      // Along u: both differences of two rows at once.
      Four along[2];
      for (std::size_t i = 0; i < 2; ++i) {
        const Four &p = row[2 * i], &q = row[2 * i + 1];
        along[i] = __builtin_shufflevector(p, q, 2, 3, 6, 7) - 2 * __builtin_shufflevector(p, q, 1, 2, 5, 6) +
                   __builtin_shufflevector(p, q, 0, 1, 4, 5);
      }
      range(along[0], along[1], 6, s.uu);
      range(row[2] - 2 * row[1] + row[0], row[3] - 2 * row[2] + row[1], 6, s.vv);
      Four mixed[3];  // the fourth lane says what the third does
      for (std::size_t i = 0; i < 3; ++i) {
        const Four &p = row[i], &q = row[i + 1];
        mixed[i] = __builtin_shufflevector(q, q, 1, 2, 3, 3) - __builtin_shufflevector(q, q, 0, 1, 2, 2) -
                   __builtin_shufflevector(p, p, 1, 2, 3, 3) + __builtin_shufflevector(p, p, 0, 1, 2, 2);
      }
      const Four low = mixed[2] < mixed[1] ? mixed[2] : mixed[1], high = mixed[2] > mixed[1] ? mixed[2] : mixed[1];
      s.uv = {least_of(mixed[0] < low ? mixed[0] : low) * 9, most_of(mixed[0] > high ? mixed[0] : high) * 9};
    } else {
      const auto difference = [&](std::size_t i, std::size_t step) {
        return static_cast<double>(b[i + 2 * step] - 2 * b[i + step] + b[i]);
      };
      range_of<8>([&](std::size_t k) { return 6 * difference(4 * (k / 2) + k % 2, 1); }, s.uu[0], s.uu[1]);
      range_of<8>([&](std::size_t k) { return 6 * difference(k, 4); }, s.vv[0], s.vv[1]);
      range_of<9>(
          [&](std::size_t k) {
            const std::size_t i = 4 * (k / 3) + k % 3;
            return 9 * static_cast<double>(b[i + 5] - b[i + 4] - b[i + 1] + b[i]);
          },
          s.uv[0], s.uv[1]);
    }
    return s;
  }
  /// Value and both partial derivatives.
  [[gnu::always_inline]] static void evaluate(const Net<double>& b, Vec2 p, double& f, Vec2& derivatives) {
    const double s = 1 - p.x, x = p.x;
    // The basis s^3, 3 s^2 x, 3 s x^2, x^3 and its derivatives along u, a lane an ordinate of a row.
    const Four first{s, s, s, x}, second{s, s, x, x}, third{s, x, x, x};
    const Four bx = Four{1, 3, 3, 1} * first * second * third;
    const Four dx = Four{-3, 3, 6, 3} * first * second - Four{0, 6, 3, 0} * second * third;
    // Along v, a row at a time: four sums side by side.
    const Four t = Four{} + (1 - p.y), y = Four{} + p.y;
    const Four tt = t * t, yy = y * y, t3 = 3 * t * t, y3 = 3 * y * y, ty = 6 * t * y;
    const Four* row = fours(b.data());
    const Four column = tt * t * row[0] + t3 * y * row[1] + 3 * t * y * y * row[2] + yy * y * row[3];
    const Four slope = -t3 * row[0] + (t3 - ty) * row[1] + (ty - y3) * row[2] + y3 * row[3];
    const Four value = bx * column, along_u = dx * column, along_v = bx * slope;
    f = (value[0] + value[1]) + (value[2] + value[3]);
    derivatives = {(along_u[0] + along_u[1]) + (along_u[2] + along_u[3]),
                   (along_v[0] + along_v[1]) + (along_v[2] + along_v[3])};
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
  [[gnu::always_inline]] static Vec2 clamp(Vec2 p) { return {std::clamp(p.x, 0.0, 1.0), std::clamp(p.y, 0.0, 1.0)}; }

 private:
  /// First differences of the ordinates: along u the first, the second twice and the third of each row; along v from
  /// row to row.
  template <class I>
  struct Differences {
    Four u[4], v[3];

    [[gnu::always_inline]] explicit Differences(const Net<I>& b) {
      if constexpr (std::is_same_v<I, double>) {
        const Four* row = fours(b.data());
        for (std::size_t i = 0; i < 4; ++i)
          u[i] =
              __builtin_shufflevector(row[i], row[i], 1, 2, 2, 3) - __builtin_shufflevector(row[i], row[i], 0, 1, 1, 2);
        for (std::size_t i = 0; i < 3; ++i) v[i] = row[i + 1] - row[i];
      } else {
        const auto d = [&](std::size_t i, std::size_t step) { return static_cast<double>(b[i + step] - b[i]); };
        for (std::size_t i = 0; i < 16; i += 4) u[i / 4] = Four{d(i, 1), d(i + 1, 1), d(i + 1, 1), d(i + 2, 1)};
        for (std::size_t i = 0; i < 12; i += 4) v[i / 4] = Four{d(i, 4), d(i + 1, 4), d(i + 2, 4), d(i + 3, 4)};
      }
    }
  };
};

}  // namespace retalho
