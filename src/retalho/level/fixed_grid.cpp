#include "retalho/level/fixed_grid.h"

#include <algorithm>
#include <cmath>

#include "retalho/core/in_order.h"
#include "retalho/core/parallel.h"
#include "retalho/core/variants.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/surface_size.h"
#include "retalho/terrain/bicubic_rows.h"

namespace retalho {
namespace {

/// The largest sum of the sizes that make an ordinate, of samples [from, to).
RETALHO_VARIANTS
double largest_ordinate(const BicubicGrid& grid, std::size_t from, std::size_t to) {
  const double *z = grid.z.data(), *zu = grid.zu.data(), *zv = grid.zv.data(), *zuv = grid.zuv.data();
  constexpr std::size_t kLanes = 8;
  std::array<double, kLanes> m{};
  for (; to - from >= kLanes; from += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) {
      const std::size_t i = from + l;
      const double size = std::abs(z[i]) + (std::abs(zu[i]) + std::abs(zv[i])) / 3 + std::abs(zuv[i]) / 9;
      m[l] = m[l] < size ? size : m[l];
    }
  for (std::size_t i = from; i < to; ++i)
    m[0] = std::max(m[0], std::abs(z[i]) + (std::abs(zu[i]) + std::abs(zv[i])) / 3 + std::abs(zuv[i]) / 9);
  return *std::max_element(m.begin(), m.end());
}

/// The whole numbers nearest to values * scale, ties to even; their magnitudes are below 2^31.
RETALHO_VARIANTS
void fix_values(const double* values, std::size_t n, double scale, std::int32_t* fixed) {
  constexpr double kNoFraction = 0x1.8p52;  // a sum with it has no bits left for a fraction
  for (std::size_t i = 0; i < n; ++i)
    fixed[i] = static_cast<std::int32_t>((values[i] * scale + kNoFraction) - kNoFraction);
}

/// Samples [from, to) of `grid` as whole quanta, to places `out` on.
void fix_samples(const BicubicGrid& grid, std::size_t from, std::size_t to, FixedGrid& f, std::size_t out) {
  const auto fix = [&](const std::vector<double>& values, double scale, std::vector<std::int32_t>& fixed) {
    fix_values(values.data() + from, to - from, scale, fixed.data() + out);
  };
  fix(grid.z, f.per_unit, f.z);
  fix(grid.zu, f.per_unit / 3, f.u);
  fix(grid.zv, f.per_unit / 3, f.v);
  fix(grid.zuv, f.per_unit / 9, f.t);
}

void hold_rows(FixedGrid& f, int first, int last) {
  f.held_first = first;
  f.held_rows = last - first;
  const std::size_t n = static_cast<std::size_t>(f.columns) * static_cast<std::size_t>(f.held_rows);
  for (std::vector<std::int32_t>* values : {&f.z, &f.u, &f.v, &f.t}) values->resize(n);
}

}  // namespace

FixedGrid fix_grid(const BicubicGrid& grid, const Context& context) {
  FixedGrid f;
  f.columns = grid.columns;
  f.rows = grid.rows;
  f.cell_width = grid.cell_width;
  f.cell_height = grid.cell_height;
  f.valid = grid.valid;
  constexpr std::size_t kGrain = std::size_t{1} << 16;
  const std::size_t n = grid.z.size();
  std::vector<double> largest((n + kGrain - 1) / kGrain, 0);
  parallel_chunks(n, kGrain, context,
                  [&](std::size_t from, std::size_t to) { largest[from / kGrain] = largest_ordinate(grid, from, to); });
  f.per_unit = quanta_per_unit(largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end()));
  hold_rows(f, 0, grid.rows);
  parallel_chunks(n, kGrain, context, [&](std::size_t from, std::size_t to) { fix_samples(grid, from, to, f, from); });
  return f;
}

FixedRows::FixedRows(const Raster& raster, const BicubicOptions& options, const Context& context)
    : raster_(raster), options_(options) {
  check_bicubic(raster);
  context.report("spline", 0);
  // Only the power of two above the largest ordinate counts: the surface is made where it may matter.
  const SurfaceSize size = bound_surface(raster, 64, context);
  const std::size_t count = size.unsure.size(), slots = std::min(slot_count(context), count);
  std::vector<BicubicGrid> windows(slots);
  std::vector<double> of_window(slots, 0);
  const Context alone{.threads = 1, .cancel = context.cancel};
  double largest = size.least;
  parallel_in_order(
      count, context,
      [&](std::size_t i, std::size_t slot) {
        const auto [first, last] = size.unsure[i];
        const int above = make_bicubic_rows(raster, first, last, options_, windows[slot], alone);
        of_window[slot] =
            largest_ordinate(windows[slot], raster.index(0, first - above), raster.index(0, last - above));
      },
      [&](std::size_t i, std::size_t slot) {
        largest = std::max(largest, of_window[slot]);
        context.report("spline", static_cast<double>(i + 1) / static_cast<double>(count));
      });
  context.report("spline", 1);
  per_unit_ = quanta_per_unit(largest);
}

void FixedRows::make(int first, int last, BicubicGrid& scratch, FixedGrid& f, const Context& context) const {
  const int above = make_bicubic_rows(raster_, first, last, options_, scratch, context);
  f.columns = raster_.columns;
  f.rows = raster_.rows;
  f.cell_width = raster_.cell_width;
  f.cell_height = raster_.cell_height;
  f.per_unit = per_unit_;
  hold_rows(f, first, last);
  fix_samples(scratch, raster_.index(0, first - above), raster_.index(0, last - above), f, 0);
  f.valid = {};
  if (scratch.valid.empty()) return;
  f.valid = Mask(f.columns, f.held_rows, false);
  for (int r = first; r < last; ++r)
    for (int c = 0; c < f.columns; ++c)
      if (scratch.valid.get(c, r - above)) f.valid.set(c, r - first, true);
}

RectanglePatch::Net<double> FixedGrid::net(int column, int row) const {
  RectanglePatch::Net<double> b;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const std::size_t n = node(column + j, row + i);
      const double height = 2.0 * z[n];
      const double along_u = (j != 0 ? -2.0 : 2.0) * u[n], along_v = (i != 0 ? -2.0 : 2.0) * v[n];
      const double mixed = (i != j ? -2.0 : 2.0) * t[n];
      const auto corner_row = static_cast<std::size_t>(12 * i), corner_column = static_cast<std::size_t>(3 * j);
      const auto inner_row = static_cast<std::size_t>(i != 0 ? 8 : 4),
                 inner_column = static_cast<std::size_t>(j != 0 ? 2 : 1);
      b[corner_row + corner_column] = height;
      b[corner_row + inner_column] = height + along_u;
      b[inner_row + corner_column] = height + along_v;
      b[inner_row + inner_column] = height + along_u + along_v + mixed;
    }
  return b;
}

}  // namespace retalho
