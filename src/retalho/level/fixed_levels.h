// Internal to level/: levels as whole quanta of a fixed-point surface. The line of level L is drawn at L - 1/2, and
// everything is doubled: ordinates are even, thresholds odd.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "retalho/level/exact_roots.h"

namespace retalho {

/// Heights are below 2^kHeightBits quanta: as fine as the floats in which grids come. A finer quantum would not show,
/// but cost: a flat place that lies on a level gets a loop whose radius is the quantum's root, and boxes are halved
/// down to it.
inline constexpr int kHeightBits = 23;
/// Bits of a doubled ordinate: heights and tangents add up, and rounding may add one more.
inline constexpr int kOrdinateBits = kHeightBits + 2;
/// Quanta a height unit, a power of two, for heights up to `size` (with their tangents).
inline double quanta_per_unit(double size) {
  int exponent = 0;
  std::frexp(size, &exponent);
  return size > 0 ? std::ldexp(1.0, kHeightBits - exponent) : 1;
}

class FixedLevels {
 public:
  FixedLevels() = default;
  /// `heights` ascending, in quanta after multiplication with `per_unit`. Throws BadInput when two of them round to
  /// the same quantum.
  FixedLevels(const std::vector<double>& heights, double per_unit);

  int count() const { return static_cast<int>(threshold_.size()); }
  /// 2 L - 1.
  double threshold(int level) const { return static_cast<double>(threshold_[static_cast<std::size_t>(level)]); }
  /// How far a line may leave its height, in quanta: below half the distance to the next level.
  double tube(int level) const { return tube_[static_cast<std::size_t>(level)]; }
  double first() const { return first_; }
  double per_step() const { return per_step_; }
  /// Every threshold is within 4 of first + k / per_step: rounding's share.
  bool even() const { return even_; }
  /// May a range of doubled quanta hold a threshold? Never wrongly no.
  bool may_cross(double low, double high) const {
    return !even_ ||
           std::floor((low - 6 - first_) * per_step_ - 1e-9) != std::floor((high + 6 - first_) * per_step_ + 1e-9);
  }

  /// How many levels have threshold <= x.
  int at_most(double x) const { return at_most_between<double>(x, x, 1, 0, 0, count()); }
  /// The threshold over `base`, times scale.
  template <class I>
  I scaled(int level, I scale, std::int64_t base = 0) const {
    return static_cast<I>(threshold_[static_cast<std::size_t>(level)] - base) * scale;
  }
  /// How many levels have (threshold - base) * scale <= x, where it is known that `from` have and that no more than
  /// `to` do: thresholds beyond are not looked at, their products may not fit. `quanta` is x / scale, nearly.
  template <class I>
  int at_most_between(I x, double quanta, I scale, std::int64_t base, int from, int to) const {
    const double place = quanta + static_cast<double>(base);
    int k = from;
    if (even_) {
      const double guess = (place - first_) * per_step_;
      k = guess < from ? from : guess >= to ? to : static_cast<int>(guess);
    } else {
      k = static_cast<int>(
          std::upper_bound(threshold_.begin() + from, threshold_.begin() + to, place,
                           [](double value, std::int64_t t) { return value < static_cast<double>(t); }) -
          threshold_.begin());
    }
    while (k < to && scaled<I>(k, scale, base) <= x) ++k;
    while (k > from && scaled<I>(k - 1, scale, base) > x) --k;
    return k;
  }

 private:
  std::vector<std::int64_t> threshold_;
  std::vector<double> tube_;
  double first_ = 0, per_step_ = 1;
  bool even_ = true;
};

}  // namespace retalho
