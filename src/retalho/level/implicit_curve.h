// The curve f(x, y) = 0 in a box, by subdivision with certificates (docs/curves.md, "Implicit curves").
//
// Promises
// - Nothing is lost: a cell is discarded only when f is proved to have no zero in it: all Bernstein coefficients of one
//   sign beyond their rounding error where f is a polynomial, an interval without zero elsewhere. Double factors,
//   ovals smaller than a cell, isolated points and cusps stay.
// - Lines are drawn only in cells where f_x or f_y is proved to keep its sign: the curve is a graph there, and it is
//   connected between its exact crossings with the cell's sides. All other cells are given back as they are.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/level/implicit_tensor.h"

namespace retalho {

struct ImplicitOptions {
  int depth = 9;                 ///< 2^depth cells a side
  int extra = 6;                 ///< levels more for cells that no certificate resolves...
  std::size_t extra_cells = 64;  ///< ...when there are at most this many of them (a double factor has one all along)
};

struct ImplicitLine {
  std::vector<Vec2> points;  ///< crossings of the curve with cell sides, on the curve to rounding
  bool closed = false;       ///< the last point joins the first, which is not repeated
};

struct ImplicitCurve {
  std::vector<ImplicitLine> lines;
  /// Cells that may hold zeros without a certificate: singular points, even multiplicity, kinks. Drawn as cells.
  std::vector<PlaneBox> unresolved;
  /// Cells where f jumps, has a pole or is not defined everywhere: zeros are possible, often there are none.
  std::vector<PlaneBox> doubtful;
  bool polynomial = false;     ///< decided with Bernstein coefficients; otherwise with intervals
  std::size_t visited = 0;     ///< cells looked at, all levels counted
  std::size_t kept = 0;        ///< cells of the deepest regular level that were not discarded
  std::size_t grid_cells = 0;  ///< 4^depth: what a method without proof would have to look at
};

/// Throws UsageError for an empty box or a depth out of 1..14.
ImplicitCurve trace_implicit(const Expression& f, const PlaneBox& box, const ImplicitOptions& options = {},
                             const Context& context = {});

}  // namespace retalho
