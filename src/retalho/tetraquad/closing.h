// A rough surface that is closed, to follow where the points have holes. Internal to the room.
#pragma once

#include <memory>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// At the bottom the fit on all cubes of a coarse grid round the points' box, held outside (positive) on the grid's
/// border: its zero set cannot leave it. Finer closed fits are laid over it, each where its tetrahedra are.
class ClosedGuide {
 public:
  /// Cost: about a second.
  ClosedGuide(const PointCloud& cloud, const TetraQuadFitOptions& options, const Context& context);
  void add(TetraQuad finer);

  /// Gives the marked vertices the quasi-interpolant of the finest fit that reaches them.
  void fill(TetraQuad& surface, const std::vector<char>& marked) const;
  /// The box of the coarse grid: no surface is followed out of it.
  bool holds(Vec3 p) const;

 private:
  struct Level {
    std::unique_ptr<const TetraQuad> surface;
    std::unique_ptr<const TetraQuadField> field;
  };
  std::vector<Level> levels_;  ///< the finest last
};

/// A guide for a fit of `options`: closed fits of half the resolution, a quarter ... down to where all cubes are taken.
ClosedGuide make_guide(const PointCloud& cloud, const TetraQuadFitOptions& options, const Context& context);

}  // namespace retalho
