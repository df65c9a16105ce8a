// Internal to level/: what the tracer needs to know of a polynomial of degree N on a triangle with corners A, B, C;
// parameters (r, s) from C: place = C + r (A - C) + s (B - C). Ordinates as in bernstein/triangle.h.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "retalho/bernstein/triangle.h"
#include "retalho/level/exact_roots.h"
#include "retalho/level/frame.h"
#include "retalho/level/lanes.h"
#include "retalho/level/patch_parts.h"

namespace retalho {

template <int N>
struct TrianglePatch {
  static constexpr int kDegree = N;
  static constexpr int kSides = 3;  ///< A to B, B to C, C to A
  static constexpr int kOrdinates = ordinate_count(N);
  static constexpr int kInner = 3;
  static constexpr int kGradients = ordinate_count(N - 1);
  static constexpr int kBitsADepth = N;
  template <class I>
  using Net = std::array<I, static_cast<std::size_t>(kOrdinates)>;
  using Slopes = Fours<static_cast<std::size_t>(kGradients)>;

  static constexpr std::array<bool, kSides> kAgainst{false, false, false};
  /// Children: at A, at B, at C (each with its corners in the same places), and the middle one (AB, BC, CA).
  static constexpr std::array<std::array<int, 2>, kInner> kInnerSide{{{3, 0}, {3, 1}, {3, 2}}};
  static constexpr std::array<std::array<ChildSide, kSides>, 4> kChildren{{
      {{{false, 0, 0, false}, {true, 2, 0, true}, {false, 2, 1, false}}},
      {{{false, 0, 1, false}, {false, 1, 0, false}, {true, 0, 0, true}}},
      {{{true, 1, 0, true}, {false, 1, 1, false}, {false, 2, 0, false}}},
      {{{true, 0, 0, false}, {true, 1, 0, false}, {true, 2, 0, false}}},
  }};
  static constexpr std::array<int, kSides> kFirstHalf{0, 1, 2};

  static constexpr std::size_t at(int i, int j) { return static_cast<std::size_t>(ordinate_index(N, i, j)); }

  template <class I>
  static EdgeNet<N, I> edge(const Net<I>& b, int side) {
    EdgeNet<N, I> e{};
    for (int k = 0; k <= N; ++k)
      e[static_cast<std::size_t>(k)] = side == 0 ? b[at(N - k, k)] : side == 1 ? b[at(0, N - k)] : b[at(k, 0)];
    return e;
  }
  static std::array<Vec2, 2> ends(const Frame& f, int side) {
    const Vec2 a = f.origin + f.e1, b = f.origin + f.e2, c = f.origin;
    if (side == 0) return {a, b};
    if (side == 1) return {b, c};
    return {c, a};
  }
  static Frame child_frame(const Frame& f, int child) {
    const Vec2 e1 = 0.5 * f.e1, e2 = 0.5 * f.e2;
    switch (child) {
      case 0:
        return {f.origin + e1, e1, e2};
      case 1:
        return {f.origin + e2, e1, e2};
      case 2:
        return {f.origin, e1, e2};
      default:
        return {f.origin + e1, e2, e2 - e1};
    }
  }
  /// The four children, every ordinate multiplied by 2^N: the blossom at the doubled corners.
  template <class I>
  static void split(const Net<I>& b, std::array<Net<I>, 4>& children) {
    // Doubled barycentric coordinates of A, B, C, AB, BC, CA.
    constexpr std::array<std::array<int, 3>, 6> kPoint{
        {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}}};
    constexpr std::array<std::array<std::size_t, 3>, 4> kCorner{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
    for (std::size_t c = 0; c < 4; ++c)
      for (int i = N; i >= 0; --i)
        for (int j = N - i; j >= 0; --j) {
          std::array<std::array<int, 3>, 3> arguments{};
          std::size_t n = 0;
          for (int k = 0; k < i; ++k) arguments[n++] = kPoint[kCorner[c][0]];
          for (int k = 0; k < j; ++k) arguments[n++] = kPoint[kCorner[c][1]];
          for (int k = 0; k < N - i - j; ++k) arguments[n++] = kPoint[kCorner[c][2]];
          children[c][at(i, j)] = blossom<I>(b, arguments);
        }
  }
  /// Ordinates of both partial derivatives, divided by N; the last ones fill up.
  template <class I>
  [[gnu::always_inline]] static void gradients(const Net<I>& b, Slopes& du, Slopes& dv) {
    for (int i = N - 1; i >= 0; --i)
      for (int j = N - 1 - i; j >= 0; --j) {
        const auto g = static_cast<std::size_t>(ordinate_index(N - 1, i, j));
        du[g] = static_cast<double>(b[at(i + 1, j)] - b[at(i, j)]);
        dv[g] = static_cast<double>(b[at(i, j + 1)] - b[at(i, j)]);
      }
    for (std::size_t g = kGradients; g < du.size(); ++g) {
      du[g] = du[kGradients - 1];
      dv[g] = dv[kGradients - 1];
    }
  }
  template <class I>
  static SecondRanges second(const Net<I>& b) {
    if constexpr (N == 1) return {};
    SecondRanges s{{1e300, -1e300}, {1e300, -1e300}, {1e300, -1e300}};
    const auto take = [](std::array<double, 2>& range, I value) {
      const double x = N * (N - 1) * static_cast<double>(value);
      range[0] = std::min(range[0], x);
      range[1] = std::max(range[1], x);
    };
    if constexpr (N >= 2)
      for (int i = N - 2; i >= 0; --i)
        for (int j = N - 2 - i; j >= 0; --j) {
          take(s.uu, b[at(i + 2, j)] - 2 * b[at(i + 1, j)] + b[at(i, j)]);
          take(s.uv, b[at(i + 1, j + 1)] - b[at(i + 1, j)] - b[at(i, j + 1)] + b[at(i, j)]);
          take(s.vv, b[at(i, j + 2)] - 2 * b[at(i, j + 1)] + b[at(i, j)]);
        }
    return s;
  }
  static void evaluate(const Net<double>& b, Vec2 p, double& f, Vec2& derivatives) {
    const Barycentric u{p.x, p.y, 1 - p.x - p.y};
    TriangleNet<1> first{};
    if constexpr (N == 1) first = b;
    if constexpr (N == 2) first = casteljau_step<2>(b, u);
    if constexpr (N == 3) first = casteljau_step<2>(casteljau_step<3>(b, u), u);
    f = u.r * first[0] + u.s * first[1] + u.t * first[2];
    derivatives = {N * (first[0] - first[2]), N * (first[1] - first[2])};
  }
  static double room(Vec2 p, Vec2 d) {
    double r = 1e300;
    if (d.x < 0) r = std::min(r, -p.x / d.x);
    if (d.y < 0) r = std::min(r, -p.y / d.y);
    if (d.x + d.y > 0) r = std::min(r, (1 - p.x - p.y) / (d.x + d.y));
    return std::max(r, 0.0);
  }
  [[gnu::always_inline]] static Vec2 clamp(Vec2 p) {
    p = {std::max(p.x, 0.0), std::max(p.y, 0.0)};
    const double over = p.x + p.y - 1;
    return over > 0 ? Vec2{std::max(p.x - 0.5 * over, 0.0), std::max(p.y - 0.5 * over, 0.0)} : p;
  }

 private:
  template <class I>
  static I blossom(const Net<I>& b, const std::array<std::array<int, 3>, 3>& a) {
    const auto step = [](const std::array<int, 3>& u, I x, I y, I z) { return u[0] * x + u[1] * y + u[2] * z; };
    if constexpr (N == 1) {
      return step(a[0], b[0], b[1], b[2]);
    } else if constexpr (N == 2) {
      return step(a[1], step(a[0], b[0], b[1], b[2]), step(a[0], b[1], b[3], b[4]), step(a[0], b[2], b[4], b[5]));
    } else {
      std::array<I, 6> e{};
      for (int i = 2; i >= 0; --i)
        for (int j = 2 - i; j >= 0; --j)
          e[static_cast<std::size_t>(ordinate_index(2, i, j))] =
              step(a[0], b[at(i + 1, j)], b[at(i, j + 1)], b[at(i, j)]);
      return step(a[2], step(a[1], e[0], e[1], e[2]), step(a[1], e[1], e[3], e[4]), step(a[1], e[2], e[4], e[5]));
    }
  }
};

}  // namespace retalho
