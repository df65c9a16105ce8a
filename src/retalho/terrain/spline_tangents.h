// Internal to terrain/: the tangents of interpolating cubic splines along the rows or columns of a grid.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/mask.h"
#include "retalho/terrain/bicubic.h"

namespace retalho {

struct GridShape {
  int columns = 0, rows = 0;
  std::size_t cells() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
};

/// Rows [first, last).
struct RowRange {
  int first = 0, last = 0;
};

/// Derivative per cell along each row (or column) of the unbroken runs of valid samples: of one sample 0, of two their
/// difference, of three their parabola's, else the cubic spline's. Each is a function of the kSplineHalo samples to
/// both sides alone, rounded alike wherever the samples stand. `valid` empty: all. Only the values in `rows` are set.
void tangents_along_rows(std::span<const double> values, GridShape shape, const Mask& valid, TangentEnds ends,
                         RowRange rows, std::span<double> out, const Context& context);
void tangents_along_columns(std::span<const double> values, GridShape shape, const Mask& valid, TangentEnds ends,
                            RowRange rows, std::span<double> out, const Context& context);

}  // namespace retalho
