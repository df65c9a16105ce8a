#include "retalho/level/implicit_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "retalho/bernstein/segment.h"
#include "retalho/core/error.h"
#include "retalho/level/implicit_field.h"

namespace retalho {

namespace {

struct Event {
  double along;  // coordinate that varies along the side
  std::uint32_t node;
};

/// A side of a cell: where the curve crosses it. Computed once and handed to the cells on both sides, and cut, never
/// computed again, when they are divided: so lines of neighbours share their ends to the last bit.
template <typename Field>
struct Side {
  typename Field::Edge edge;
  double from = 0, to = 1, fixed = 0;
  bool vertical = false;
  bool zero = false;  // f vanishes all along
  std::vector<Event> events;
};

template <typename Field>
class Tracing {
 public:
  using Cell = typename Field::Cell;
  using Sides = std::array<Side<Field>, 4>;  // bottom, right, top, left

  Tracing(Field& field, const PlaneBox& box, const ImplicitOptions& options, ImplicitCurve& out, const Context& context)
      : field_(field),
        box_(box),
        options_(options),
        out_(out),
        context_(context),
        last_(options.depth + options.extra) {}

  void run() {
    Cell root = field_.root();
    const std::uint32_t end = std::uint32_t{1} << last_;
    Sides sides;
    for (int k = 0; k < 4; ++k) sides[static_cast<std::size_t>(k)] = make_side(root, k, 0, 0, end);
    visit(root, sides, 0, 0, 0);
    // Cells without a certificate: closer, where they are few.
    const bool closer = options_.extra > 0 && deferred_.size() <= options_.extra_cells;
    std::vector<Waiting> waiting = std::move(deferred_);
    for (Waiting& w : waiting) {
      if (closer)
        divide(w.cell, w.sides, w.x, w.y, options_.depth);
      else
        give_back(w.cell, w.x, w.y, options_.depth);
    }
    chain();
  }

 private:
  struct Waiting {
    Cell cell;
    Sides sides;
    std::uint32_t x, y;
  };

  double x_at(std::uint32_t i) const {
    return box_.x0 + (box_.x1 - box_.x0) * std::ldexp(static_cast<double>(i), -last_);
  }
  double y_at(std::uint32_t j) const {
    return box_.y0 + (box_.y1 - box_.y0) * std::ldexp(static_cast<double>(j), -last_);
  }
  PlaneBox box_at(std::uint32_t x, std::uint32_t y, int level) const {
    const std::uint32_t size = std::uint32_t{1} << (last_ - level);
    return {x_at(x), y_at(y), x_at(x + size), y_at(y + size)};
  }

  std::uint32_t node_at(double x, double y) {
    const std::uint64_t key =
        std::bit_cast<std::uint64_t>(x + 0.0) * 0x9e3779b97f4a7c15ULL ^ std::bit_cast<std::uint64_t>(y + 0.0);
    auto& bucket = index_[key];
    for (const std::uint32_t n : bucket)
      if (nodes_[n] == Vec2{x, y}) return n;
    nodes_.push_back({x, y});
    bucket.push_back(static_cast<std::uint32_t>(nodes_.size() - 1));
    return bucket.back();
  }
  std::uint32_t node_on(const Side<Field>& s, double along) {
    return s.vertical ? node_at(s.fixed, along) : node_at(along, s.fixed);
  }

  /// Side k (bottom, right, top, left) of a cell whose corner is (x, y) and size `size` on the finest grid.
  Side<Field> make_side(const Cell& cell, int k, std::uint32_t x, std::uint32_t y, std::uint32_t size) {
    Side<Field> s;
    s.vertical = k == 1 || k == 3;
    s.from = s.vertical ? y_at(y) : x_at(x);
    s.to = s.vertical ? y_at(y + size) : x_at(x + size);
    s.fixed = s.vertical ? x_at(k == 1 ? x + size : x) : y_at(k == 2 ? y + size : y);
    s.edge = field_.edge(cell, k, s.from, s.to, s.fixed);
    const EdgeRoots roots = field_.roots(s.edge);
    s.zero = roots.zero;
    const double tiny = 1e-9 * (s.to - s.from);
    if (roots.at_start) s.events.push_back({s.from, node_on(s, s.from)});
    for (const double t : roots.inner) {
      const double along = s.from + t * (s.to - s.from);
      if (along <= s.from || along >= s.to || (roots.at_start && along - s.from < tiny) ||
          (roots.at_end && s.to - along < tiny))
        continue;
      s.events.push_back({along, node_on(s, along)});
    }
    if (roots.at_end) s.events.push_back({s.to, node_on(s, s.to)});
    return s;
  }

  std::array<Side<Field>, 2> cut_side(const Side<Field>& s, double middle) {
    std::array<Side<Field>, 2> parts;
    for (Side<Field>& p : parts) p.vertical = s.vertical, p.fixed = s.fixed, p.zero = s.zero;
    parts[0].from = s.from;
    parts[0].to = parts[1].from = middle;
    parts[1].to = s.to;
    const bool corner = field_.cut(s.edge, parts[0].edge, parts[1].edge) || s.zero;
    const double tiny = 1e-9 * (s.to - s.from);
    for (const Event& e : s.events) {
      if (corner && std::abs(e.along - middle) < tiny) continue;
      if (e.along <= middle) parts[0].events.push_back(e);
      if (e.along >= middle) parts[1].events.push_back(e);
    }
    if (corner) {
      const Event e{middle, node_on(s, middle)};
      parts[0].events.push_back(e);
      parts[1].events.insert(parts[1].events.begin(), e);
    }
    return parts;
  }

  void visit(const Cell& cell, const Sides& sides, std::uint32_t x, std::uint32_t y, int level) {
    if ((++out_.visited & 4095U) == 0) context_.check();
    if (field_.absent(cell)) return;
    if (level < options_.depth) {
      divide(cell, sides, x, y, level);
      return;
    }
    if (level == options_.depth) ++out_.kept;
    if (resolve(cell, sides, box_at(x, y, level))) return;
    if (level == options_.depth)
      deferred_.push_back({cell, sides, x, y});
    else if (level < last_)
      divide(cell, sides, x, y, level);
    else
      give_back(cell, x, y, level);
  }

  void give_back(const Cell& cell, std::uint32_t x, std::uint32_t y, int level) {
    (field_.continuous(cell) ? out_.unresolved : out_.doubtful).push_back(box_at(x, y, level));
  }

  void divide(const Cell& cell, const Sides& sides, std::uint32_t x, std::uint32_t y, int level) {
    const std::uint32_t half = std::uint32_t{1} << (last_ - level - 1);
    std::array<Cell, 4> child = field_.split(cell, box_at(x, y, level));  // SW, SE, NW, NE
    const double xm = x_at(x + half), ym = y_at(y + half);
    const auto bottom = cut_side(sides[0], xm), right = cut_side(sides[1], ym), top = cut_side(sides[2], xm),
               left = cut_side(sides[3], ym);
    const Side<Field> low = make_side(child[0], 1, x, y, half), high = make_side(child[2], 1, x, y + half, half);
    const Side<Field> west = make_side(child[0], 2, x, y, half), east = make_side(child[1], 2, x + half, y, half);
    visit(child[0], {bottom[0], low, west, left[0]}, x, y, level + 1);
    visit(child[1], {bottom[1], right[0], east, low}, x + half, y, level + 1);
    visit(child[2], {west, high, top[0], left[1]}, x, y + half, level + 1);
    visit(child[3], {east, right[1], top[1], high}, x + half, y + half, level + 1);
  }

  /// Draws the curve where it is proved to be a graph over x or over y. False: no certificate.
  bool resolve(const Cell& cell, const Sides& sides, const PlaneBox& box) {
    const auto [dx, dy] = field_.gradient_signs(cell);
    if (dx == 0 && dy == 0) return false;
    const bool over_x = dy != 0;  // f grows or falls along y: one y for each x
    std::vector<std::uint32_t> events;
    for (const Side<Field>& s : sides)
      for (const Event& e : s.events) events.push_back(e.node);
    std::sort(events.begin(), events.end());
    events.erase(std::unique(events.begin(), events.end()), events.end());
    const auto position = [&](std::uint32_t n) { return over_x ? nodes_[n].x : nodes_[n].y; };
    std::sort(events.begin(), events.end(), [&](std::uint32_t a, std::uint32_t b) {
      return position(a) != position(b) ? position(a) < position(b) : a < b;
    });
    const Side<Field>& below = sides[over_x ? 0 : 3];
    const Side<Field>& above = sides[over_x ? 2 : 1];
    const double sign = over_x ? dy : dx;
    for (std::size_t i = 0; i + 1 < events.size(); ++i) {
      const double a = position(events[i]), b = position(events[i + 1]);
      if (!(a < b)) continue;
      const double t = (0.5 * (a + b) - below.from) / (below.to - below.from);
      const double low = below.zero ? 0 : sign * field_.value(below.edge, t),
                   high = above.zero ? 0 : sign * field_.value(above.edge, t);
      if (low <= 0 && high >= 0)
        draw_arc(cell, box, over_x, events[i], events[i + 1], below.zero || above.zero ? 8 : 0);
    }
    return true;
  }

  /// From one crossing to the next along the graph, with points between where the curve leaves the chord by more than
  /// a fiftieth of a regular cell.
  void draw_arc(const Cell& cell, const PlaneBox& box, bool over_x, std::uint32_t a, std::uint32_t b, int level) {
    const Vec2 p = nodes_[a], q = nodes_[b];
    if (level < 8) {
      const double flat = 0.02 * std::ldexp(std::min(box_.x1 - box_.x0, box_.y1 - box_.y0), -options_.depth);
      const auto point = [&](double t) {
        const double along = over_x ? p.x + t * (q.x - p.x) : p.y + t * (q.y - p.y);
        const double height = field_.height(cell, box, over_x, along);
        return over_x ? Vec2{along, height} : Vec2{height, along};
      };
      const auto off = [&](Vec2 r) { return std::abs(cross(q - p, r - p)) / std::max(norm(q - p), 1e-300); };
      const Vec2 middle = point(0.5);
      if (off(middle) > flat || (level == 0 && (off(point(0.25)) > flat || off(point(0.75)) > flat))) {
        const std::uint32_t m = node_at(middle.x, middle.y);
        if (m != a && m != b) {
          draw_arc(cell, box, over_x, a, m, level + 1);
          draw_arc(cell, box, over_x, m, b, level + 1);
          return;
        }
      }
    }
    segments_.push_back({std::min(a, b), std::max(a, b)});
  }

  /// Segments to lines: from free ends and branch points first, then closed ones, in the order of the nodes.
  void chain() {
    std::sort(segments_.begin(), segments_.end());
    segments_.erase(std::unique(segments_.begin(), segments_.end()), segments_.end());
    std::vector<std::vector<std::uint32_t>> at(nodes_.size());
    for (std::size_t i = 0; i < segments_.size(); ++i)
      for (const std::uint32_t n : segments_[i]) at[n].push_back(static_cast<std::uint32_t>(i));
    std::vector<char> used(segments_.size(), 0);
    const auto follow = [&](std::uint32_t start, std::uint32_t segment) {
      ImplicitLine line;
      line.points.push_back(nodes_[start]);
      std::uint32_t n = start;
      for (std::uint32_t s = segment;;) {
        used[s] = 1;
        n = segments_[s][0] == n ? segments_[s][1] : segments_[s][0];
        if (n == start) {
          line.closed = true;
          break;
        }
        line.points.push_back(nodes_[n]);
        if (at[n].size() != 2) break;
        const std::uint32_t next = at[n][0] == s ? at[n][1] : at[n][0];
        if (used[next]) break;
        s = next;
      }
      out_.lines.push_back(std::move(line));
    };
    for (std::uint32_t n = 0; n < at.size(); ++n)
      if (at[n].size() != 2)
        for (const std::uint32_t s : at[n])
          if (!used[s]) follow(n, s);
    for (std::uint32_t n = 0; n < at.size(); ++n)
      for (const std::uint32_t s : at[n])
        if (!used[s]) follow(n, s);
  }

  Field& field_;
  const PlaneBox& box_;
  const ImplicitOptions& options_;
  ImplicitCurve& out_;
  const Context& context_;
  int last_;
  std::vector<Vec2> nodes_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> index_;
  std::vector<std::array<std::uint32_t, 2>> segments_;
  std::vector<Waiting> deferred_;
};

}  // namespace

ImplicitCurve trace_implicit(const Expression& f, const PlaneBox& box, const ImplicitOptions& options,
                             const Context& context) {
  if (!(box.x0 < box.x1 && box.y0 < box.y1))
    throw UsageError(fmt::format("the box {}, {}, {}, {} is empty", box.x0, box.y0, box.x1, box.y1));
  if (options.depth < 1 || options.depth > 14 || options.extra < 0 || options.extra > 14)
    throw UsageError(fmt::format("depth {}: 1 to 14 is possible", options.depth));
  ImplicitCurve out;
  out.grid_cells = std::size_t{1} << (2 * options.depth);
  if (auto polynomial = polynomial_on_box(f, box)) {
    out.polynomial = true;
    PolynomialField field(std::move(*polynomial));
    Tracing(field, box, options, out, context).run();
  } else {
    IntervalField field(f, box);
    Tracing(field, box, options, out, context).run();
  }
  return out;
}

}  // namespace retalho
