// Internal to level/: the range of a few values, taken in four independent lanes, so that no comparison waits for the
// one before. The smallest and the largest are the same in any order.
#pragma once

#include <array>
#include <cstddef>

namespace retalho {

/// Smallest and largest of value(0) ... value(N - 1).
template <std::size_t N, class T, class Value>
inline void range_of(const Value& value, T& low, T& high) {
  if constexpr (N < 8) {
    low = high = value(0);
    for (std::size_t i = 1; i < N; ++i) {
      const T x = value(i);
      low = x < low ? x : low;
      high = x > high ? x : high;
    }
  } else {
    constexpr std::size_t kLanes = 4;
    std::array<T, kLanes> least{}, most{};
    for (std::size_t l = 0; l < kLanes; ++l) least[l] = most[l] = value(l);
    for (std::size_t i = kLanes; i + kLanes <= N; i += kLanes)
      for (std::size_t l = 0; l < kLanes; ++l) {
        const T x = value(i + l);
        least[l] = x < least[l] ? x : least[l];
        most[l] = x > most[l] ? x : most[l];
      }
    for (std::size_t i = N - N % kLanes; i < N; ++i) {
      const T x = value(i);
      least[0] = x < least[0] ? x : least[0];
      most[0] = x > most[0] ? x : most[0];
    }
    const auto less = [](T a, T b) { return a < b ? a : b; };
    const auto more = [](T a, T b) { return a > b ? a : b; };
    low = less(less(least[0], least[1]), less(least[2], least[3]));
    high = more(more(most[0], most[1]), more(most[2], most[3]));
  }
}

}  // namespace retalho
