// The three sides of a triangular patch: space curves that meet at three corners.
//
// The parameter triangle is u, v, w >= 0, u + v + w = 1, with corners U (u = 1), V (v = 1) and W (w = 1). Side 0 runs
// from U to V (w = 0), side 1 from V to W (u = 0), side 2 from W to U (v = 0); each over s in [0, 1].
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "retalho/curve/curve.h"
#include "retalho/curve/measure.h"

namespace retalho {

/// How s runs along a side's curve: as its own parameter, or as the length from its start.
enum class SidePlacement { parameter, arc_length };

/// Point and derivatives by s.
struct SideJet {
  Vec3 point, first, second;
};

/// One side over s in [0, 1]. Two sides on the same curve, one of them run backwards (by the flag, or as a curve with
/// its control points in the other order), give the same points to the last bit at node(k, n) and node(n - k, n).
class SideCurve {
 public:
  SideCurve() = default;
  /// Throws BadInput for a curve without segments.
  explicit SideCurve(Curve curve, bool reversed = false, SidePlacement placement = SidePlacement::parameter);

  /// A side that no curve of the house describes exactly, by its point and derivatives for s in [0, 1]. It cannot be
  /// kept in a model file, nor compared with others for crossings; curve() is empty.
  explicit SideCurve(std::function<SideJet(double)> side) : function_(std::move(side)) {}

  SideJet jet(double s) const;
  Vec3 point(double s) const;
  /// The point at s = k / n.
  Vec3 node(std::size_t k, std::size_t n) const;
  Vec3 start() const { return node(0, 1); }
  Vec3 end() const { return node(1, 1); }

  /// The curve that is evaluated, which runs backwards where reversed() says so.
  const Curve& curve() const { return curve_; }
  bool reversed() const { return reversed_; }
  SidePlacement placement() const { return placement_; }

 private:
  SideJet canonical(double s) const;

  Curve curve_;
  bool reversed_ = false;
  SidePlacement placement_ = SidePlacement::parameter;
  std::shared_ptr<const ArcLength> length_;
  std::function<SideJet(double)> function_;
};

using PatchSides = std::array<SideCurve, 3>;

struct SideOptions {
  double snap = 0;        ///< ends that are this near to each other (input units) are joined at their mean
  bool crossings = true;  ///< look for sides that cross; costs a search of all pairs
};

/// Are the sides those of a patch? Ends within 1e-9 of the size are taken as one and joined; farther ones up to
/// `snap`. Throws BadInput: the corner and the gap where two sides do not meet (and which side looks reversed), a side
/// without length, two sides that cross or touch away from their corner, a side that crosses itself.
/// `where` ("patches[0]") starts the messages.
PatchSides join_sides(const PatchSides& sides, const SideOptions& options = {}, const std::string& where = {});

/// The diagonal of the box of all control points: the size that tolerances are relative to.
double size_of(const PatchSides& sides);

/// (u, v) of the point s of a side; u + v is exactly 1 on side 0.
Vec2 side_parameters(int side, double s);
/// d(u, v)/ds of a side.
Vec2 side_direction(int side);
/// s of a point (u, v) of a side.
double side_argument(int side, Vec2 uv);

}  // namespace retalho
