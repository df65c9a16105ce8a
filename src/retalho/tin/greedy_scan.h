// The worst cell of a triangle: the inner loop of the grid refinement.
//
// Rows are walked as [ceil(left), ceil(right)): of two triangles that share an edge exactly one owns the cells on it
// (left and top edges in; right and bottom edges in only on the border). The bounds' bias is half a cell over the
// edge's height, so that no bound is an integer and rounding cannot move it across one. Errors stay scaled by the
// doubled area, so no cell costs a division and integer heights are compared exactly, ties included; of equal errors
// the lowest row-major cell wins. The loop is compiled twice, with and without AVX2 (greedy_scan_*.cpp); lanes keep the
// same total order, so both give the same bytes.
#pragma once

#include <cstddef>

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
using Scan = void (*)(const ScanField<Height>&, Record&);

/// The fastest scan that this machine has.
template <class Height>
Scan<Height> choose_scan();

template <class Height>
void scan_generic(const ScanField<Height>& field, Record& t);
template <class Height>
void scan_avx2(const ScanField<Height>& field, Record& t);

}  // namespace retalho::greedy
