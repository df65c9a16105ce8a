// The worst cell of a triangle: the inner loop of the grid refinement.
//
// Rows are walked as [ceil(left), ceil(right)): of two triangles that share an edge exactly one owns the cells on it
// (left and top edges in; right and bottom edges in only on the border). The bounds' bias is half a cell over the
// edge's height, so that no bound is an integer and rounding cannot move it across one. Errors stay scaled by the
// doubled area, so no cell costs a division and integer heights are compared exactly, ties included; of equal errors
// the lowest row-major cell wins.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "retalho/tin/grid_cell.h"
#include "retalho/tin/tin.h"

namespace retalho::greedy {

/// A triangle of the refinement: 32 bytes. Links are triangle << 2 | edge; edge k runs from corner k to corner k + 1.
struct alignas(32) Record {
  Cell corner[3];
  std::uint32_t link[3];  ///< kNone: border
  Cell candidate;         ///< the cell to insert, when error > 0
  float error;            ///< > 0: over the tolerance (for the order only); else minus the largest error
};

/// What a scan looks at, and how closely.
template <class Height>
struct ScanField {
  const Height* heights = nullptr;  ///< row-major; NaN is void and never the worst
  int columns = 0, rows = 0;
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;   ///< first and last column and row that are looked at
  double tolerance = 0;                 ///< errors up to this ask for nothing
  double enough = 0;                    ///< an error over this, found on some rows of a tall triangle, will do
  int sampled_rows = 24;                ///< of a triangle of more than twice as many; 0: always all rows
  const double* reciprocals = nullptr;  ///< 1 / n for n = 0 .. longest side, [0] = 0

  double at(Cell c) const {
    return static_cast<double>(heights[static_cast<std::size_t>(row_of(c)) * static_cast<std::size_t>(columns) +
                                       static_cast<std::size_t>(column_of(c))]);
  }
};

/// Sets the record's candidate and error.
template <class Height>
void scan(const ScanField<Height>& field, Record& t) {
  const int ax = column_of(t.corner[0]), ay = row_of(t.corner[0]), bx = column_of(t.corner[1]),
            by = row_of(t.corner[1]), cx = column_of(t.corner[2]), cy = row_of(t.corner[2]);
  const std::int64_t doubled =
      static_cast<std::int64_t>(bx - ax) * (cy - ay) - static_cast<std::int64_t>(cx - ax) * (by - ay);
  t.error = 0;
  if (doubled == 1) return;  // no other cell
  const int ex[3] = {bx - ax, cx - bx, ax - cx}, ey[3] = {by - ay, cy - by, ay - cy};
  const int px[3] = {ax, bx, cx}, py[3] = {ay, by, cy};
  int first = std::min(ay, std::min(by, cy)), last = std::max(ay, std::max(by, cy));
  const int top = first, bottom = last;
  ++first;
  --last;
  double slope[3], offset[3];
  bool left[3];
  for (int k = 0; k < 3; ++k) {
    const int dy = ey[k];
    if (dy == 0) {
      if (ex[k] > 0)
        first = top;
      else if (t.link[k] == kNone)
        last = bottom;
    }
    left[k] = dy < 0;
    const double r = field.reciprocals[dy < 0 ? -dy : dy];
    const double bias = t.link[k] == kNone && !left[k] ? 1 + 0.5 * r : 1 - 0.5 * r;
    slope[k] = static_cast<double>(dy < 0 ? -ex[k] : ex[k]) * r;
    offset[k] = static_cast<double>(px[k]) + bias - slope[k] * static_cast<double>(py[k]);
    if (dy == 0) {  // bounds nothing
      left[k] = true;
      slope[k] = 0;
      offset[k] = 0;
    }
  }
  first = std::max(first, field.y0);
  last = std::min(last, field.y1);
  if (first > last) return;
  const double za = field.at(t.corner[0]), zb = field.at(t.corner[1]), zc = field.at(t.corner[2]),
               area = static_cast<double>(doubled);
  const double gx = (zb - za) * (cy - ay) - (zc - za) * (by - ay), gy = (zc - za) * (bx - ax) - (zb - za) * (cx - ax);
  const double base = area * za, limit = field.tolerance * area,
               enough = std::max(field.enough, field.tolerance) * area;
  const double low = static_cast<double>(field.x0), high = static_cast<double>(field.x1 + 1);
  const int rows = last - first + 1;
  int step = field.sampled_rows > 0 && rows > 2 * field.sampled_rows ? rows / field.sampled_rows : 1;
  double worst;
  Cell at;
  for (;; step = step > 4 ? step / 4 : 1) {
    worst = 0;
    at = 0;
    for (int y = step == 1 ? first : first + step / 2; y <= last; y += step) {
      double l = low, r = high;
      for (int k = 0; k < 3; ++k) {
        const double x = slope[k] * y + offset[k];
        if (left[k])
          l = std::max(l, x);
        else
          r = std::min(r, x);
      }
      const int begin = static_cast<int>(l), end = static_cast<int>(std::max(r, 0.0));
      const Height* row = field.heights + static_cast<std::size_t>(y) * static_cast<std::size_t>(field.columns);
      const double plane = base + gy * static_cast<double>(y - ay);
      double x = static_cast<double>(begin - ax);
      for (int c = begin; c < end; ++c, x += 1) {
        const double e = std::fabs(area * static_cast<double>(row[c]) - (plane + gx * x));
        if (e > worst) {
          worst = e;
          at = cell_at(c, y);
        }
      }
    }
    if (worst > enough || step == 1) break;
  }
  if (worst > limit) {
    t.candidate = at;
    t.error = std::max(static_cast<float>(worst / area), 1e-30F);
  } else {
    t.error = -static_cast<float>(worst / area);
  }
}

}  // namespace retalho::greedy
