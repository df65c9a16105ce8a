#include "retalho/level/fixed_grid.h"

#include <algorithm>
#include <cmath>

#include "retalho/core/parallel.h"
#include "retalho/level/fixed_levels.h"

namespace retalho {

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
  parallel_chunks(n, kGrain, context, [&](std::size_t from, std::size_t to) {
    double m = 0;
    for (std::size_t i = from; i < to; ++i)
      m = std::max(m,
                   std::abs(grid.z[i]) + (std::abs(grid.zu[i]) + std::abs(grid.zv[i])) / 3 + std::abs(grid.zuv[i]) / 9);
    largest[from / kGrain] = m;
  });
  const double size = largest.empty() ? 0 : *std::max_element(largest.begin(), largest.end());
  f.per_unit = quanta_per_unit(size);
  f.z.resize(n);
  f.u.resize(n);
  f.v.resize(n);
  f.t.resize(n);
  parallel_chunks(n, kGrain, context, [&](std::size_t from, std::size_t to) {
    const auto fixed = [&](double x) { return static_cast<std::int32_t>(std::nearbyint(x)); };
    for (std::size_t i = from; i < to; ++i) {
      f.z[i] = fixed(grid.z[i] * f.per_unit);
      f.u[i] = fixed(grid.zu[i] * (f.per_unit / 3));
      f.v[i] = fixed(grid.zv[i] * (f.per_unit / 3));
      f.t[i] = fixed(grid.zuv[i] * (f.per_unit / 9));
    }
  });
  return f;
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
