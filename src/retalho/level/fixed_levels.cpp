#include "retalho/level/fixed_levels.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "retalho/core/error.h"

namespace retalho {

FixedLevels::FixedLevels(const std::vector<double>& heights, double per_unit) {
  // Levels far outside of the surface are kept in order, so that indices stay those of the caller.
  constexpr double kFar = static_cast<double>(std::int64_t{1} << 40);
  for (std::size_t k = 0; k < heights.size(); ++k) {
    const double quanta = std::nearbyint(std::clamp(heights[k] * per_unit, -kFar, kFar));
    std::int64_t threshold = 2 * static_cast<std::int64_t>(quanta) - 1;
    if (!threshold_.empty() && threshold <= threshold_.back()) {
      if (std::abs(quanta) < kFar)
        throw BadInput(
            fmt::format("the levels {} and {} are closer than the height quantum {:.3g}: ask for a larger interval",
                        heights[k - 1], heights[k], 1 / per_unit));
      threshold = threshold_.back() + 2;
    }
    threshold_.push_back(threshold);
  }
  const std::size_t n = threshold_.size();
  tube_.assign(n, std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < n; ++k) {
    // Thresholds are doubled: half of a gap in quanta is a quarter of their difference; a little less, so that tubes of
    // neighbours stay apart whatever rounding does to the last digits.
    if (k > 0) tube_[k] = std::min(tube_[k], 0.249 * static_cast<double>(threshold_[k] - threshold_[k - 1]));
    if (k + 1 < n) tube_[k] = std::min(tube_[k], 0.249 * static_cast<double>(threshold_[k + 1] - threshold_[k]));
  }
  if (n > 0) first_ = static_cast<double>(threshold_[0]);
  if (n > 1) {
    const double range = static_cast<double>(threshold_[n - 1] - threshold_[0]);
    per_step_ = static_cast<double>(n - 1) / range;
    for (std::size_t k = 0; k < n; ++k)
      even_ = even_ && std::abs(static_cast<double>(threshold_[k]) - first_ - static_cast<double>(k) / per_step_) <= 4;
  }
}

}  // namespace retalho
