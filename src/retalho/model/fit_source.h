// The fit of a grid as the source of a compact file's numbers. Internal to the room.
#pragma once

#include <vector>

#include "retalho/model/compact_file.h"
#include "retalho/terrain/held_fit.h"

namespace retalho {

/// After each group the numbers that are not yet coded are fitted anew, those that are stay as they were rounded.
class FitSource : public ValueSource {
 public:
  explicit FitSource(HeldFit& fit) : fit_(fit) {}
  void settle() override { fit_.solve(1e-5, 60); }
  double height(std::uint32_t v) override { return fit_.height(v); }
  Vec2 gradient(std::uint32_t v) override { return fit_.gradient(v); }
  void coded_height(std::uint32_t v, double height) override { fit_.hold_height(v, height); }
  void coded_gradient(std::uint32_t v, Vec2 gradient) override { fit_.hold_gradient(v, gradient); }

 private:
  HeldFit& fit_;
};

/// A surface within a tolerance, its numbers on their lattices already. A number becomes one that is shorter to write
/// where no cell then passes the tolerance and the squared errors around it grow by `allowance` at most (in squares of
/// the tolerance).
class ThriftySource : public ValueSource {
 public:
  ThriftySource(HeldFit& fit, double tolerance, double allowance)
      : fit_(fit), tolerance_(tolerance), allowance_(allowance) {}
  void settle() override {}
  double height(std::uint32_t v) override { return fit_.height(v); }
  Vec2 gradient(std::uint32_t v) override { return fit_.gradient(v); }
  bool accepts_height(std::uint32_t v, double height) override { return fits(v, height, fit_.gradient(v)); }
  bool accepts_gradient(std::uint32_t v, Vec2 gradient) override { return fits(v, fit_.height(v), gradient); }
  void coded_height(std::uint32_t v, double height) override { fit_.set(v, height, fit_.gradient(v)); }
  void coded_gradient(std::uint32_t v, Vec2 gradient) override { fit_.set(v, fit_.height(v), gradient); }

 private:
  bool fits(std::uint32_t v, double height, Vec2 gradient) const {
    const HeldFit::StarErrors then = fit_.star_errors(v, height, gradient, tolerance_);
    if (then.excess > 0) return false;
    return then.squares - fit_.star_errors(v, fit_.height(v), fit_.gradient(v), tolerance_).squares <= allowance_;
  }

  HeldFit& fit_;
  double tolerance_, allowance_;
};

}  // namespace retalho
