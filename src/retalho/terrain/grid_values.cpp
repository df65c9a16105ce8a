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

Corners corners_of(const Tin& tin, std::uint32_t triangle) {
  const auto& v = tin.triangles[triangle];
  return {tin.points[v[0]], tin.points[v[1]], tin.points[v[2]]};
}

/// For each band of rows the triangles that touch it, ascending.
struct Bands {
  std::vector<RowRange> rows;  // of each triangle
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> triangles;
};

Bands sort_into_bands(const Tin& tin, const RowGrid& grid, const Context& context) {
  Bands bands;
  std::vector<RowRange>& ranges = bands.rows;
  ranges.resize(tin.triangle_count());
  parallel_chunks(ranges.size(), 16384, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t)
      ranges[t] = row_range(corners_of(tin, static_cast<std::uint32_t>(t)), grid, 1 / grid.step.y);
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

/// The numbers of a TIN's triangles often jump about; what lies ahead in the list is asked for in time.
template <class Element>
void prefetch(const Tin& tin, const std::vector<TriangleRecord<Element>>& records,
              std::span<const std::uint32_t> triangles, std::size_t k) {
  if (k + 8 < triangles.size()) __builtin_prefetch(&tin.triangles[triangles[k + 8]]);
  if (k + 4 >= triangles.size()) return;
  const std::uint32_t t = triangles[k + 4];
  for (const std::uint32_t v : tin.triangles[t]) __builtin_prefetch(&tin.points[v]);
  const char* record = reinterpret_cast<const char*>(&records[t]);
  for (std::size_t line = 0; line < sizeof records[t]; line += 64) __builtin_prefetch(record + line);
}

/// Heights and gradients of the triangles, in their order, on the rows first_row..last_row.
template <class Element>
void fill_rows(const Tin& tin, const std::vector<TriangleRecord<Element>>& records, const Bands& bands,
               std::size_t band, const Target& target, int first_row, int last_row) {
  const RowGrid& grid = target.grid;
  const Vec2 cells_a_unit{1 / grid.step.x, 1 / grid.step.y};
  const std::span triangles(bands.triangles.begin() + static_cast<std::ptrdiff_t>(bands.begin[band]),
                            bands.triangles.begin() + static_cast<std::ptrdiff_t>(bands.begin[band + 1]));
  RowFan<Element> fan;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    prefetch(tin, records, triangles, k);
    const std::uint32_t t = triangles[k];
    const TriangleRecord<Element>& record = records[t];
    const Corners corners = corners_of(tin, t);
    const RowRange rows{std::max(bands.rows[t].first, first_row), std::min(bands.rows[t].last, last_row)};
    fan.begin(record, corners, grid, cells_a_unit.x);
    for_each_row_span(corners, grid, cells_a_unit.x, rows, [&](int row, int first, int last) {
      if (target.gradients.empty()) {
        fan.fill(row, grid.y(row), first, last, &target.out[target.cell(first, row)]);
        return;
      }
      for (int c = first; c <= last; ++c) {
        const Jet jet = element_jet(record, grid.at(c, row));
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
  const Bands bands = sort_into_bands(tin, target.grid, context);
  parallel_chunks(bands.begin.size() - 1, 1, context, [&](std::size_t band, std::size_t) {
    const int first_row = static_cast<int>(band) * kBand, last_row = std::min(rows, first_row + kBand) - 1;
    erase(target, target.cell(0, first_row), target.cell(0, last_row + 1));
    parts_->with_records(
        [&](const auto& records) { fill_rows(tin, records, bands, band, target, first_row, last_row); });
    if (!parts_->has_voids) return;
    for (int row = first_row; row <= last_row; ++row)
      for (int c = 0; c < columns; ++c)
        if (!parts_->cell_valid(target.grid.at(c, row))) erase(target, target.cell(c, row), target.cell(c, row) + 1);
  });
}

}  // namespace retalho
