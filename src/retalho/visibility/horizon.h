// The horizon of one octant as a piecewise linear function of direction, merged ring by ring.
//
// Directions are s = v / u in [0, 1] (u along the octant's major axis, v across it, in cells), elevations h = (z - eye)
// / u. Grid edges stay straight segments in (s, h). The function is upper semicontinuous: a knot holds its limits from
// both sides and its own value, so that voids may cut edges away.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace retalho::visibility_detail {

inline constexpr double kNothing = -1e30;   ///< elevation where there is no terrain
inline constexpr double kBlocked = 1e30;    ///< elevation of a void that blocks
inline constexpr double kTieSlope = 1e-10;  ///< elevations closer than this touch

struct Knot {
  double s;
  double left, at, right;
};

/// `out` = the larger of `a` and `b` on [0, last knot of b]. Both start with a knot at 0; `a` reaches at least as far.
void merge_horizons(const std::vector<Knot>& a, const std::vector<Knot>& b, std::vector<Knot>& out);

/// Walks a horizon from left to right: elevations at growing directions.
class HorizonReader {
 public:
  explicit HorizonReader(const std::vector<Knot>& knots) : knots_(&knots) {}

  /// Elevation at `s`; calls must come with growing s.
  double at(double s) {
    const std::vector<Knot>& k = *knots_;
    while (next_ < k.size() && k[next_].s < s) ++next_;
    if (next_ >= k.size()) return kNothing;
    const Knot& b = k[next_];
    if (b.s == s || next_ == 0) return b.at;
    const Knot& a = k[next_ - 1];
    return a.right + (b.left - a.right) * ((s - a.s) / (b.s - a.s));
  }

  /// The first knot at or beyond the last direction asked for.
  std::size_t position() const { return next_; }
  /// The lowest limit around the last direction asked for, where `value` is the elevation there: below it on a spike.
  double lowest(double s, double value) const {
    if (next_ >= knots_->size() || (*knots_)[next_].s != s) return value;
    const Knot& k = (*knots_)[next_];
    return std::min(k.left, k.right);
  }
  /// The first knot beyond `s`, the last direction asked for.
  std::size_t beyond(double s) const { return next_ < knots_->size() && (*knots_)[next_].s == s ? next_ + 1 : next_; }

 private:
  const std::vector<Knot>* knots_;
  std::size_t next_ = 0;
};

}  // namespace retalho::visibility_detail
