// Internal to level/: a few values at once. Their range is taken in four independent lanes, so that no comparison waits
// for the one before; the smallest and the largest are the same in any order.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

namespace retalho {

/// Four doubles side by side, wherever they stand: one register of AVX2, two of what every machine has.
using Four = double __attribute__((vector_size(32), aligned(8), may_alias));
inline const Four* fours(const double* values) {
  return reinterpret_cast<const Four*>(values);
}

/// Room for N doubles and for what fills the last four up.
template <std::size_t N>
using Fours = std::array<double, (N + 3) / 4 * 4>;

inline double least_of(const Four& v) {
  const double a = v[0] < v[1] ? v[0] : v[1], b = v[2] < v[3] ? v[2] : v[3];
  return a < b ? a : b;
}
inline double most_of(const Four& v) {
  const double a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
  return a > b ? a : b;
}

/// What x du + y dv is over the N places of both: the range, and the largest |x du| + |y dv|. N a multiple of four.
struct SumRange {
  double low, high, size;
};
template <std::size_t N>
[[gnu::always_inline]] inline SumRange range_of_sums(double x, const std::array<double, N>& du, double y,
                                                     const std::array<double, N>& dv) {
  static_assert(N % 4 == 0);
  const auto sums = [&](std::size_t i, Four & sum, Four & sizes) __attribute__((always_inline)) {
    const Four a = x * fours(du.data())[i], b = y * fours(dv.data())[i];
    sum = a + b;
    sizes = (a < 0 ? -a : a) + (b < 0 ? -b : b);
  };
  Four low, size;
  sums(0, low, size);
  Four high = low;
  for (std::size_t i = 1; i < N / 4; ++i) {
    Four sum, sizes;
    sums(i, sum, sizes);
    low = sum < low ? sum : low;
    high = sum > high ? sum : high;
    size = sizes > size ? sizes : size;
  }
  return {least_of(low), most_of(high), most_of(size)};
}

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

/// Smallest and largest of a few values.
template <class T, std::size_t N>
[[gnu::always_inline]] inline void range_of(const std::array<T, N>& values, T& low, T& high) {
  if constexpr (std::is_same_v<T, double> && N >= 8) {
    Four least = *fours(values.data()), most = least;
    const auto take = [&](const Four& x) __attribute__((always_inline)) {
      least = x < least ? x : least;
      most = x > most ? x : most;
    };
    for (std::size_t i = 4; i + 4 <= N; i += 4) take(*fours(values.data() + i));
    if (N % 4 != 0) take(*fours(values.data() + N - 4));
    low = least_of(least);
    high = most_of(most);
  } else {
    range_of<N>([&](std::size_t i) { return values[i]; }, low, high);
  }
}

}  // namespace retalho
