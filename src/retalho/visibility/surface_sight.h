// Internal to visibility/: how high a model's surface reaches over straight lines from one eye.
#pragma once

#include <array>
#include <vector>

#include "retalho/terrain/segment_walk.h"
#include "retalho/visibility/viewshed.h"

namespace retalho::visibility_detail {

/// A cubic on [0, 1] in Bernstein form.
using Cubic = std::array<double, 4>;

/// The part of `c` between u and v.
Cubic cubic_part(const Cubic& c, double u, double v);

/// Slopes are rises over fractions of the way to the target, so that the line to a target at height z has the slope
/// z - eye.
class SurfaceSight {
 public:
  /// `from` must be where the model has data; `eye` is a height, not one above the surface.
  SurfaceSight(const SegmentWalk& walk, Vec2 from, double eye, double drop, VoidRule voids);

  /// What `slope` must be raised to so that the line of that slope to `to` is nowhere under the surface; infinite where
  /// no line is free. Stops early with some slope above `stop`.
  double raise(Vec2 to, double slope, double stop) const;

  /// Calls visit(begin, end, cubic) for each piece between the eye and `to` with data: surface less the drop, over the
  /// eye, as a cubic between those fractions of the way.
  template <class Visit>
  void pieces(Vec2 to, const Visit& visit) const;

  /// Heights that differ by less touch.
  double touch() const { return touch_; }

 private:
  struct Part {
    double begin, end;
    Cubic over_eye;
  };
  Part part_of(const SegmentPiece& piece, double length2) const;
  bool has_mask() const { return masked_; }
  /// Where between two fractions of the way the line passes from cell to cell, both included.
  void cell_borders(Vec2 to, double begin, double end, std::vector<double>& cuts) const;
  bool meets_void(Vec2 to) const;
  /// The same for one part; false once it is above `stop`.
  bool raise_on(const Part& part, double& slope, double stop, int depth) const;
  bool raise_with_data(const Part& part, Vec2 to, double& slope, double stop) const;
  bool under(const Part& part, double slope) const;

  const SegmentWalk* walk_;
  Vec2 from_;
  double eye_, drop_, touch_;
  VoidRule voids_;
  bool masked_;
  std::vector<std::uint32_t> start_;
};

template <class Visit>
void SurfaceSight::pieces(Vec2 to, const Visit& visit) const {
  std::array<SegmentPiece, 6> found;
  std::vector<double> cuts;
  const double length2 = dot(to - from_, to - from_);
  walk_->triangles(start_, from_, to, [&](std::uint32_t triangle, double begin, double end) {
    const int n = walk_->pieces(triangle, from_, to, begin, end, found);
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      const Part part = part_of(found[i], length2);
      cuts.assign({part.begin, part.end});
      if (has_mask()) cell_borders(to, part.begin, part.end, cuts);
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const double middle = 0.5 * (cuts[k] + cuts[k + 1]), size = part.end - part.begin;
        if (!(cuts[k + 1] > cuts[k])) continue;
        if (has_mask() && !walk_->evaluator().terrain().grid.has_data(from_ + middle * (to - from_))) continue;
        visit(cuts[k], cuts[k + 1],
              cubic_part(part.over_eye, (cuts[k] - part.begin) / size, (cuts[k + 1] - part.begin) / size));
      }
    }
    return true;
  });
}

}  // namespace retalho::visibility_detail
