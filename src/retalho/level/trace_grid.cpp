#include "retalho/level/trace_grid.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "retalho/core/parallel.h"
#include "retalho/level/box_tracer.h"
#include "retalho/level/row_ranges.h"

namespace retalho {
namespace {

constexpr int kStripRows = 64;

/// The roots on a row of edges: those of edge c stand at [start[c], start[c + 1]).
struct EdgeRow {
  std::vector<std::uint32_t> start;
  std::vector<EdgeRoot> roots;

  std::span<const EdgeRoot> of(int edge) const {
    const auto c = static_cast<std::size_t>(edge);
    return std::span(roots).subspan(start[c], start[c + 1] - start[c]);
  }
};

struct Strip {
  Trace trace;
  std::vector<EdgeRoot> top, bottom;  ///< the roots on its first and its last row of edges
  std::size_t top_undecided = 0;      ///< of the first row: the strip above reports the same stretches
  std::vector<BorderEdge> border;
};

class StripTracer {
 public:
  StripTracer(const FixedGrid& grid, const FixedLevels& levels, double tolerance, bool keep_border, Strip& strip,
              const Context& context)
      : grid_(grid),
        context_(context),
        levels_(levels),
        keep_border_(keep_border),
        strip_(strip),
        boxes_(levels, tolerance, true, strip.trace),
        low_(static_cast<std::size_t>(grid.columns)),
        high_(low_.size()),
        candidates_(low_.size()),
        marked_(low_.size()) {}

  void run(int first, int last) {
    trace_row(first, above_);
    strip_.top = above_.roots;
    strip_.top_undecided = strip_.trace.undecided_edges;
    for (int row = first; row < last; ++row) {
      trace_row(row + 1, below_);
      trace_columns(row);
      trace_patches(row);
      std::swap(above_, below_);
    }
    strip_.bottom = above_.roots;
  }

 private:
  /// Sets low_ and high_ to the range of the edges' ordinates, node and tangent at both ends.
  void bound_edges(const std::int32_t* z, const std::int32_t* d, std::size_t step, std::size_t n) {
    bound_edge_row(z, d, step, n, low_.data(), high_.data());
  }
  void bound_patches(int row) {
    const std::size_t n = static_cast<std::size_t>(grid_.columns) - 1, o = grid_.node(0, row);
    bound_patch_row(&grid_.z[o], &grid_.u[o], &grid_.v[o], &grid_.t[o], n + 1, n, low_.data(), high_.data());
  }
  /// The places whose range may hold a level, into candidates_; how many.
  std::size_t select(std::size_t n) {
    mark_ranges(low_.data(), high_.data(), n, levels_, marked_.data());
    std::size_t found = 0;
    for (std::size_t c = 0; c < n; ++c) {
      candidates_[found] = static_cast<std::uint32_t>(c);
      found += marked_[c];
    }
    return found;
  }

  void isolate(std::int32_t z0, std::int32_t d0, std::int32_t d1, std::int32_t z1, Vec2 from, Vec2 to,
               std::vector<EdgeRoot>& out) {
    const EdgeNet<3, double> e{2.0 * z0, 2.0 * (z0 + d0), 2.0 * (z1 - d1), 2.0 * z1};
    const auto [low, high] = std::minmax_element(e.begin(), e.end());
    const int first = levels_.at_most(*low), last = levels_.at_most(*high);
    for (int k = first; k < last; ++k)
      isolate_roots<3, double>(
          e, levels_.threshold(k), 0, kOrdinateBits,
          [&](double t) {
            out.push_back({k, strip_.trace.add(from + t * (to - from), k)});
          },
          [&](double t0, double t1) {
            strip_.trace.leave_undecided(k, from + t0 * (to - from), from + t1 * (to - from));
          });
  }

  void trace_row(int row, EdgeRow& edges) {
    const std::size_t n = static_cast<std::size_t>(grid_.columns) - 1, o = grid_.node(0, row);
    edges.roots.clear();
    edges.start.assign(n + 1, 0);
    bound_edges(&grid_.z[o], &grid_.u[o], 1, n);
    const std::size_t found = select(n);
    std::size_t done = 0;
    for (std::size_t i = 0; i < found; ++i) {
      context_.check();  // a patch may hold thousands of lines
      const std::size_t c = candidates_[i];
      while (done <= c) edges.start[done++] = static_cast<std::uint32_t>(edges.roots.size());
      const int column = static_cast<int>(c);
      const bool above = grid_.has_patch(column, row - 1), below = grid_.has_patch(column, row);
      if (!above && !below) continue;
      const std::size_t before = edges.roots.size();
      isolate(grid_.z[o + c], grid_.u[o + c], grid_.u[o + c + 1], grid_.z[o + c + 1], place(column, row),
              place(column + 1, row), edges.roots);
      if (keep_border_ && above != below && edges.roots.size() > before)
        strip_.border.push_back(
            {column, row, true, {edges.roots.begin() + static_cast<std::ptrdiff_t>(before), edges.roots.end()}});
    }
    while (done <= n) edges.start[done++] = static_cast<std::uint32_t>(edges.roots.size());
  }

  void trace_columns(int row) {
    const auto n = static_cast<std::size_t>(grid_.columns);
    const std::size_t o = grid_.node(0, row);
    beside_.roots.clear();
    beside_.start.assign(n + 1, 0);
    bound_edges(&grid_.z[o], &grid_.v[o], n, n);
    const std::size_t found = select(n);
    std::size_t done = 0;
    for (std::size_t i = 0; i < found; ++i) {
      context_.check();  // a patch may hold thousands of lines
      const std::size_t c = candidates_[i];
      while (done <= c) beside_.start[done++] = static_cast<std::uint32_t>(beside_.roots.size());
      const int column = static_cast<int>(c);
      const bool left = grid_.has_patch(column - 1, row), right = grid_.has_patch(column, row);
      if (!left && !right) continue;
      const std::size_t before = beside_.roots.size();
      isolate(grid_.z[o + c], grid_.v[o + c], grid_.v[o + c + n], grid_.z[o + c + n], place(column, row),
              place(column, row + 1), beside_.roots);
      if (keep_border_ && left != right && beside_.roots.size() > before)
        strip_.border.push_back(
            {column, row, false, {beside_.roots.begin() + static_cast<std::ptrdiff_t>(before), beside_.roots.end()}});
    }
    while (done <= n) beside_.start[done++] = static_cast<std::uint32_t>(beside_.roots.size());
  }

  void trace_patches(int row) {
    bound_patches(row);
    const std::size_t found = select(static_cast<std::size_t>(grid_.columns) - 1);
    for (std::size_t i = 0; i < found; ++i) {
      context_.check();  // a patch may hold thousands of lines
      const std::size_t c = candidates_[i];
      const int column = static_cast<int>(c);
      if (!grid_.has_patch(column, row)) continue;
      if (levels_.at_most(2.0 * low_[c]) >= levels_.at_most(2.0 * high_[c])) continue;
      boxes_.trace_patch(grid_.net(column, row), grid_.frame(column, row),
                         {above_.of(column), beside_.of(column + 1), below_.of(column), beside_.of(column)},
                         {false, false, false, false});
    }
  }

  Vec2 place(int column, int row) const { return {column * grid_.cell_width, -row * grid_.cell_height}; }

  const FixedGrid& grid_;
  const Context& context_;
  const FixedLevels& levels_;
  bool keep_border_;
  Strip& strip_;
  BoxTracer<RectanglePatch> boxes_;
  EdgeRow above_, below_, beside_;
  std::vector<std::int32_t> low_, high_;
  std::vector<std::uint32_t> candidates_;
  std::vector<std::uint8_t> marked_;
};

/// Strips one behind the other. A root on the row between two strips was found by both: the second's is the first's.
Trace join(std::vector<Strip>& strips, std::vector<BorderEdge>* border, const Context& context) {
  Trace all;
  std::size_t total = 0;
  for (const Strip& s : strips) total += s.trace.points.size();
  all.points.reserve(total);
  all.next.reserve(total);
  all.level.reserve(total);
  std::vector<std::uint32_t> seam;  // of the strip before: points of its last row, in the joined numbering
  for (std::size_t k = 0; k < strips.size(); ++k) {
    context.check();
    Strip& s = strips[k];
    const std::size_t shared = k == 0 ? 0 : s.top.size();
    // The first row is traced first, so its roots are points 0, 1, ... of the strip.
    const auto offset = static_cast<std::uint32_t>(all.points.size() - shared);
    const auto joined = [&](std::uint32_t p) { return p < shared ? seam[p] : p + offset; };
    all.points.insert(all.points.end(), s.trace.points.begin() + static_cast<std::ptrdiff_t>(shared),
                      s.trace.points.end());
    all.level.insert(all.level.end(), s.trace.level.begin() + static_cast<std::ptrdiff_t>(shared), s.trace.level.end());
    for (std::size_t i = 0; i < shared; ++i)
      if (s.trace.next[i] != kNoPoint) all.next[seam[i]] = joined(s.trace.next[i]);
    for (std::size_t i = shared; i < s.trace.next.size(); ++i)
      all.next.push_back(s.trace.next[i] == kNoPoint ? kNoPoint : joined(s.trace.next[i]));
    std::vector<std::uint32_t> last;
    last.reserve(s.bottom.size());
    for (const EdgeRoot& r : s.bottom) last.push_back(joined(r.point));
    if (border != nullptr)
      for (BorderEdge& e : s.border) {
        // A seam's edges are reported by both strips.
        if (k > 0 && e.horizontal && e.row == static_cast<int>(k) * kStripRows) continue;
        for (EdgeRoot& r : e.roots) r.point = joined(r.point);
        border->push_back(std::move(e));
      }
    const std::size_t again = k == 0 ? 0 : s.top_undecided;
    all.singular.insert(all.singular.end(), s.trace.singular.begin() + static_cast<std::ptrdiff_t>(again),
                        s.trace.singular.end());
    all.pairs += s.trace.pairs;
    all.certified += s.trace.certified;
    all.boxes += s.trace.boxes;
    all.undecided_edges += s.trace.undecided_edges - again;
    all.depth = std::max(all.depth, s.trace.depth);
    seam = std::move(last);
    s = Strip{};
  }
  return all;
}

}  // namespace

Trace trace_grid(const FixedGrid& grid, const FixedLevels& levels, double tolerance, std::vector<BorderEdge>* border,
                 const Context& context) {
  const int patch_rows = grid.rows - 1;
  std::vector<Strip> strips(static_cast<std::size_t>((patch_rows + kStripRows - 1) / kStripRows));
  parallel_chunks(strips.size(), 1, context, [&](std::size_t from, std::size_t to) {
    for (std::size_t s = from; s < to; ++s) {
      const int first = static_cast<int>(s) * kStripRows;
      StripTracer(grid, levels, tolerance, border != nullptr, strips[s], context)
          .run(first, std::min(patch_rows, first + kStripRows));
    }
  });
  return join(strips, border, context);
}

}  // namespace retalho
