// Cells as the grid refinement packs them, and the exact predicates on them. Rows run south: area2 > 0 turns right seen
// from above.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace retalho::greedy {

/// row << 16 | column: in the order of the packed numbers cells run row by row.
using Cell = std::uint32_t;

constexpr int column_of(Cell c) {
  return static_cast<int>(c & 0xffffU);
}
constexpr int row_of(Cell c) {
  return static_cast<int>(c >> 16);
}
constexpr Cell cell_at(int column, int row) {
  return static_cast<Cell>(row) << 16 | static_cast<Cell>(column);
}

/// Twice the signed area; at most 2^32 in magnitude.
constexpr std::int64_t area2(Cell a, Cell b, Cell c) {
  return static_cast<std::int64_t>(column_of(b) - column_of(a)) * (row_of(c) - row_of(a)) -
         static_cast<std::int64_t>(column_of(c) - column_of(a)) * (row_of(b) - row_of(a));
}

/// Coordinate differences up to this keep the in-circle sum, at most 12 m^4, inside 64 bits.
inline constexpr int kNarrowSide = 29600;

/// > 0: the point lies inside the circle through a, b, c (area2 > 0), 0: on it, all given relative to it. `Wide` is
/// int64 where every difference is at most kNarrowSide, else __int128.
template <class Wide>
constexpr Wide in_circle_value(std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by, std::int64_t cx,
                               std::int64_t cy) {
  const std::int64_t la = ax * ax + ay * ay, lb = bx * bx + by * by, lc = cx * cx + cy * cy;
  return static_cast<Wide>(ax * by - ay * bx) * lc + static_cast<Wide>(bx * cy - by * cx) * la +
         static_cast<Wide>(cx * ay - cy * ax) * lb;
}
template <class Wide>
constexpr bool in_circle(std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by, std::int64_t cx,
                         std::int64_t cy) {
  return in_circle_value<Wide>(ax, ay, bx, by, cx, cy) > 0;
}

/// 1: p lies inside the circle through a, b, c (area2 > 0), 0: on it, -1: outside.
inline int circle_side(Cell a, Cell b, Cell c, Cell p) {
  const int x = column_of(p), y = row_of(p);
  const __int128 value = in_circle_value<__int128>(column_of(a) - x, row_of(a) - y, column_of(b) - x, row_of(b) - y,
                                                   column_of(c) - x, row_of(c) - y);
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}
inline bool in_circle(Cell a, Cell b, Cell c, Cell p) {
  return circle_side(a, b, c, p) > 0;
}

}  // namespace retalho::greedy
