#include "retalho/level/trace_grid.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "retalho/level/box_tracer.h"
#include "retalho/level/row_ranges.h"

namespace retalho {
namespace {

/// The roots on a row of edges: those of edge c stand at [start[c], start[c + 1]).
class EdgeRow {
 public:
  std::vector<std::uint32_t> start;
  std::vector<EdgeRoot> roots;

  std::span<const EdgeRoot> of(int edge) const {
    const auto c = static_cast<std::size_t>(edge);
    return std::span(roots).subspan(start[c], start[c + 1] - start[c]);
  }
  /// Without roots, for `edges` edges; begin() is called for those that may have some, ascending, then finish().
  void restart(std::size_t edges) {
    roots.clear();
    start.resize(edges + 1);
    known_ = 0;
  }
  void begin(std::size_t edge) {
    while (known_ <= edge) start[known_++] = static_cast<std::uint32_t>(roots.size());
  }
  void finish() { begin(start.size() - 1); }

 private:
  std::size_t known_ = 0;
};

class StripTracer {
 public:
  StripTracer(const FixedGrid& grid, const FixedLevels& levels, double tolerance, bool keep_border, GridStrip& strip,
              const Context& context)
      : grid_(grid),
        context_(context),
        levels_(levels),
        keep_border_(keep_border),
        strip_(strip),
        boxes_(levels, tolerance, true, strip.trace),
        low_(static_cast<std::size_t>(grid.columns)),
        high_(low_.size()),
        places_(low_.size()),
        marked_(low_.size()) {}

  void run(int first, int last) {
    select_patches(first);
    trace_row(first, above_);
    strip_.top = static_cast<std::uint32_t>(above_.roots.size());
    strip_.top_undecided = strip_.trace.undecided_edges;
    for (int row = first; row < last; ++row) {
      if (row > first) select_patches(row);
      strip_.bottom = static_cast<std::uint32_t>(strip_.trace.points.size());
      trace_row(row + 1, below_);
      trace_columns(row);
      trace_patches(row);
      std::swap(above_, below_);
    }
    strip_.bottom_count = static_cast<std::uint32_t>(above_.roots.size());
  }

 private:
  /// The patches of a row whose range may hold a level, into candidates_, whether they exist or not. An edge's
  /// ordinates are its patches' too: no other edges have roots.
  void select_patches(int row) {
    const std::size_t n = static_cast<std::size_t>(grid_.columns) - 1, o = grid_.node(0, row);
    bound_patch_row(&grid_.z[o], &grid_.u[o], &grid_.v[o], &grid_.t[o], n + 1, n, low_.data(), high_.data());
    const std::size_t found = select_ranges(low_.data(), high_.data(), n, levels_, marked_.data(), places_.data());
    candidates_ = std::span(places_).first(found);
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

  /// The roots on the edges of a row, beside the patches last selected.
  void trace_row(int row, EdgeRow& edges) {
    const std::size_t n = static_cast<std::size_t>(grid_.columns) - 1, o = grid_.node(0, row);
    edges.restart(n);
    for (const std::uint32_t c : candidates_) {
      context_.check();  // a patch may hold thousands of lines
      edges.begin(c);
      const int column = static_cast<int>(c);
      const bool above = grid_.has_patch(column, row - 1), below = grid_.has_patch(column, row);
      if (!above && !below) continue;
      const std::size_t before = edges.roots.size();
      isolate(grid_.z[o + c], grid_.u[o + c], grid_.u[o + c + 1], grid_.z[o + c + 1], place(column, row),
              place(column + 1, row), edges.roots);
      if (keep_border_ && above != below && edges.roots.size() > before)
        keep_edge(column, row, true, std::span(edges.roots).subspan(before));
    }
    edges.finish();
  }

  void trace_columns(int row) {
    const auto n = static_cast<std::size_t>(grid_.columns);
    const std::size_t o = grid_.node(0, row);
    beside_.restart(n);
    const auto trace = [&](std::size_t c) {
      beside_.begin(c);
      const int column = static_cast<int>(c);
      const bool left = grid_.has_patch(column - 1, row), right = grid_.has_patch(column, row);
      if (!left && !right) return;
      const std::size_t before = beside_.roots.size();
      isolate(grid_.z[o + c], grid_.v[o + c], grid_.v[o + c + n], grid_.z[o + c + n], place(column, row),
              place(column, row + 1), beside_.roots);
      if (keep_border_ && left != right && beside_.roots.size() > before)
        keep_edge(column, row, false, std::span(beside_.roots).subspan(before));
    };
    std::size_t next = 0;  // both sides of each patch, once
    for (const std::uint32_t c : candidates_) {
      context_.check();
      if (c >= next) trace(c);
      trace(next = c + 1);
      ++next;
    }
    beside_.finish();
  }

  void trace_patches(int row) {
    for (const std::uint32_t c : candidates_) {
      context_.check();
      const int column = static_cast<int>(c);
      if (!grid_.has_patch(column, row)) continue;
      if (levels_.at_most(2.0 * low_[c]) >= levels_.at_most(2.0 * high_[c])) continue;
      boxes_.trace_patch(grid_.net(column, row), grid_.frame(column, row),
                         {above_.of(column), beside_.of(column + 1), below_.of(column), beside_.of(column)},
                         {false, false, false, false});
    }
  }

  void keep_edge(int column, int row, bool horizontal, std::span<const EdgeRoot> roots) {
    BorderEdge& edge = strip_.border.emplace_back(BorderEdge{column, row, horizontal, {}});
    for (const EdgeRoot& r : roots) edge.roots.push_back({r.point, strip_.trace.points[r.point]});
  }

  Vec2 place(int column, int row) const { return {column * grid_.cell_width, -row * grid_.cell_height}; }

  const FixedGrid& grid_;
  const Context& context_;
  const FixedLevels& levels_;
  bool keep_border_;
  GridStrip& strip_;
  BoxTracer<RectanglePatch> boxes_;
  EdgeRow above_, below_, beside_;
  std::vector<std::int32_t> low_, high_;
  std::vector<std::uint32_t> places_;
  std::span<const std::uint32_t> candidates_;  ///< of places_
  std::vector<std::uint8_t> marked_;
};

}  // namespace

void trace_strip(const FixedGrid& grid, const FixedLevels& levels, double tolerance, int index, bool keep_border,
                 GridStrip& strip, const Context& context) {
  strip.trace.clear();
  strip.border.clear();
  const int first = index * kStripRows, last = std::min(grid.rows - 1, first + kStripRows);
  StripTracer(grid, levels, tolerance, keep_border, strip, context).run(first, last);
}

}  // namespace retalho
