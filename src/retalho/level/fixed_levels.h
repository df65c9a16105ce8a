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

  /// How many levels have threshold * scale <= x.
  template <class I>
  int at_most(I x, I scale) const {
    const double guess = (static_cast<double>(x) / static_cast<double>(scale) - first_) * per_step_;
    const int n = count();
    int k = guess < 0 ? 0 : guess >= n ? n : static_cast<int>(guess);
    if (!even_) {
      k = static_cast<int>(
          std::upper_bound(threshold_.begin(), threshold_.end(), static_cast<double>(x) / static_cast<double>(scale),
                           [](double value, std::int64_t t) { return value < static_cast<double>(t); }) -
          threshold_.begin());
    }
    while (k < n && scaled<I>(k, scale) <= x) ++k;
    while (k > 0 && scaled<I>(k - 1, scale) > x) --k;
    return k;
  }
  template <class I>
  I scaled(int level, I scale) const {
    return static_cast<I>(threshold_[static_cast<std::size_t>(level)]) * scale;
  }

 private:
  std::vector<std::int64_t> threshold_;
  std::vector<double> tube_;
  double first_ = 0, per_step_ = 1;
  bool even_ = true;
};

}  // namespace retalho
