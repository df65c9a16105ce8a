// Internal to level/: the lines of all levels inside one polynomial patch, given the roots on its sides
// (docs/contours.md, "Tracing"). One algorithm for every kind of patch; `Patch` says how a kind is cut and bounded.
//
// A box is certified when the polynomial grows along one direction everywhere in it: then its level sets are graphs
// that end on the boundary, and two roots are one arc. Whatever is not certified is cut in four; a child takes over its
// parent's roots and finds new ones on the new edges only, so neighbours agree by construction.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "retalho/core/variants.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/frame.h"
#include "retalho/level/lanes.h"
#include "retalho/level/patch_parts.h"
#include "retalho/level/trace.h"

namespace retalho {

/// A direction along which the polynomial grows in the whole box.
struct Certificate {
  Vec2 d;        ///< in parameters; its image has length one
  double m = 0;  ///< growth along it, at least; an ordinate's unit a local unit
};

/// Nothing when none of the directions tried will do. Decided conservatively in doubles of exact integers.
template <class Patch, class I>
[[gnu::always_inline]] inline bool certify(const typename Patch::template Net<I>& net, const Frame& frame,
                                           Certificate& certificate) {
  typename Patch::Slopes du, dv;
  Patch::template gradients<I>(net, du, dv);
  const auto test = [&](Vec2 d) __attribute__((always_inline)) {
    const auto [low, high, size] = range_of_sums(d.x, du, d.y, dv);
    if (!(low > 4e-15 * size)) return false;
    certificate = {d, Patch::kDegree * (low - 4e-15 * size)};
    return true;
  };
  Vec2 sum;
  for (std::size_t i = 0; i < Patch::kGradients; ++i) sum = sum + Vec2{du[i], dv[i]};
  const Vec2 d = frame.uphill(sum);
  if ((d.x != 0 || d.y != 0) && test(d)) return true;
  const Vec2 along_u = Vec2{std::copysign(1 / norm(frame.e1), sum.x), 0};
  const Vec2 along_v = Vec2{0, std::copysign(1 / norm(frame.e2), sum.y)};
  return test(along_u) || test(along_v);
}

template <class Patch>
class BoxTracer {
 public:
  /// `tolerance` in local units. Heights in nets are doubled quanta. `mirrored`: the patches' frames turn clockwise.
  BoxTracer(const FixedLevels& levels, double tolerance, bool mirrored, Trace& trace)
      : levels_(levels), tolerance_(tolerance), mirrored_(mirrored), trace_(trace) {}

  /// Traces a patch whose sides have these roots.
  RETALHO_TWO_VARIANTS void trace_patch(typename Patch::template Net<double> net, const Frame& frame,
                                        const std::array<std::span<const EdgeRoot>, Patch::kSides>& sides,
                                        const std::array<bool, Patch::kSides>& reversed) {
    pool_.clear();
    std::array<Side, Patch::kSides> own{};
    for (std::size_t s = 0; s < Patch::kSides; ++s) {
      own[s] = {static_cast<std::uint32_t>(pool_.size()), 0, reversed[s]};
      pool_.insert(pool_.end(), sides[s].begin(), sides[s].end());
      own[s].end = static_cast<std::uint32_t>(pool_.size());
    }
    // Counted from the middle of the patch's own range, ordinates have few bits, and more halvings fit into a double.
    double low = 0, high = 0;
    range_of(net, low, high);
    const double middle = 2 * std::floor(0.25 * (low + high)), reach = std::max(high - middle, middle - low);
    base_ = static_cast<std::int64_t>(middle);
    for (double& b : net) b -= middle;
    const Box<double> box{net, frame, 0, 1, 1, reach > 0 ? std::ilogb(reach) + 1 : 1};
    trace_.pairs += visit(box, low - middle, high - middle, 0, levels_.count(), own);
  }

 private:
  template <class I>
  struct Box {
    typename Patch::template Net<I> net;
    Frame frame;
    int depth;
    I scale;  ///< ordinates are doubled quanta over base_ times this
    double per_scale;
    int bits;  ///< of the largest ordinate
  };
  /// A list in the pool; reversed: it runs against the side's own direction.
  struct Side {
    std::uint32_t begin, end;
    bool reversed;
  };
  using Sides = std::array<Side, Patch::kSides>;

  template <class I>
  [[gnu::always_inline]] void visit(const Box<I>& box, int from, int to, const Sides& sides) {
    I low{}, high{};
    range_of(box.net, low, high);
    visit(box, low, high, from, to, sides);
  }
  /// Traces a box whose ordinates have this range; returns how many levels cross it.
  template <class I>
  RETALHO_TWO_VARIANTS std::size_t visit(const Box<I>& box, I low, I high, int from, int to, const Sides& sides) {
    ++trace_.boxes;
    trace_.depth = std::max(trace_.depth, box.depth);
    narrow<I>(low, high, box.scale, box.per_scale, from, to);
    if (from >= to) return 0;
    const auto pairs = static_cast<std::size_t>(to - from);
    Certificate certificate;
    if (!certify<Patch, I>(box.net, box.frame, certificate)) {
      if (box.depth >= kBoxDepth)
        for (int k = from; k < to; ++k) pair_up(box, k, sides);
      else
        split(box, from, to, sides);
      return pairs;
    }
    if (box.depth == 0) trace_.certified += pairs;
    second_known_ = false;
    for (int k = from; k < to; ++k) {
      collect(sides, k);
      if (found_.empty()) continue;
      if (found_.size() > 2) {
        if (box.depth >= kBoxDepth)
          pair_up(box, k, sides);
        else
          split(box, k, k + 1, sides);
        second_known_ = false;
        continue;
      }
      if (!arc(box, k, certificate)) {
        split(box, k, k + 1, sides);
        second_known_ = false;
      }
    }
    return pairs;
  }

  template <class I>
  I threshold(int level, I scale) const {
    return levels_.scaled<I>(level, scale, base_);
  }
  /// Leaves the levels of [from, to) that may cross ordinates from low to high. All of them cross the parent's, so
  /// that their thresholds have no more bits than its ordinates.
  template <class I>
  void narrow(I low, I high, I scale, double per_scale, int& from, int& to) const {
    const int first = levels_.at_most_between<I>(low, static_cast<double>(low) * per_scale, scale, base_, from, to);
    to = levels_.at_most_between<I>(high, static_cast<double>(high) * per_scale, scale, base_, first, to);
    from = first;
  }

  /// The roots of one level around the box, counter-clockwise in parameters, into found_; found_side_ says where.
  void collect(const Sides& sides, int level) {
    found_.clear();
    found_side_.clear();
    for (std::size_t s = 0; s < Patch::kSides; ++s) {
      const auto [first, last] = group(sides[s], level);
      const bool against = sides[s].reversed != Patch::kAgainst[s];
      for (std::uint32_t i = first; i < last; ++i) {
        found_.push_back(pool_[against ? last - 1 - (i - first) : i].point);
        found_side_.push_back(static_cast<int>(s));
      }
    }
  }
  std::pair<std::uint32_t, std::uint32_t> group(const Side& side, int level) const {
    std::uint32_t first = side.begin;
    while (first < side.end && pool_[first].level < level) ++first;
    std::uint32_t last = first;
    while (last < side.end && pool_[last].level == level) ++last;
    return {first, last};
  }

  /// Joins start to end, which stand in counter-clockwise order in parameters with high ground to the left.
  void link(std::uint32_t start, std::uint32_t end) { trace_.next[start] = end; }

  /// An undecided box: neighbouring roots are joined so that high ground holds together, and the place is reported.
  template <class I>
  void pair_up(const Box<I>& box, int level, const Sides& sides) {
    collect(sides, level);
    SingularPlace place{level, box.frame.origin, box.frame.origin};
    for (int i = 1; i < 4; ++i) {
      const Vec2 p = box.frame.place({static_cast<double>(i & 1), static_cast<double>(i >> 1)});
      place.low = {std::min(place.low.x, p.x), std::min(place.low.y, p.y)};
      place.high = {std::max(place.high.x, p.x), std::max(place.high.y, p.y)};
    }
    trace_.singular.push_back(place);
    const std::size_t n = found_.size();
    const std::size_t shift = first_above(box, level) ? 0 : 1;
    for (std::size_t i = 0; i < n; i += 2) {
      const std::uint32_t a = found_[(i + shift) % n], b = found_[(i + shift + 1) % n];
      mirrored_ ? link(b, a) : link(a, b);
    }
  }
  /// Is the corner where the walk around the box starts above the level?
  template <class I>
  bool first_above(const Box<I>& box, int level) const {
    return box.net[0] >= threshold<I>(level, box.scale);
  }

  /// The arc between the two roots in found_, cut until every chord is within the tolerance. False: halve the box
  /// first.
  template <class I>
  RETALHO_TWO_VARIANTS bool arc(const Box<I>& box, int level, const Certificate& certificate) {
    const bool forward = first_above(box, level) != mirrored_;
    const std::uint32_t start = found_[forward ? 0 : 1], end = found_[forward ? 1 : 0];
    if constexpr (Patch::kDegree == 1) {
      link(start, end);
      return true;
    } else {
      if (!second_known_) {
        second_ = Patch::template second<I>(box.net);
        for (std::size_t i = 0; i < net_.size(); ++i) net_[i] = static_cast<double>(box.net[i]);
        second_known_ = true;
      }
      const Vec2 p = Patch::clamp(box.frame.parameters(trace_.points[start]));
      const Vec2 q = Patch::clamp(box.frame.parameters(trace_.points[end]));
      Work w{level, static_cast<double>(threshold<I>(level, box.scale)),
             2 * levels_.tube(level) * static_cast<double>(box.scale), certificate, start};
      if constexpr (Patch::kDegree == 2)
        if (trace_.keep_conics) {
          conic(box.frame, w, p, q, 24);
          trace_.next[w.last] = end;
          return true;
        }
      const double need = second_.chord_bound(q - p);
      // Both ends on one side: the chord would lie on that side, perhaps on the neighbour's chord.
      if (found_side_[0] == found_side_[1]) w.tube = std::min(w.tube, 0.5 * need);
      const double allowed = std::min(tolerance_ * certificate.m, w.tube);
      if (need > 256 * allowed && box.depth < kBoxDepth) return false;
      if (need > allowed) refine(box.frame, w, p, q, 24);
      trace_.next[w.last] = end;
      return true;
    }
  }

  struct Work {
    int level;
    double threshold, tube;
    Certificate certificate;
    std::uint32_t last;
  };

  /// A lower bound of the growth along d between a chord and its arc, from the gradient in the middle.
  [[gnu::always_inline]] double local_growth(const Certificate& c, Vec2 p, Vec2 q, double bound) const {
    double f = 0;
    Vec2 derivatives;
    Patch::evaluate(net_, 0.5 * (p + q), f, derivatives);
    const auto largest = [](double a, const std::array<double, 2>& x, double b, const std::array<double, 2>& y) {
      const double low = std::min(a * x[0], a * x[1]) + std::min(b * y[0], b * y[1]);
      const double high = std::max(a * x[0], a * x[1]) + std::max(b * y[0], b * y[1]);
      return std::max(-low, high);
    };
    const double gu = largest(c.d.x, second_.uu, c.d.y, second_.uv), gv = largest(c.d.x, second_.uv, c.d.y, second_.vv);
    const double base = dot(derivatives, c.d) - gu * 0.5 * std::abs(q.x - p.x) - gv * 0.5 * std::abs(q.y - p.y);
    const double bend = gu * std::abs(c.d.x) + gv * std::abs(c.d.y);
    const double root = base > 0 ? base * base - 4 * bend * bound : -1;
    return std::max(c.m, root >= 0 ? 0.5 * (base + std::sqrt(root)) * (1 - 1e-12) : 0);
  }

  RETALHO_TWO_VARIANTS void refine(const Frame& frame, Work& work, Vec2 p, Vec2 q, int depth) {
    const Certificate& c = work.certificate;
    const double need = second_.chord_bound(q - p);
    const double sure = std::min(tolerance_ * c.m, work.tube);
    if (need <= sure || depth == 0) return;
    const double m = local_growth(c, p, q, need);
    const double allowed = std::min(tolerance_ * m, work.tube);
    if (need <= allowed) return;
    const int pieces = std::clamp(static_cast<int>(std::ceil(0.8 * std::sqrt(need / allowed))), 2, 16);
    Vec2 from = p;
    for (int i = 1; i <= pieces; ++i) {
      const Vec2 to = i == pieces ? q : on_line(work, p + (static_cast<double>(i) / pieces) * (q - p), m);
      if (second_.chord_bound(to - from) > sure) refine(frame, work, from, to, depth - 1);
      if (i < pieces) {
        const std::uint32_t id = trace_.add(frame.place(to), work.level);
        trace_.next[work.last] = id;
        work.last = id;
      }
      from = to;
    }
  }

  /// The arc from p to q as conics, each of which turns by less than 60 degrees. In the triangle of its ends and of the
  /// place where its tangents meet, the polynomial less the level has three ordinates that vanish at the ends; the two
  /// others give the weight (docs/contours.md, "Exact lines").
  void conic(const Frame& frame, Work& work, Vec2 p, Vec2 q, int depth) {
    double f = 0;
    Vec2 at_p, at_q, at_middle;
    Patch::evaluate(net_, p, f, at_p);
    Patch::evaluate(net_, q, f, at_q);
    const Vec2 up_p = frame.gradient(at_p), up_q = frame.gradient(at_q);
    const Vec2 middle = 0.5 * (p + q);
    if (depth > 0 && dot(up_p, up_q) < 0.5 * norm(up_p) * norm(up_q)) {
      const Vec2 between = on_line(work, middle, work.certificate.m);
      conic(frame, work, p, between, depth - 1);
      const std::uint32_t id = trace_.add(frame.place(between), work.level);
      trace_.next[work.last] = id;
      work.last = id;
      conic(frame, work, between, q, depth - 1);
      return;
    }
    Patch::evaluate(net_, middle, f, at_middle);
    const double sag = f - work.threshold;
    const Vec2 chord = frame.place(q) - frame.place(p), up = frame.gradient(at_middle);
    ConicLink& link = trace_.conics[work.last];
    // Where the arc is straight but for rounding, its tangents say nothing: a parabola through its middle.
    link = {frame.place(middle) - 2 * sag / dot(up, up) * up, 1};
    if (!(std::abs(sag) > 1e-7 * norm(up) * norm(chord))) {
      if (!std::isfinite(link.control.x + link.control.y)) link.control = frame.place(middle);
      return;
    }
    const Vec2 along_p{-at_p.y, at_p.x}, along_q{-at_q.y, at_q.x};
    const Vec2 control = p + cross(q - p, along_q) / cross(along_p, along_q) * along_p;
    double at_control = 0;
    Patch::evaluate(net_, control, at_control, at_middle);
    const double square = -sag / (at_control - work.threshold);
    if (square > 0 && std::isfinite(square)) link = {frame.place(control), std::sqrt(square)};
  }

  /// The point of the line on start + s d, sought inside the box only.
  [[gnu::always_inline]] Vec2 on_line(const Work& work, Vec2 start, double growth) const {
    const Vec2 d = work.certificate.d;
    double f = 0;
    Vec2 derivatives;
    Patch::evaluate(net_, start, f, derivatives);
    f -= work.threshold;
    const double reach = std::min(std::abs(f) / growth * (1 + 1e-9), Patch::room(start, f >= 0 ? -1 * d : d));
    double low = f >= 0 ? -reach : 0, high = f >= 0 ? 0 : reach, s = 0, slope = dot(derivatives, d);
    for (int step = 0; step < 50; ++step) {
      double next = s - f / slope;
      if (!(next >= low && next <= high)) next = 0.5 * (low + high);
      const double moved = std::abs(next - s);
      s = next;
      if (moved <= 3e-4 * reach) break;  // what is left is about its square
      Patch::evaluate(net_, start + s * d, f, derivatives);
      f -= work.threshold;
      slope = dot(derivatives, d);
      (f >= 0 ? high : low) = s;
    }
    return Patch::clamp(start + s * d);
  }

  template <class I>
  RETALHO_TWO_VARIANTS void split(const Box<I>& box, int from, int to, const Sides& sides) {
    if constexpr (!std::is_void_v<typename Exact<I>::Wider>) {
      if (box.bits + Patch::kBitsADepth > Exact<I>::kBits) {
        using Wider = typename Exact<I>::Wider;
        Box<Wider> wide{{}, box.frame, box.depth, static_cast<Wider>(box.scale), box.per_scale, box.bits};
        for (std::size_t i = 0; i < box.net.size(); ++i) wide.net[i] = static_cast<Wider>(box.net[i]);
        split(wide, from, to, sides);
        return;
      }
    }
    const std::size_t mark = pool_.size();
    std::array<typename Patch::template Net<I>, 4> nets;
    Patch::template split<I>(box.net, nets);
    const I scale = box.scale * (1 << Patch::kBitsADepth);
    const double per_scale = box.per_scale / (1 << Patch::kBitsADepth);
    const int depth = box.depth + 1, bits = box.bits + Patch::kBitsADepth;
    std::array<Frame, 4> frames;
    for (int c = 0; c < 4; ++c) frames[static_cast<std::size_t>(c)] = Patch::child_frame(box.frame, c);

    std::array<Side, Patch::kInner> inner{};
    for (std::size_t e = 0; e < Patch::kInner; ++e) {
      const auto child = static_cast<std::size_t>(Patch::kInnerSide[e][0]);
      const int side = Patch::kInnerSide[e][1];
      inner[e] = {static_cast<std::uint32_t>(pool_.size()), 0, false};
      find_roots<I>(Patch::template edge<I>(nets[child], side), Patch::ends(frames[child], side), scale, per_scale,
                    depth, bits, from, to);
      inner[e].end = static_cast<std::uint32_t>(pool_.size());
    }
    std::array<std::array<Side, 2>, Patch::kSides> halves{};
    for (std::size_t s = 0; s < Patch::kSides; ++s)
      halves[s] = cut<I>(
          sides[s], Patch::template edge<I>(nets[static_cast<std::size_t>(Patch::kFirstHalf[s])], static_cast<int>(s)),
          scale, depth, bits, from, to);
    for (std::size_t c = 0; c < 4; ++c) {
      Sides own{};
      for (std::size_t s = 0; s < Patch::kSides; ++s) {
        const ChildSide& source = Patch::kChildren[c][s];
        if (source.inner) {
          own[s] = inner[static_cast<std::size_t>(source.index)];
          own[s].reversed = source.reversed;
        } else {
          own[s] = halves[static_cast<std::size_t>(source.index)][static_cast<std::size_t>(source.half)];
        }
      }
      visit(Box<I>{nets[c], frames[c], depth, scale, per_scale, bits}, from, to, own);
    }
    pool_.resize(mark);
  }

  /// Isolates the roots of a new edge and appends them to the pool.
  template <class I>
  void find_roots(const EdgeNet<Patch::kDegree, I>& edge, const std::array<Vec2, 2>& ends, I scale, double per_scale,
                  int depth, int bits, int from, int to) {
    const auto [low, high] = std::minmax_element(edge.begin(), edge.end());
    narrow<I>(*low, *high, scale, per_scale, from, to);
    for (int k = from; k < to; ++k)
      isolate_roots<Patch::kDegree, I>(
          edge, threshold<I>(k, scale), depth, bits,
          [&](double t) {
            pool_.push_back({k, trace_.add(ends[0] + t * (ends[1] - ends[0]), k)});
          },
          [&](double t0, double t1) {
            trace_.leave_undecided(k, ends[0] + t0 * (ends[1] - ends[0]), ends[0] + t1 * (ends[1] - ends[0]));
          });
  }

  /// A side's list as the lists of its halves: the roots of the first half are counted exactly, the first so many are
  /// its own. `edge` is the net of the half that comes first in the side's own direction.
  template <class I>
  std::array<Side, 2> cut(const Side& side, const EdgeNet<Patch::kDegree, I>& edge, I scale, int depth, int bits,
                          int from, int to) {
    first_.clear();
    second_half_.clear();
    std::uint32_t i = side.begin;
    while (i < side.end && pool_[i].level < from) ++i;
    while (i < side.end && pool_[i].level < to) {
      const int k = pool_[i].level;
      std::uint32_t last = i;
      while (last < side.end && pool_[last].level == k) ++last;
      const std::uint32_t n = last - i;
      std::uint32_t count = 0;
      isolate_roots<Patch::kDegree, I>(
          edge, threshold<I>(k, scale), depth, bits, [&](double) { ++count; }, [](double, double) {});
      count = std::min(count, n);
      const std::uint32_t border = side.reversed ? last - count : i + count;
      for (std::uint32_t j = i; j < last; ++j)
        ((j < border) != side.reversed ? first_ : second_half_).push_back(pool_[j]);
      i = last;
    }
    std::array<Side, 2> halves{};
    halves[0] = {static_cast<std::uint32_t>(pool_.size()), 0, side.reversed};
    pool_.insert(pool_.end(), first_.begin(), first_.end());
    halves[0].end = halves[1].begin = static_cast<std::uint32_t>(pool_.size());
    pool_.insert(pool_.end(), second_half_.begin(), second_half_.end());
    halves[1].end = static_cast<std::uint32_t>(pool_.size());
    halves[1].reversed = side.reversed;
    return halves;
  }

  const FixedLevels& levels_;
  double tolerance_;
  bool mirrored_;
  Trace& trace_;
  std::int64_t base_ = 0;       ///< ordinates of the patch in hand are counted from here, in doubled quanta
  std::vector<EdgeRoot> pool_;  ///< the lists of the boxes on the way down, as a stack
  std::vector<EdgeRoot> first_, second_half_;
  std::vector<std::uint32_t> found_;
  std::vector<int> found_side_;
  SecondRanges second_;
  typename Patch::template Net<double> net_{};
  bool second_known_ = false;
};

}  // namespace retalho
