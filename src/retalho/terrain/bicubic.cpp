#include "retalho/terrain/bicubic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/core/variants.h"
#include "retalho/terrain/bicubic_rows.h"
#include "retalho/terrain/spline_tangents.h"

namespace retalho {
namespace {

std::size_t cell_of(const BicubicGrid& grid, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
}

template <class Row>
void for_rows(RowRange rows, const Context& context, const Row& row) {
  parallel_chunks(static_cast<std::size_t>(rows.last - rows.first), 64, context, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) row(rows.first + static_cast<int>(i));
  });
}

/// The mean, over the cells around the sample, of the twist of the cell's own Coons blend.
double adini_twist(const BicubicGrid& g, int column, int row) {
  double sum = 0;
  int cells = 0;
  for (int dv = -1; dv <= 1; dv += 2)
    for (int du = -1; du <= 1; du += 2) {
      const int left = column + std::min(du, 0), top = row + std::min(dv, 0);
      if (left < 0 || top < 0 || left + 1 >= g.columns || top + 1 >= g.rows || !g.has_patch(left, top)) continue;
      const std::size_t here = cell_of(g, column, row), beside = cell_of(g, column + du, row),
                        below = cell_of(g, column, row + dv), across = cell_of(g, column + du, row + dv);
      sum += du * (g.zv[beside] - g.zv[here]) + dv * (g.zu[below] - g.zu[here]) -
             du * dv * (g.z[across] - g.z[beside] - g.z[below] + g.z[here]);
      ++cells;
    }
  return cells == 0 ? 0 : sum / cells;
}

/// flatten_tangents of one row without voids, whose neighbours are `above` and `below`; at the grid's border both are
/// the one that there is.
RETALHO_VARIANTS
void flatten_row(const double* above, const double* z, const double* below, std::size_t n, double* zu, double* zv,
                 double* zuv) {
  const auto flatten = [&](std::size_t c, bool flat_u) {
    const bool flat_v = z[c] == above[c] || z[c] == below[c];
    zu[c] = flat_u ? 0 : zu[c];
    zv[c] = flat_v ? 0 : zv[c];
    zuv[c] = flat_u || flat_v ? 0 : zuv[c];
  };
  flatten(0, z[0] == z[1]);
  for (std::size_t c = 1; c + 1 < n; ++c) flatten(c, z[c] == z[c - 1] || z[c] == z[c + 1]);
  flatten(n - 1, z[n - 1] == z[n - 2]);
}

void flatten_tangents(BicubicGrid& g, RowRange rows, const Context& context) {
  for_rows(rows, context, [&](int r) {
    if (g.valid.empty() && g.columns >= 2 && g.rows >= 2) {
      const std::size_t here = cell_of(g, 0, r), above = cell_of(g, 0, r > 0 ? r - 1 : r + 1),
                        below = cell_of(g, 0, r + 1 < g.rows ? r + 1 : r - 1);
      return flatten_row(&g.z[above], &g.z[here], &g.z[below], static_cast<std::size_t>(g.columns), &g.zu[here],
                         &g.zv[here], &g.zuv[here]);
    }
    for (int c = 0; c < g.columns; ++c) {
      const std::size_t here = cell_of(g, c, r);
      if (!g.has_sample(c, r)) continue;
      const auto same = [&](int column, int row) {
        return column >= 0 && row >= 0 && column < g.columns && row < g.rows && g.has_sample(column, row) &&
               g.z[cell_of(g, column, row)] == g.z[here];
      };
      const bool flat_u = same(c - 1, r) || same(c + 1, r), flat_v = same(c, r - 1) || same(c, r + 1);
      if (flat_u) g.zu[here] = 0;
      if (flat_v) g.zv[here] = 0;
      if (flat_u || flat_v) g.zuv[here] = 0;
    }
  });
}

/// n heights, 0 where there is none; is there such a one?
template <class T>
RETALHO_VARIANTS bool take_heights(const T* from, std::size_t n, double* to) {
  std::uint64_t voids = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto h = static_cast<double>(from[i]);
    voids |= h == h ? 0U : 1U;
    to[i] = h == h ? h : 0;
  }
  return voids != 0;
}

/// Rows [first, last) of the raster as the grid's samples.
void take_rows(const Raster& raster, int first, int last, BicubicGrid& g) {
  g.columns = raster.columns;
  g.rows = last - first;
  g.cell_width = raster.cell_width;
  g.cell_height = raster.cell_height;
  const std::size_t n = static_cast<std::size_t>(g.columns) * static_cast<std::size_t>(g.rows);
  for (std::vector<double>* values : {&g.z, &g.zu, &g.zv, &g.zuv}) values->resize(n);
  bool voids = false;
  std::visit([&](const auto& heights) { voids = take_heights(heights.data() + raster.index(0, first), n, g.z.data()); },
             raster.heights);
  g.valid = {};
  if (!voids) return;
  g.valid = Mask(g.columns, g.rows, false);
  for (int r = 0; r < g.rows; ++r)
    for (int c = 0; c < g.columns; ++c)
      if (raster.valid(c, first + r)) g.valid.set(c, r, true);
}

/// Sets the tangents and twists of `rows`. What lies beyond may hold anything afterwards.
void set_tangents(BicubicGrid& g, RowRange rows, const BicubicOptions& options, const Context& context) {
  const GridShape shape{g.columns, g.rows};
  // A twist asks the tangents beside it (Adini), or those along its column (spline).
  const auto around = [&](int reach) {
    return RowRange{std::max(0, rows.first - reach), std::min(g.rows, rows.last + reach)};
  };
  const RowRange beside = around(options.twist == Twist::adini ? 1 : 0);
  context.report("spline", 0);
  tangents_along_rows(g.z, shape, g.valid, options.ends, options.twist == Twist::spline ? around(kSplineHalo) : beside,
                      g.zu, context);
  context.report("spline", 0.3);
  tangents_along_columns(g.z, shape, g.valid, options.ends, beside, g.zv, context);
  context.report("spline", 0.6);
  if (options.twist == Twist::spline) {
    tangents_along_columns(g.zu, shape, g.valid, options.ends, rows, g.zuv, context);
  } else {
    const bool adini = options.twist == Twist::adini;
    for_rows(rows, context, [&](int r) {
      for (int c = 0; c < g.columns; ++c)
        g.zuv[cell_of(g, c, r)] = adini && g.has_sample(c, r) ? adini_twist(g, c, r) : 0;
    });
  }
  if (options.keep_flats) flatten_tangents(g, rows, context);
  context.report("spline", 1);
}

}  // namespace

BicubicGrid make_bicubic(const Raster& raster, const BicubicOptions& options, const Context& context) {
  check_bicubic(raster);
  BicubicGrid g;
  take_rows(raster, 0, raster.rows, g);
  g.georef = raster.georef;
  set_tangents(g, {0, g.rows}, options, context);
  return g;
}

int make_bicubic_rows(const Raster& raster, int first, int last, const BicubicOptions& options, BicubicGrid& g,
                      const Context& context) {
  // One row more than a tangent asks: Adini's twist asks the tangents of the rows beside.
  const int above = std::max(0, first - kSplineHalo - 1), below = std::min(raster.rows, last + kSplineHalo + 1);
  take_rows(raster, above, below, g);
  set_tangents(g, {first - above, last - above}, options, context);
  return above;
}

void check_bicubic(const Raster& raster) {
  if (raster.columns < 2 || raster.rows < 2)
    throw BadInput(fmt::format("a bicubic surface needs at least 2 x 2 samples; this grid has {} x {}", raster.columns,
                               raster.rows));
}

std::array<double, 16> BicubicGrid::patch(int column, int row) const {
  std::array<double, 16> b{};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const std::size_t n = cell_of(*this, column + j, row + i);
      const double along_u = (j != 0 ? -zu[n] : zu[n]) / 3, along_v = (i != 0 ? -zv[n] : zv[n]) / 3;
      const double mixed = (i != j ? -zuv[n] : zuv[n]) / 9;
      const auto corner_row = static_cast<std::size_t>(12 * i), corner_column = static_cast<std::size_t>(3 * j);
      const auto inner_row = static_cast<std::size_t>(i != 0 ? 8 : 4);
      const auto inner_column = static_cast<std::size_t>(j != 0 ? 2 : 1);
      b[corner_row + corner_column] = z[n];
      b[corner_row + inner_column] = z[n] + along_u;
      b[inner_row + corner_column] = z[n] + along_v;
      b[inner_row + inner_column] = z[n] + along_u + along_v + mixed;
    }
  return b;
}

std::optional<Jet> BicubicGrid::at(Vec2 local) const {
  const double x = local.x / cell_width, y = -local.y / cell_height;
  if (!(x >= 0 && y >= 0 && x <= columns - 1 && y <= rows - 1)) return {};
  const int c = std::min(static_cast<int>(x), columns - 2), r = std::min(static_cast<int>(y), rows - 2);
  if (!has_patch(c, r)) return {};
  const auto basis = [](double t) {
    const double s = 1 - t;
    return std::array<std::array<double, 4>, 3>{{{s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t},
                                                 {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t},
                                                 {6 * s, 6 * t - 12 * s, 6 * s - 12 * t, 6 * t}}};
  };
  const auto u = basis(x - c), v = basis(y - r);
  const std::array<double, 16> b = patch(c, r);
  const auto sum = [&](std::size_t du, std::size_t dv) {
    double total = 0;
    for (std::size_t i = 0; i < 4; ++i)
      total += v[dv][i] *
               (u[du][0] * b[4 * i] + u[du][1] * b[4 * i + 1] + u[du][2] * b[4 * i + 2] + u[du][3] * b[4 * i + 3]);
    return total;
  };
  Jet jet;
  jet.value = sum(0, 0);
  jet.gradient = {sum(1, 0) / cell_width, -sum(0, 1) / cell_height};
  jet.xx = sum(2, 0) / (cell_width * cell_width);
  jet.xy = -sum(1, 1) / (cell_width * cell_height);
  jet.yy = sum(0, 2) / (cell_height * cell_height);
  return jet;
}

const char* twist_name(Twist twist) {
  return twist == Twist::zero ? "zero" : twist == Twist::adini ? "adini" : "spline";
}

std::optional<Twist> parse_twist(std::string_view name) {
  for (const Twist twist : {Twist::zero, Twist::adini, Twist::spline})
    if (name == twist_name(twist)) return twist;
  return {};
}

}  // namespace retalho
