// Internal to level/: roots of integer Bernstein polynomials on an edge, isolated by exact halving
// (docs/contours.md, "How"). Doubles hold the integers while they have at most 53 bits, then integers of 64 and 128
// bits.
//
// A sign is b >= M, with M odd at the start and b even: no ordinate is ever on the level; after halving the same rule
// is the level moved down by less than anything, on every edge and in every box alike.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace retalho {

__extension__ using Int128 = __int128;

inline constexpr int kBoxDepth = 15;   ///< boxes are not halved below 2^-15 of a patch
inline constexpr int kEdgeDepth = 17;  ///< nor edges below 2^-17, whatever box asks

/// A type of exact integers: how many bits it holds without the sign (two are kept free for sums), and the next wider.
template <class I>
struct Exact;
template <>
struct Exact<double> {
  static constexpr int kBits = 53;
  using Wider = std::int64_t;
};
template <>
struct Exact<std::int64_t> {
  static constexpr int kBits = 60;
  using Wider = Int128;
};
template <>
struct Exact<Int128> {
  static constexpr int kBits = 125;
  using Wider = void;
};

template <int N, class I>
using EdgeNet = std::array<I, static_cast<std::size_t>(N + 1)>;

/// Both halves, every ordinate multiplied by 2^N.
template <int N, class I>
void halve_edge(const EdgeNet<N, I>& b, EdgeNet<N, I>& left, EdgeNet<N, I>& right) {
  if constexpr (N == 1) {
    const I middle = b[0] + b[1];
    left = {2 * b[0], middle};
    right = {middle, 2 * b[1]};
  } else if constexpr (N == 2) {
    const I first = b[0] + b[1], last = b[1] + b[2];
    left = {4 * b[0], 2 * first, first + last};
    right = {first + last, 2 * last, 4 * b[2]};
  } else {
    static_assert(N == 3);
    const I first = b[0] + b[1], middle = b[1] + b[2], last = b[2] + b[3];
    left = {8 * b[0], 4 * first, 2 * (first + middle), first + 2 * middle + last};
    right = {left[3], 2 * (middle + last), 4 * last, 8 * b[3]};
  }
}

template <int N, class I>
int sign_variations(const EdgeNet<N, I>& b, I level) {
  int count = 0;
  for (std::size_t i = 0; i < N; ++i) count += (b[i] >= level) != (b[i + 1] >= level);
  return count;
}

/// The root in (0, 1) of a polynomial whose ordinates have one change of sign: Newton's steps inside a bracket.
template <int N>
double polish_root(const std::array<double, static_cast<std::size_t>(N + 1)>& e) {
  double c0 = e[0], c1 = N * (e[1] - e[0]), c2 = 0, c3 = 0;
  if constexpr (N == 2) c2 = e[2] - 2 * e[1] + e[0];
  if constexpr (N == 3) {
    c2 = 3 * (e[2] - 2 * e[1] + e[0]);
    c3 = e[3] - e[0] + 3 * (e[1] - e[2]);
  }
  const bool rising = e[N] >= 0;
  double low = 0, high = 1, t = e[0] / (e[0] - e[N]);
  if (!(t > 0 && t < 1)) t = 0.5;
  for (int step = 0; step < 60; ++step) {
    const double f = ((c3 * t + c2) * t + c1) * t + c0, slope = (3 * c3 * t + 2 * c2) * t + c1;
    ((f >= 0) == rising ? high : low) = t;
    double next = t - f / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const double moved = std::abs(next - t);
    t = next;
    if (moved < 1e-9 || f == 0) break;  // what is left is about its square
  }
  return t;
}

/// Calls emit(t) for each root of b - level on the edge, t in [0, 1] ascending. `depth` is the absolute depth
/// of the edge below its patch; `bits` bounds the ordinates' bits. A stretch of 2^-kEdgeDepth that is still undecided
/// counts as no root where its ends are alike and as one, at its middle, where they differ; undecided(t0, t1) is told.
template <int N, class I, class Emit, class Undecided>
void isolate_roots(const EdgeNet<N, I>& b, I level, int depth, int bits, const Emit& emit, const Undecided& undecided,
                   double start = 0, double length = 1) {
  const int variations = sign_variations<N>(b, level);
  if (variations == 0) return;
  if (variations == 1) {
    std::array<double, static_cast<std::size_t>(N + 1)> e{};
    for (std::size_t i = 0; i <= N; ++i) e[i] = static_cast<double>(b[i] - level);
    emit(start + length * polish_root<N>(e));
    return;
  }
  if (depth >= kEdgeDepth) {
    undecided(start, start + length);
    if ((b[0] >= level) != (b[N] >= level)) emit(start + 0.5 * length);
    return;
  }
  if constexpr (!std::is_void_v<typename Exact<I>::Wider>) {
    if (bits + N > Exact<I>::kBits) {
      using Wider = typename Exact<I>::Wider;
      EdgeNet<N, Wider> wide{};
      for (std::size_t i = 0; i <= N; ++i) wide[i] = static_cast<Wider>(b[i]);
      isolate_roots<N, Wider>(wide, static_cast<Wider>(level), depth, bits, emit, undecided, start, length);
      return;
    }
  }
  EdgeNet<N, I> left{}, right{};
  halve_edge<N, I>(b, left, right);
  const I scaled = level * (1 << N);
  isolate_roots<N, I>(left, scaled, depth + 1, bits + N, emit, undecided, start, 0.5 * length);
  isolate_roots<N, I>(right, scaled, depth + 1, bits + N, emit, undecided, start + 0.5 * length, 0.5 * length);
}

}  // namespace retalho
