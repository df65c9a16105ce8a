#include "retalho/visibility/surface_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace retalho::visibility_detail {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTouch = 1e-11;  // of the heights' size
constexpr int kHalvings = 40;     // ordinates fall by a fourth each: they never get there

double cubic_blossom(const Cubic& c, double u, double v, double w) {
  const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
  const double p = mix(c[0], c[1], u), q = mix(c[1], c[2], u), r = mix(c[2], c[3], u);
  return mix(mix(p, q, v), mix(q, r, v), w);
}

}  // namespace

Cubic cubic_part(const Cubic& c, double u, double v) {
  if (u == 0 && v == 1) return c;
  return {cubic_blossom(c, u, u, u), cubic_blossom(c, u, u, v), cubic_blossom(c, u, v, v), cubic_blossom(c, v, v, v)};
}

SurfaceSight::SurfaceSight(const SegmentWalk& walk, Vec2 from, double eye, double drop, VoidRule voids)
    : walk_(&walk),
      from_(from),
      eye_(eye),
      drop_(drop),
      voids_(voids),
      masked_(!walk.evaluator().terrain().grid.valid.empty()),
      start_(walk.around(from)) {
  double size = std::abs(eye);
  for (const double z : walk.evaluator().terrain().tin.heights) size = std::max(size, std::abs(z));
  touch_ = kTouch * size;
}

SurfaceSight::Part SurfaceSight::part_of(const SegmentPiece& piece, double length2) const {
  Part part{piece.begin, piece.end, piece.ordinates};
  for (double& c : part.over_eye) c -= eye_;
  if (drop_ != 0) {
    const double k = drop_ * length2, a = piece.begin, b = piece.end;
    part.over_eye[0] -= k * a * a;
    part.over_eye[1] -= k * (a * a + 2 * a * b) / 3;
    part.over_eye[2] -= k * (2 * a * b + b * b) / 3;
    part.over_eye[3] -= k * b * b;
  }
  return part;
}

void SurfaceSight::cell_borders(Vec2 to, double begin, double end, std::vector<double>& cuts) const {
  const GridDomain& grid = walk_->evaluator().terrain().grid;
  cuts.assign({begin, end});
  const auto along = [&](double from, double step, double cell) {
    if (step == 0) return;
    const double a = (from + begin * step) / cell, b = (from + end * step) / cell;
    for (double k = std::ceil(std::min(a, b) - 0.5) + 0.5; k < std::max(a, b); ++k) {
      const double t = (k * cell - from) / step;
      if (t > begin && t < end) cuts.push_back(t);
    }
  };
  along(from_.x, to.x - from_.x, grid.cell_width);
  along(from_.y, to.y - from_.y, grid.cell_height);
  std::sort(cuts.begin(), cuts.end());
}

bool SurfaceSight::meets_void(Vec2 to) const {
  std::vector<double> cuts;
  cell_borders(to, 0, 1, cuts);
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k)
    if (cuts[k + 1] > cuts[k] &&
        !walk_->evaluator().terrain().grid.has_data(from_ + 0.5 * (cuts[k] + cuts[k + 1]) * (to - from_)))
      return true;
  return false;
}

bool SurfaceSight::under(const Part& part, double slope) const {
  for (std::size_t i = 0; i < 4; ++i) {
    const double t = part.begin + (part.end - part.begin) * static_cast<double>(i) / 3;
    if (part.over_eye[i] - slope * t > touch_) return false;
  }
  return true;
}

bool SurfaceSight::raise_on(const Part& part, double& slope, double stop, int depth) const {
  if (under(part, slope)) return true;
  if (part.begin == 0 && part.over_eye[0] > touch_) {  // the eye itself is under the surface
    slope = kInfinite;
    return false;
  }
  if (part.over_eye[3] - slope * part.end > touch_) slope = part.over_eye[3] / part.end;
  if (part.begin > 0 && part.over_eye[0] - slope * part.begin > touch_) slope = part.over_eye[0] / part.begin;
  if (slope > stop) return false;
  if (depth == 0 || under(part, slope)) return true;
  const double middle = 0.5 * (part.begin + part.end);
  return raise_on({part.begin, middle, cubic_part(part.over_eye, 0, 0.5)}, slope, stop, depth - 1) &&
         raise_on({middle, part.end, cubic_part(part.over_eye, 0.5, 1)}, slope, stop, depth - 1);
}

bool SurfaceSight::raise_with_data(const Part& part, Vec2 to, double& slope, double stop) const {
  if (under(part, slope)) return true;
  if (!masked_) return raise_on(part, slope, stop, kHalvings);
  std::vector<double> cuts;  // only for the few pieces near the line, of models with voids
  cell_borders(to, part.begin, part.end, cuts);
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double middle = 0.5 * (cuts[k] + cuts[k + 1]), size = part.end - part.begin;
    if (!(cuts[k + 1] > cuts[k]) || !walk_->evaluator().terrain().grid.has_data(from_ + middle * (to - from_)))
      continue;
    const Cubic c = cubic_part(part.over_eye, (cuts[k] - part.begin) / size, (cuts[k + 1] - part.begin) / size);
    if (!raise_on({cuts[k], cuts[k + 1], c}, slope, stop, kHalvings)) return false;
  }
  return true;
}

double SurfaceSight::raise(Vec2 to, double slope, double stop) const {
  if (masked_ && voids_ == VoidRule::blocks && meets_void(to)) return kInfinite;
  std::array<SegmentPiece, 6> found;
  const double length2 = dot(to - from_, to - from_);
  walk_->triangles(start_, from_, to, [&](std::uint32_t triangle, double begin, double end) {
    // The line is over the triangle's highest ordinate: most triangles end here.
    const double line = eye_ + std::min(slope * begin, slope * end) + drop_ * length2 * begin * begin;
    if (walk_->highest(triangle) <= line && begin > 0) return true;
    const int n = walk_->pieces(triangle, from_, to, begin, end, found);
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i)
      if (!raise_with_data(part_of(found[i], length2), to, slope, stop)) return false;
    return true;
  });
  return slope;
}

}  // namespace retalho::visibility_detail
