// The cells of a regular grid that a closed triangle holds, row by row, decided exactly.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "retalho/core/vec.h"
#include "retalho/terrain/locate.h"
#include "retalho/terrain/side.h"

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

/// The largest whole number not above `v`, clamped to [-2, most + 2]: a coordinate far outside must not overflow.
inline int clamped_floor(double v, int most) {
  const double clamped = std::min(std::max(v, -2.0), most + 2.0);
  const int whole = static_cast<int>(clamped);
  return whole - (clamped < whole);
}

/// The rows whose height lies within the closed triangle.
inline RowRange row_range(const Corners& c, const RowGrid& grid, double rows_a_unit) {
  const double low = std::min(c[0].y, std::min(c[1].y, c[2].y)), high = std::max(c[0].y, std::max(c[1].y, c[2].y));
  // By arithmetic up to one row too many at either end, then exactly by the rows' own coordinates.
  RowRange range{std::max(0, clamped_floor((grid.origin.y - high) * rows_a_unit - 0.01, grid.rows)),
                 std::min(grid.rows - 1, clamped_floor((grid.origin.y - low) * rows_a_unit + 0.01, grid.rows))};
  while (range.first <= range.last && grid.y(range.first) > high) ++range.first;
  while (range.first <= range.last && grid.y(range.last) < low) --range.last;
  return range;
}

/// Calls use(row, first, last) for the rows of `rows`, all of which must lie within the triangle: columns first..last
/// of the row lie in the closed triangle (none: no call).
template <class Use>
void for_each_row_span(const Corners& corners, const RowGrid& grid, double columns_a_unit, RowRange rows,
                       const Use& use) {
  if (rows.first > rows.last) return;
  // Counter-clockwise from the lowest corner: (low, b, c).
  std::size_t at = 0;
  if (corners[1].y < corners[at].y) at = 1;
  if (corners[2].y < corners[at].y) at = 2;
  const Vec2 low = corners[at], b = corners[(at + 1) % 3], c = corners[(at + 2) % 3];
  // b is on the right of c: the right chain is low-b(-c), the left chain low-c(-b).
  const bool b_first = b.y <= c.y;  // the lower of the two is the middle corner
  const Vec2 middle = b_first ? b : c, high = b_first ? c : b;
  // Where arithmetic leaves it open on which side of an edge a cell lies, the exact predicate decides.
  const double size =
      std::max(std::max(std::abs(low.x), std::abs(b.x)), std::max(std::abs(c.x), std::abs(grid.origin.x)));
  const double doubt = std::min(0.49, 1e-9 + 1e-15 * size * columns_a_unit);
  struct Side {
    Vec2 from, to;
    double slope = 0, start = 0;  // column = start + slope * (y - from.y)
  };
  const auto side = [&](Vec2 from, Vec2 to) {
    const double height = to.y - from.y;
    return Side{from, to, height > 0 ? (to.x - from.x) / height * columns_a_unit : 0,
                (from.x - grid.origin.x) * columns_a_unit};
  };
  const Side longest = side(low, high);
  Side shorter = middle.y > low.y ? side(low, middle) : side(middle, high);
  bool lower = middle.y > low.y;
  const auto first_column = [&](const Side& s, double y, int row) {  // at or right of the side
    const double exact = s.start + s.slope * (y - s.from.y);
    const int floor = clamped_floor(exact, grid.columns);
    const double part = exact - floor;
    if (part > doubt && part < 1 - doubt) return floor + 1;
    const int nearest = part > 0.5 ? floor + 1 : floor;
    return side_of(s.from, s.to, grid.at(nearest, row)) <= 0 ? nearest : nearest + 1;
  };
  const auto last_column = [&](const Side& s, double y, int row) {  // at or left of the side
    const double exact = s.start + s.slope * (y - s.from.y);
    const int floor = clamped_floor(exact, grid.columns);
    const double part = exact - floor;
    if (part > doubt && part < 1 - doubt) return floor;
    const int nearest = part > 0.5 ? floor + 1 : floor;
    return side_of(s.from, s.to, grid.at(nearest, row)) >= 0 ? nearest : nearest - 1;
  };
  for (int row = rows.last; row >= rows.first; --row) {  // upwards: from the low corner
    const double y = grid.y(row);
    if (lower && y > middle.y) {
      shorter = side(middle, high);
      lower = false;
    }
    const int first = first_column(b_first ? longest : shorter, y, row),
              last = last_column(b_first ? shorter : longest, y, row);
    const int from = std::max(0, first), to = std::min(grid.columns - 1, last);
    if (from <= to) use(row, from, to);
  }
}

}  // namespace retalho
