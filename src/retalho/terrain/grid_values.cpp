// Rasters by scan conversion: rows in bands, the triangles of a band in the order of their numbers, so that of the
// triangles that hold a cell the one with the highest number has the last word, as in TerrainEvaluator::locate.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/terrain/evaluator_parts.h"
#include "retalho/terrain/row_spans.h"

namespace retalho {
namespace {

constexpr double kNoData = std::numeric_limits<double>::quiet_NaN();
constexpr int kBand = 32;  // rows

struct Target {
  RowGrid grid;
  std::span<double> out;
  std::span<Vec2> gradients;
};

/// For each band of rows the triangles that may touch it, ascending.
struct Bands {
  std::vector<std::size_t> begin;
  std::vector<std::uint32_t> triangles;
};

Bands sort_into_bands(const Tin& tin, const RowGrid& grid) {
  const auto bands = static_cast<std::size_t>((grid.rows + kBand - 1) / kBand);
  Bands result;
  result.begin.assign(bands + 1, 0);
  const auto each = [&](const auto& use) {
    for (std::uint32_t t = 0; t < tin.triangles.size(); ++t) {
      const RowRange rows = row_range(tin, t, grid);
      if (rows.first > rows.last) continue;
      for (int b = rows.first / kBand; b <= rows.last / kBand; ++b) use(static_cast<std::size_t>(b), t);
    }
  };
  each([&](std::size_t b, std::uint32_t) { ++result.begin[b + 1]; });
  for (std::size_t b = 0; b < bands; ++b) result.begin[b + 1] += result.begin[b];
  result.triangles.resize(result.begin.back());
  std::vector<std::size_t> next(result.begin.begin(), result.begin.end() - 1);
  each([&](std::size_t b, std::uint32_t t) { result.triangles[next[b]++] = t; });
  return result;
}

template <class Element>
void fill_span(const Element& element, const MacroTriangle& triangle, const Target& target, int row, int first,
               int last) {
  const std::size_t base = static_cast<std::size_t>(row) * static_cast<std::size_t>(target.grid.columns);
  for (int c = first; c <= last; ++c) {
    const Vec2 p = target.grid.at(c, row);
    const std::size_t cell = base + static_cast<std::size_t>(c);
    if (target.gradients.empty()) {
      target.out[cell] = element_value(element, triangle.barycentric(p));
    } else {
      const Jet jet = element_jet(element, triangle, p);
      target.out[cell] = jet.value;
      target.gradients[cell] = jet.gradient;
    }
  }
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
  const Bands bands = sort_into_bands(tin, target.grid);
  const auto fill_band = [&](std::size_t band) {
    const int first_row = static_cast<int>(band) * kBand, last_row = std::min(rows, first_row + kBand) - 1;
    const std::size_t width = static_cast<std::size_t>(columns);
    const std::size_t begin = static_cast<std::size_t>(first_row) * width,
                      end = static_cast<std::size_t>(last_row + 1) * width;
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(begin), out.begin() + static_cast<std::ptrdiff_t>(end),
              kNoData);
    if (!gradients.empty())
      std::fill(gradients.begin() + static_cast<std::ptrdiff_t>(begin),
                gradients.begin() + static_cast<std::ptrdiff_t>(end), Vec2{kNoData, kNoData});
    parts_->with_elements([&](const auto& elements) {
      for (std::size_t k = bands.begin[band]; k < bands.begin[band + 1]; ++k) {
        const std::uint32_t t = bands.triangles[k];
        const MacroTriangle triangle(tin, t);
        for_each_row_span(tin, t, target.grid, first_row, last_row, [&](int row, int first, int last) {
          fill_span(elements[t], triangle, target, row, first, last);
        });
      }
    });
    if (!parts_->has_voids) return;
    for (int row = first_row; row <= last_row; ++row)
      for (int c = 0; c < columns; ++c)
        if (!parts_->cell_valid(target.grid.at(c, row))) {
          const std::size_t cell = static_cast<std::size_t>(row) * width + static_cast<std::size_t>(c);
          out[cell] = kNoData;
          if (!gradients.empty()) gradients[cell] = {kNoData, kNoData};
        }
  };
  parallel_chunks(bands.begin.size() - 1, 1, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) fill_band(b);
  });
}

}  // namespace retalho
