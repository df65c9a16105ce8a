#include "retalho/level/line_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/level/piece_pairs.h"

namespace retalho {
namespace {

/// A line's vertices without repetitions, and the directions in which curves pass through them.
struct Spine {
  std::vector<Vec2> points;   ///< a closed line's first one again at the end
  std::vector<Vec2> in, out;  ///< unit tangents before and behind each point; equal where the line is smooth
  std::vector<std::uint8_t> corner;
  bool closed = false;
};

/// A piece between two vertices of its spine.
struct Span {
  std::uint32_t from, to;
  std::uint8_t stage;  ///< 0: the whole tolerance; kStraight: the traced side
  Cubic cubic;
};

constexpr std::uint8_t kStraight = 6;  // after tolerance / 4^5: two lines may run far closer than the tolerance
constexpr std::size_t kMostVertices = 256;

Vec2 unit(Vec2 d) {
  const double length = norm(d);
  return length > 0 ? d / length : Vec2{};
}

/// `tangent`'s mirror image in the direction `chord`: the other end's tangent on a circle.
Vec2 mirrored(Vec2 tangent, Vec2 chord) {
  const Vec2 e = unit(chord);
  return 2 * dot(tangent, e) * e - tangent;
}

class SpineMaker {
 public:
  SpineMaker(Spine& spine, const CurveOptions& options) : s_(spine), options_(options) {}

  void make() {
    const std::size_t n = s_.points.size();
    s_.in.assign(n, {});
    s_.out.assign(n, {});
    s_.corner.assign(n, 0);
    for (std::size_t i = 0; i < n; ++i) s_.corner[i] = is_corner(i) ? 1 : 0;
    for (std::size_t i = 0; i < n; ++i)
      if (s_.corner[i] == 0) s_.in[i] = s_.out[i] = tangent(i);
    for (std::size_t i = 0; i < n; ++i) {
      if (s_.corner[i] == 0) continue;
      if (const std::size_t k = neighbour(i, 1); k != i)
        s_.out[i] = one_sided(k, s_.points[k] - s_.points[i], s_.in[k]);
      if (const std::size_t k = neighbour(i, -1); k != i)
        s_.in[i] = one_sided(k, s_.points[i] - s_.points[k], s_.out[k]);
    }
  }

 private:
  /// The next vertex that is far enough away for a direction to mean something; i itself at an open end.
  std::size_t neighbour(std::size_t i, int step) const {
    const std::size_t n = s_.points.size();
    const double least = 0.02 * options_.tolerance;
    std::size_t k = i;
    for (std::size_t tried = 0; tried < n; ++tried) {
      if (step > 0 && k + 1 == n) {
        if (!s_.closed) break;
        k = 0;
      }
      if (step < 0 && k == 0) {
        if (!s_.closed) break;
        k = n - 1;
      }
      k = step > 0 ? k + 1 : k - 1;
      if (norm(s_.points[k] - s_.points[i]) >= least) break;
    }
    return k;
  }

  /// A line turns here more than a smooth one could whose sides are this long and this close to it: an arc of length c
  /// that turns by an angle leaves its chord by an eighth of their product.
  bool is_corner(std::size_t i) const {
    const std::size_t before = neighbour(i, -1), after = neighbour(i, 1);
    if (before == i || after == i) return true;
    const Vec2 a = s_.points[i] - s_.points[before], b = s_.points[after] - s_.points[i];
    const double angle = std::abs(std::atan2(cross(a, b), dot(a, b)));
    return angle > 2.4 || (angle > 0.1 && angle * std::min(norm(a), norm(b)) > 12 * options_.traced);
  }

  /// Of the circle through the vertex and its neighbours.
  Vec2 tangent(std::size_t i) const {
    const Vec2 a = s_.points[i] - s_.points[neighbour(i, -1)], b = s_.points[neighbour(i, 1)] - s_.points[i];
    return unit(norm2(b) * a + norm2(a) * b);
  }

  /// At the corner end of `chord`, whose other end k has the tangent `there`.
  Vec2 one_sided(std::size_t k, Vec2 chord, Vec2 there) const {
    if (s_.corner[k] != 0) return unit(chord);
    const Vec2 d = mirrored(there, chord);
    return dot(d, chord) > 0 ? d : unit(chord);
  }

  Spine& s_;
  const CurveOptions& options_;
};

Spine make_spine(const ContourSet& set, const ContourLine& line, const CurveOptions& options) {
  Spine spine;
  spine.closed = line.closed;
  for (std::size_t i = line.begin; i < line.end; ++i)
    if (spine.points.empty() || !(spine.points.back() == set.points[i])) spine.points.push_back(set.points[i]);
  if (spine.closed) {
    while (spine.points.size() > 1 && spine.points.back() == spine.points.front()) spine.points.pop_back();
    if (spine.points.size() >= 3)
      spine.points.push_back(spine.points.front());
    else
      spine.points.clear();
  }
  if (spine.points.size() < 2) spine.points.clear();
  if (!spine.points.empty()) SpineMaker(spine, options).make();
  return spine;
}

/// Curves from vertex `from` to `to`, as long as they may be; straight sides where none fits.
void fit_spans(const Spine& spine, std::size_t from, std::size_t to, std::uint8_t stage, const CurveOptions& options,
               std::vector<Span>& out) {
  const auto add_straight = [&](std::size_t i) {
    out.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + 1), kStraight,
                   straight_cubic(spine.points[i], spine.points[i + 1])});
  };
  if (stage == kStraight) {
    for (std::size_t i = from; i < to; ++i) add_straight(i);
    return;
  }
  const CubicFit fit{options.tolerance / std::pow(4.0, stage), options.per_unit};
  // At least three pieces a loop, so that no piece meets another at both ends.
  const std::size_t most = std::min(
      kMostVertices, spine.closed ? std::max<std::size_t>(1, (spine.points.size() - 1) / 3) : spine.points.size());
  Cubic cubic, good_cubic;
  for (std::size_t i = from; i < to;) {
    std::size_t end = std::min(to, i + most);
    for (std::size_t k = i + 1; k < end; ++k)
      if (spine.corner[k] != 0) end = k;
    const auto fits = [&](std::size_t k) {
      return fit_cubic({spine.points.data() + i, k - i + 1}, spine.out[i], spine.in[k], fit, cubic);
    };
    std::size_t good = i, bad = end + 1;
    for (std::size_t stride = 1; good < end; stride *= 2) {
      const std::size_t next = std::min(i + stride, end);
      if (!fits(next)) {
        bad = next;
        break;
      }
      good = next;
      good_cubic = cubic;
    }
    while (bad <= end && bad - good > 1) {
      const std::size_t middle = good + (bad - good) / 2;
      if (fits(middle)) {
        good = middle;
        good_cubic = cubic;
      } else {
        bad = middle;
      }
    }
    if (good == i) {
      add_straight(i++);
      continue;
    }
    out.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(good), stage, good_cubic});
    i = good;
  }
}

/// All lines' spans in a row, as the search for pairs wants them.
std::vector<PairItem> items_of(const std::vector<std::vector<Span>>& spans, const std::vector<Spine>& spines,
                               const std::vector<std::vector<std::uint8_t>>& fresh) {
  std::vector<PairItem> items;
  for (std::size_t line = 0; line < spans.size(); ++line) {
    const std::size_t n = spans[line].size(), first = items.size();
    for (std::size_t k = 0; k < n; ++k) {
      const bool last = k + 1 == n;
      items.push_back({&spans[line][k].cubic,
                       !last                 ? first + k + 1
                       : spines[line].closed ? first
                                             : PairItem::kNoNext,
                       fresh[line][k] != 0});
    }
  }
  return items;
}

/// Replaces the marked spans by closer ones; says whether any was. `marks` becomes what is new.
bool refine(const std::vector<Spine>& spines, const CurveOptions& options, std::vector<std::vector<Span>>& spans,
            std::vector<std::vector<std::uint8_t>>& marks) {
  bool changed = false;
  for (std::size_t line = 0; line < spans.size(); ++line) {
    if (std::none_of(marks[line].begin(), marks[line].end(), [](std::uint8_t m) { return m != 0; })) continue;
    std::vector<Span> next;
    std::vector<std::uint8_t> fresh;
    for (std::size_t k = 0; k < spans[line].size(); ++k) {
      const Span& span = spans[line][k];
      const bool closer = marks[line][k] != 0 && span.stage != kStraight;
      if (closer)
        fit_spans(spines[line], span.from, span.to, static_cast<std::uint8_t>(span.stage + 1), options, next);
      else
        next.push_back(span);
      fresh.resize(next.size(), closer ? 1 : 0);
      changed = changed || closer;
    }
    spans[line] = std::move(next);
    marks[line] = std::move(fresh);
  }
  return changed;
}

void check(const CurveOptions& options) {
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance) || !(options.traced > 0))
    throw BadInput(fmt::format("the tolerance of curves must be a positive number, not {}", options.tolerance));
}

}  // namespace

CurveSet fit_line_curves(const ContourSet& lines, const CurveOptions& options, const Context& context) {
  check(options);
  const std::size_t n = lines.lines.size();
  std::vector<Spine> spines(n);
  std::vector<std::vector<Span>> spans(n);
  parallel_chunks(n, 16, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      spines[i] = make_spine(lines, lines.lines[i], options);
      if (!spines[i].points.empty()) fit_spans(spines[i], 0, spines[i].points.size() - 1, 0, options, spans[i]);
    }
  });
  std::vector<std::vector<std::uint8_t>> marks(n);
  for (std::size_t i = 0; i < n; ++i) marks[i].assign(spans[i].size(), 1);
  CurveSet set;
  for (;;) {
    context.check();
    const std::vector<PairItem> items = items_of(spans, spines, marks);
    const auto pairs = touching_pairs(items, context);
    for (auto& line : marks) std::fill(line.begin(), line.end(), std::uint8_t{0});
    std::vector<std::pair<std::size_t, std::size_t>> places;  // of each item: line, and span of the line
    places.reserve(items.size());
    for (std::size_t line = 0; line < n; ++line)
      for (std::size_t k = 0; k < spans[line].size(); ++k) places.emplace_back(line, k);
    for (const auto& [a, b] : pairs) {
      bool straight = true;
      for (const auto& [line, k] : {places[a], places[b]}) {
        marks[line][k] = 1;
        straight = straight && spans[line][k].stage == kStraight;
      }
      // Such a pair comes up once, in the round in which the later of them was new.
      if (straight) ++set.unproved;
    }
    if (!refine(spines, options, spans, marks)) break;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (spans[i].empty()) continue;
    set.lines.push_back({lines.lines[i].level, lines.lines[i].closed, set.pieces.size(), 0});
    for (const Span& span : spans[i]) {
      const bool straight = span.stage == kStraight;
      set.straight += straight ? 1 : 0;
      set.corners += (span.from != 0 || spines[i].closed) && spines[i].corner[span.from] != 0 ? 1 : 0;
      set.pieces.push_back({span.cubic, straight});
    }
    set.lines.back().end = set.pieces.size();
  }
  return set;
}

}  // namespace retalho
