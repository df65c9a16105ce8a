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
  void settle() override { fit_.solve(1e-3, 60); }
  double height(std::uint32_t v) override { return fit_.height(v); }
  Vec2 gradient(std::uint32_t v) override { return fit_.gradient(v); }
  void coded_height(std::uint32_t v, double height) override { fit_.hold_height(v, height); }
  void coded_gradient(std::uint32_t v, Vec2 gradient) override { fit_.hold_gradient(v, gradient); }

 private:
  HeldFit& fit_;
};

/// The fit as it stands: its numbers lie on their lattices already.
class SettledSource : public ValueSource {
 public:
  explicit SettledSource(const HeldFit& fit) : fit_(fit) {}
  void settle() override {}
  double height(std::uint32_t v) override { return fit_.height(v); }
  Vec2 gradient(std::uint32_t v) override { return fit_.gradient(v); }
  void coded_height(std::uint32_t, double) override {}
  void coded_gradient(std::uint32_t, Vec2) override {}

 private:
  const HeldFit& fit_;
};

}  // namespace retalho
