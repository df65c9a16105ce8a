// Rasters by scan conversion: rows in bands, the triangles of a band in the order of their numbers, so that of the
// triangles that hold a cell the one with the highest number has the last word, as in TerrainEvaluator::locate.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/terrain/evaluator_parts.h"
#include "retalho/terrain/row_fan.h"
#include "retalho/terrain/row_spans.h"

namespace retalho {
namespace {

constexpr double kNoData = std::numeric_limits<double>::quiet_NaN();
constexpr int kBand = 32;  // rows

struct Target {
  RowGrid grid;
  std::span<double> out;
  std::span<Vec2> gradients;

  std::size_t cell(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) + static_cast<std::size_t>(column);
  }
};

/// For each band of rows the triangles that touch it, ascending.
struct Bands {
  std::vector<RowRange> rows;  // of each triangle
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> triangles;
};

Bands sort_into_bands(const PointLocator& locator, std::size_t triangles, const RowGrid& grid, const Context& context) {
  Bands bands;
  std::vector<RowRange>& ranges = bands.rows;
  ranges.resize(triangles);
  parallel_chunks(ranges.size(), 16384, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      ranges[t] = row_range(locator.facet(static_cast<std::uint32_t>(t)).corners, grid, 1 / grid.step.y);
  });
  bands.begin.assign(static_cast<std::size_t>((grid.rows + kBand - 1) / kBand) + 1, 0);
  const auto each = [&](const auto& use) {
    for (std::uint32_t t = 0; t < ranges.size(); ++t)
      if (ranges[t].first <= ranges[t].last)
        for (int b = ranges[t].first / kBand; b <= ranges[t].last / kBand; ++b) use(static_cast<std::size_t>(b), t);
  };
  each([&](std::size_t b, std::uint32_t) { ++bands.begin[b + 1]; });
  for (std::size_t b = 1; b < bands.begin.size(); ++b) bands.begin[b] += bands.begin[b - 1];
  bands.triangles.resize(bands.begin.back());
  std::vector<std::size_t> next(bands.begin.begin(), bands.begin.end() - 1);
  each([&](std::size_t b, std::uint32_t t) { bands.triangles[next[b]++] = t; });
  return bands;
}

/// Heights and gradients of the triangles, in their order, on the rows first_row..last_row.
template <class Element>
void fill_rows(const PointLocator& locator, const std::vector<Element>& elements, const Bands& bands, std::size_t band,
               const Target& target, int first_row, int last_row) {
  const RowGrid& grid = target.grid;
  const Vec2 cells_a_unit{1 / grid.step.x, 1 / grid.step.y};
  const std::span triangles(bands.triangles.begin() + static_cast<std::ptrdiff_t>(bands.begin[band]),
                            bands.triangles.begin() + static_cast<std::ptrdiff_t>(bands.begin[band + 1]));
  RowFan<Element> fan;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    // The numbers of a TIN's triangles may jump about: what lies ahead in the list is asked for in time.
    if (k + 4 < triangles.size()) {
      __builtin_prefetch(&locator.facet(triangles[k + 4]));
      prefetch(elements[triangles[k + 4]]);
    }
    const std::uint32_t t = triangles[k];
    const Element& element = elements[t];
    const Corners& corners = locator.facet(t).corners;
    const MacroTriangle triangle(corners);
    const RowRange rows{std::max(bands.rows[t].first, first_row), std::min(bands.rows[t].last, last_row)};
    fan.begin(element, triangle, corners, grid, cells_a_unit.x);
    for_each_row_span(corners, grid, cells_a_unit.x, rows, [&](int row, int first, int last) {
      if (target.gradients.empty()) {
        fan.fill(row, grid.y(row), first, last, &target.out[target.cell(first, row)]);
        return;
      }
      for (int c = first; c <= last; ++c) {
        const Jet jet = element_jet(element, triangle, grid.at(c, row));
        target.out[target.cell(c, row)] = jet.value;
        target.gradients[target.cell(c, row)] = jet.gradient;
      }
    });
  }
}

void erase(const Target& target, std::size_t begin, std::size_t end) {
  std::fill(target.out.begin() + static_cast<std::ptrdiff_t>(begin),
            target.out.begin() + static_cast<std::ptrdiff_t>(end), kNoData);
  if (!target.gradients.empty())
    std::fill(target.gradients.begin() + static_cast<std::ptrdiff_t>(begin),
              target.gradients.begin() + static_cast<std::ptrdiff_t>(end), Vec2{kNoData, kNoData});
}

}  // namespace

void TerrainEvaluator::grid_values(Vec2 origin, Vec2 step, int columns, int rows, std::span<double> out,
                                   std::span<Vec2> gradients, const Context& context) const {
  if (columns < 0 || rows < 0 || !(step.x > 0) || !(step.y > 0))
    throw UsageError(fmt::format("grid_values: {} x {} cells with steps {} and {}; steps must be positive", columns,
                                 rows, step.x, step.y));
  const std::size_t cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  if (out.size() != cells || (!gradients.empty() && gradients.size() != cells))
    throw UsageError(fmt::format("grid_values: {} cells, but room for {} heights and {} gradients", cells, out.size(),
                                 gradients.size()));
  const Tin& tin = parts_->terrain.tin;
  const Target target{{origin, step, columns, rows}, out, gradients};
  const Bands bands = sort_into_bands(parts_->locator, tin.triangle_count(), target.grid, context);
  parallel_chunks(bands.begin.size() - 1, 1, context, [&](std::size_t band, std::size_t) {
    const int first_row = static_cast<int>(band) * kBand, last_row = std::min(rows, first_row + kBand) - 1;
    erase(target, target.cell(0, first_row), target.cell(0, last_row + 1));
    parts_->with_elements(
        [&](const auto& elements) { fill_rows(parts_->locator, elements, bands, band, target, first_row, last_row); });
    if (!parts_->has_voids) return;
    for (int row = first_row; row <= last_row; ++row)
      for (int c = 0; c < columns; ++c)
        if (!parts_->cell_valid(target.grid.at(c, row))) erase(target, target.cell(c, row), target.cell(c, row) + 1);
  });
}

}  // namespace retalho
