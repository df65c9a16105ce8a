#include "retalho/terrain/segment_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "retalho/core/parallel.h"
#include "retalho/tin/predicates.h"

namespace retalho {
namespace {

/// The polynomial's blossom at three points: de Casteljau with a point a step.
template <int Degree>
double blossom(const std::array<double, 10>& ordinates, const std::array<Barycentric, 3>& at) {
  TriangleNet<Degree> net;
  std::copy_n(ordinates.begin(), net.size(), net.begin());
  if constexpr (Degree == 1)
    return evaluate<1>(net, at[0]);
  else if constexpr (Degree == 2)
    return evaluate<1>(casteljau_step<2>(net, at[0]), at[1]);
  else
    return evaluate<1>(casteljau_step<2>(casteljau_step<3>(net, at[0]), at[1]), at[2]);
}

/// The ordinates of the patch on the segment from a to b, raised to degree 3.
std::array<double, 4> on_segment(const TerrainPatch& patch, Barycentric a, Barycentric b) {
  if (patch.degree == 3)
    return {blossom<3>(patch.ordinates, {a, a, a}), blossom<3>(patch.ordinates, {a, a, b}),
            blossom<3>(patch.ordinates, {a, b, b}), blossom<3>(patch.ordinates, {b, b, b})};
  if (patch.degree == 2) {
    const double p = blossom<2>(patch.ordinates, {a, a, a}), q = blossom<2>(patch.ordinates, {a, b, b}),
                 r = blossom<2>(patch.ordinates, {b, b, b});
    return {p, (p + 2 * q) / 3, (2 * q + r) / 3, r};
  }
  const double p = blossom<1>(patch.ordinates, {a, a, a}), r = blossom<1>(patch.ordinates, {b, b, b});
  return {p, (2 * p + r) / 3, (p + 2 * r) / 3, r};
}

Barycentric blend(Barycentric a, Barycentric b, double t) {
  return {a.r + t * (b.r - a.r), a.s + t * (b.s - a.s), a.t + t * (b.t - a.t)};
}

}  // namespace

SegmentWalk::SegmentWalk(const TerrainEvaluator& evaluator, const Context& context)
    : evaluator_(&evaluator), highest_(evaluator.terrain().tin.triangle_count()) {
  const Terrain& terrain = evaluator.terrain();
  parallel_chunks(highest_.size(), 4096, context, [&](std::size_t from, std::size_t to) {
    std::array<TerrainPatch, 6> patches;
    for (std::size_t t = from; t < to; ++t) {
      const int n = triangle_patches(terrain, evaluator.edges(), static_cast<std::uint32_t>(t), patches);
      double high = -std::numeric_limits<double>::infinity();
      for (int i = 0; i < n; ++i) {
        const TerrainPatch& p = patches[static_cast<std::size_t>(i)];
        high = std::max(high, *std::max_element(p.ordinates.begin(), p.ordinates.begin() + ordinate_count(p.degree)));
      }
      highest_[t] = high;
    }
  });
}

Vec2 SegmentWalk::corner(std::uint32_t triangle, int k) const {
  const Tin& tin = evaluator_->terrain().tin;
  return tin.points[tin.triangles[triangle][static_cast<std::size_t>(k % 3)]];
}

std::vector<std::uint32_t> SegmentWalk::around(Vec2 from) const {
  std::vector<std::uint32_t> found;
  const std::uint32_t first = evaluator_->locate(from);
  if (first == kNone) return found;
  found.push_back(first);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t next = evaluator_->terrain().tin.neighbors[found[i]][static_cast<std::size_t>(k)];
      if (next == kNone || std::find(found.begin(), found.end(), next) != found.end()) continue;
      bool holds = true;
      for (int e = 0; e < 3; ++e) holds = holds && orientation(corner(next, e), corner(next, e + 1), from) >= 0;
      if (holds) found.push_back(next);
    }
  return found;
}

int SegmentWalk::exit_edge(std::uint32_t triangle, Vec2 from, Vec2 to, int aside) const {
  std::array<bool, 3> left{};
  for (int k = 0; k < 3; ++k) {
    const int side = orientation(from, to, corner(triangle, k));
    left[static_cast<std::size_t>(k)] = (side == 0 ? aside : side) > 0;
  }
  for (std::size_t k = 0; k < 3; ++k)
    if (!left[k] && left[(k + 1) % 3]) return static_cast<int>(k);
  return -1;
}

double SegmentWalk::crossing(std::uint32_t triangle, int edge, Vec2 from, Vec2 to) const {
  const Vec2 a = corner(triangle, edge), b = corner(triangle, edge + 1);
  const double before = cross(b - a, from - a), after = cross(b - a, to - a);
  return before == after ? 0 : before / (before - after);
}

bool SegmentWalk::ends_before(std::uint32_t triangle, int edge, Vec2 to) const {
  return orientation(corner(triangle, edge), corner(triangle, edge + 1), to) >= 0;
}

int SegmentWalk::pieces(std::uint32_t triangle, Vec2 from, Vec2 to, double begin, double end,
                        std::array<SegmentPiece, 6>& out) const {
  std::array<TerrainPatch, 6> patches;
  const int n = triangle_patches(evaluator_->terrain(), evaluator_->edges(), triangle, patches);
  const Vec2 p = from + begin * (to - from), q = from + end * (to - from);
  int count = 0;
  for (int i = 0; i < n; ++i) {
    const TerrainPatch& patch = patches[static_cast<std::size_t>(i)];
    const TriangleFrame frame(patch.corners[0], patch.corners[1], patch.corners[2]);
    if (!(frame.area2 > 0)) continue;
    const Barycentric a = frame.barycentric(p), b = frame.barycentric(q);
    double low = 0, high = 1;
    if (n > 1) {
      for (const auto& [u, v] : {std::pair{a.r, b.r}, std::pair{a.s, b.s}, std::pair{a.t, b.t}}) {
        if (u < 0 && v < 0) high = -1;
        if (u < 0 && v >= 0) low = std::max(low, u / (u - v));
        if (u >= 0 && v < 0) high = std::min(high, u / (u - v));
      }
    }
    if (!(high > low)) continue;
    SegmentPiece& piece = out[static_cast<std::size_t>(count++)];
    piece.begin = begin + low * (end - begin);
    piece.end = high == 1 ? end : begin + high * (end - begin);
    piece.ordinates = on_segment(patch, blend(a, b, low), blend(a, b, high));
  }
  std::sort(out.begin(), out.begin() + count,
            [](const SegmentPiece& x, const SegmentPiece& y) { return x.begin < y.begin; });
  // Ends that differ by rounding alone are the same place.
  const double rounding = 1e-12 * (end - begin);
  double reached = begin;
  for (int i = 0; i < count; ++i) {
    SegmentPiece& piece = out[static_cast<std::size_t>(i)];
    if (std::abs(piece.begin - reached) < rounding) piece.begin = reached;
    reached = piece.end;
  }
  return count;
}

}  // namespace retalho
