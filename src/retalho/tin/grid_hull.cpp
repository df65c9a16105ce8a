#include "retalho/tin/grid_hull.h"

#include <fmt/format.h>

#include <cmath>

#include "retalho/core/error.h"

namespace retalho::greedy {

std::vector<Cell> hull_of_valid(const Raster& raster) {
  if (raster.columns > 65535 || raster.rows > 65535)
    throw BadInput(fmt::format("the grid has {} x {} cells; a side may have 65,535: cut it into tiles", raster.columns,
                               raster.rows));
  std::vector<Cell> ends;  // first and last valid cell of each row
  for (int y = 0; y < raster.rows; ++y) {
    int first = 0, last = raster.columns - 1;
    while (first < raster.columns && !raster.valid(first, y)) ++first;
    if (first == raster.columns) continue;
    while (!raster.valid(last, y)) --last;
    ends.push_back(cell_at(first, y));
    if (last != first) ends.push_back(cell_at(last, y));
  }
  if (ends.empty()) throw BadInput("no area: the grid holds no valid cell");
  std::vector<Cell> hull;
  for (int pass = 0; pass < 2; ++pass) {  // down one side, up the other
    const std::size_t start = hull.size();
    for (const Cell c : ends) {
      while (hull.size() >= start + 2 && area2(hull[hull.size() - 2], hull.back(), c) <= 0) hull.pop_back();
      hull.push_back(c);
    }
    hull.pop_back();
    std::reverse(ends.begin(), ends.end());
  }
  if (hull.size() < 3)
    throw BadInput("no area: the valid cells lie on one line; a triangulation needs three that do not");
  return hull;
}

Cell worst_on_side(const Raster& raster, Cell a, Cell b, double tolerance) {
  const Cell low = std::min(a, b), high = std::max(a, b);
  const int dx = column_of(high) > column_of(low) ? 1 : 0, dy = row_of(high) > row_of(low) ? 1 : 0;
  const int n = column_of(high) - column_of(low) + row_of(high) - row_of(low);
  const auto height = [&](Cell c) { return raster.at(column_of(c), row_of(c)); };
  const double z0 = height(low), rise = height(high) - z0;
  double worst = 0, largest = std::max(std::abs(z0), std::abs(z0 + rise));
  Cell at = a;
  // Integers are compared exactly; elsewhere a hair under the tolerance, so that a checker that rounds differently
  // agrees, but nothing smaller than rounding. Which it is must follow from this side alone.
  bool integers = z0 == std::floor(z0) && rise == std::floor(rise);
  for (int i = 1; i < n; ++i) {
    const Cell c = cell_at(column_of(low) + dx * i, row_of(low) + dy * i);
    const double z = height(c);
    if (std::isnan(z)) continue;
    integers = integers && z == std::floor(z);
    largest = std::max(largest, std::abs(z));
    const double error = std::abs((z - z0) * n - rise * i);
    if (error > worst) {
      worst = error;
      at = c;
    }
  }
  const double rounding = largest * 0x1p-48;
  const double limit =
      (integers ? tolerance : std::max(tolerance - std::max(tolerance * 0x1p-40, rounding), rounding)) * n;
  return worst > limit ? at : a;
}

}  // namespace retalho::greedy
