// Interval arithmetic with outward rounding by one unit in the last place after each operation: no rounding modes,
// so that it is safe in any thread. Header only.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace retalho {

struct Interval {
  double low = 0, high = 0;
  bool contains(double v) const { return low <= v && v <= high; }
  bool contains_zero() const { return contains(0); }
};

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline Interval whole_line() {
  return {-kInfinity, kInfinity};
}

/// [low, high] a little wider: what rounding to nearest may have taken away.
inline Interval widened(double low, double high) {
  if (std::isnan(low) || std::isnan(high)) return whole_line();
  return {std::nextafter(low, -kInfinity), std::nextafter(high, kInfinity)};
}
/// The same for library functions, whose error is a few units in the last place.
inline Interval widened_function(double low, double high) {
  constexpr double kSlack = 4 * std::numeric_limits<double>::epsilon();
  if (std::isnan(low) || std::isnan(high)) return whole_line();
  return widened(low - kSlack * std::abs(low), high + kSlack * std::abs(high));
}

inline Interval operator+(Interval a, Interval b) {
  return widened(a.low + b.low, a.high + b.high);
}
inline Interval operator-(Interval a, Interval b) {
  return widened(a.low - b.high, a.high - b.low);
}
inline Interval operator-(Interval a) {
  return {-a.high, -a.low};
}
inline Interval operator*(Interval a, Interval b) {
  // 0 * infinity is 0 here: a factor that is exactly zero gives zero.
  const auto times = [](double p, double q) { return p == 0 || q == 0 ? 0.0 : p * q; };
  const double p = times(a.low, b.low), q = times(a.low, b.high), r = times(a.high, b.low), s = times(a.high, b.high);
  return widened(std::min({p, q, r, s}), std::max({p, q, r, s}));
}
/// b must not contain zero inside; the whole line where it does.
inline Interval operator/(Interval a, Interval b) {
  if (b.contains_zero()) {
    if (b.low == 0 && b.high > 0 && a.low > 0) return {std::nextafter(a.low / b.high, -kInfinity), kInfinity};
    if (b.low == 0 && b.high > 0 && a.high < 0) return {-kInfinity, std::nextafter(a.high / b.high, kInfinity)};
    if (b.high == 0 && b.low < 0 && a.low > 0) return {-kInfinity, std::nextafter(a.low / b.low, kInfinity)};
    if (b.high == 0 && b.low < 0 && a.high < 0) return {std::nextafter(a.high / b.low, -kInfinity), kInfinity};
    return whole_line();
  }
  const double p = a.low / b.low, q = a.low / b.high, r = a.high / b.low, s = a.high / b.high;
  return widened(std::min({p, q, r, s}), std::max({p, q, r, s}));
}
inline Interval join(Interval a, Interval b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}
inline Interval square(Interval a) {
  const double p = a.low * a.low, q = a.high * a.high;
  if (a.contains_zero()) return {0, std::nextafter(std::max(p, q), kInfinity)};
  const Interval w = widened(std::min(p, q), std::max(p, q));
  return {std::max(0.0, w.low), w.high};
}
/// Whole powers, n >= 0.
inline Interval power(Interval a, int n) {
  if (n == 0) return {1, 1};
  if (n == 1) return a;
  const Interval half = power(a, n / 2);
  const Interval even = square(half);
  if (n % 2 == 0) return even;
  // a^n with n odd grows with a: its ends are the ends' powers.
  const auto end = [n](double v) {
    double r = v;
    for (int i = 1; i < n; ++i) r *= v;
    return r;
  };
  const double slack = n * std::numeric_limits<double>::epsilon();
  const double low = end(a.low), high = end(a.high);
  return widened(low - slack * std::abs(low), high + slack * std::abs(high));
}

}  // namespace retalho
