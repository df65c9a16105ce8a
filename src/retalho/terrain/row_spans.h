// The cells of a regular grid that a closed triangle holds, row by row, decided exactly.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "retalho/terrain/orientation.h"
#include "retalho/tin/tin.h"

namespace retalho {

/// Cell (c, r) at origin + (c * step.x, -r * step.y), computed in this order of operations wherever a cell is meant.
struct RowGrid {
  Vec2 origin, step;
  int columns = 0, rows = 0;

  double x(int column) const { return origin.x + column * step.x; }
  double y(int row) const { return origin.y - row * step.y; }
  Vec2 at(int column, int row) const { return {x(column), y(row)}; }
};

struct RowRange {
  int first = 0, last = -1;  ///< empty where first > last
};

namespace row_spans_detail {

/// Clamps before the conversion: a coordinate far outside of the grid must not overflow.
inline int whole(double v, int most) {
  return static_cast<int>(std::clamp(v, -1.0, static_cast<double>(most)));
}

}  // namespace row_spans_detail

/// The rows whose height lies within the closed triangle.
inline RowRange row_range(const Tin& tin, std::uint32_t triangle, const RowGrid& grid) {
  const auto& v = tin.triangles[triangle];
  const double ya = tin.points[v[0]].y, yb = tin.points[v[1]].y, yc = tin.points[v[2]].y;
  const double low = std::min({ya, yb, yc}), high = std::max({ya, yb, yc});
  // One row more at either end by arithmetic, then exactly by the rows' own coordinates.
  RowRange range{
      std::max(0, row_spans_detail::whole(std::floor((grid.origin.y - high) / grid.step.y), grid.rows)),
      std::min(grid.rows - 1, row_spans_detail::whole(std::ceil((grid.origin.y - low) / grid.step.y), grid.rows))};
  while (range.first <= range.last && grid.y(range.first) > high) ++range.first;
  while (range.first <= range.last && grid.y(range.last) < low) --range.last;
  return range;
}

/// Calls use(row, first, last) for the rows from `first_row` to `last_row`: columns first..last lie in the closed
/// triangle.
template <class Use>
void for_each_row_span(const Tin& tin, std::uint32_t triangle, const RowGrid& grid, int first_row, int last_row,
                       const Use& use) {
  RowRange rows = row_range(tin, triangle, grid);
  rows.first = std::max(rows.first, first_row);
  rows.last = std::min(rows.last, last_row);
  if (rows.first > rows.last) return;
  const auto& v = tin.triangles[triangle];
  Vec2 low = tin.points[v[0]], middle = tin.points[v[1]], high = tin.points[v[2]];
  if (middle.y < low.y) std::swap(low, middle);
  if (high.y < middle.y) std::swap(middle, high);
  if (middle.y < low.y) std::swap(low, middle);
  const bool middle_right = orientation(low, high, middle) < 0;
  // Where arithmetic leaves it open on which side of an edge a cell lies, the exact predicate decides.
  const double size = std::max({std::abs(low.x), std::abs(middle.x), std::abs(high.x), std::abs(grid.origin.x)});
  const double doubt = std::min(0.49, 1e-9 + 1e-15 * size / grid.step.x);
  struct Side {
    Vec2 from, to;
    double slope;  // of x over y
  };
  const auto side = [](Vec2 from, Vec2 to) {
    return Side{from, to, to.y > from.y ? (to.x - from.x) / (to.y - from.y) : 0};
  };
  const Side longest = side(low, high), lower = side(low, middle), upper = side(middle, high);
  // The first column at or right of the side, or the last at or left of it.
  const auto column = [&](const Side& s, double y, int row, bool is_left) {
    const double exact = (s.from.x + s.slope * (y - s.from.y) - grid.origin.x) / grid.step.x;
    const double nearest = std::floor(exact + 0.5);
    if (std::abs(exact - nearest) > doubt) {
      const double c = is_left ? std::ceil(exact) : std::floor(exact);
      return row_spans_detail::whole(c, grid.columns);
    }
    const int c = row_spans_detail::whole(nearest, grid.columns);
    const int turn = orientation(s.from, s.to, grid.at(c, row));  // > 0: the cell lies left of the side
    return is_left ? (turn <= 0 ? c : c + 1) : (turn >= 0 ? c : c - 1);
  };
  for (int row = rows.first; row <= rows.last; ++row) {
    const double y = grid.y(row);
    const Side& shorter = y < middle.y || (y == middle.y && middle.y > low.y) ? lower : upper;
    const Side& left = middle_right ? longest : shorter;
    const Side& right = middle_right ? shorter : longest;
    const int first = std::max(0, column(left, y, row, true)),
              last = std::min(grid.columns - 1, column(right, y, row, false));
    if (first <= last) use(row, first, last);
  }
}

}  // namespace retalho
