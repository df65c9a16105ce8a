#include "retalho/model/compact.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/model/compact_file.h"
#include "retalho/model/compact_tolerance.h"
#include "retalho/model/fit_source.h"
#include "retalho/terrain/folded_surface.h"
#include "retalho/terrain/held_fit.h"
#include "retalho/terrain/report.h"

namespace retalho {
namespace {

using greedy::Cell;

constexpr double kTight = 1e-6;         // of the fit's residual
constexpr double kMostSteps = 1 << 26;  // over the range of the heights

void check(const CompactOptions& o) {
  if (o.surface != SurfaceKind::linear && o.surface != SurfaceKind::clough_tocher)
    throw UsageError(
        fmt::format("the compact form holds linear and Clough-Tocher surfaces, not {}", surface_name(o.surface)), {},
        "surface");
  if (o.heights_only && o.surface == SurfaceKind::linear)
    throw UsageError("a linear surface has heights only as it is", {}, "heights_only");
  if (!(o.max_error >= 0) || std::isinf(o.max_error))
    throw UsageError(fmt::format("the largest error must be 0 or more, not {}", o.max_error), {}, "max_error");
  if (!(o.height_step >= 0) || std::isinf(o.height_step))
    throw UsageError(fmt::format("the height step must be 0 or more, not {}", o.height_step), {}, "height_step");
  if (o.folds.value_or(false) && (o.surface == SurfaceKind::linear || o.heights_only))
    throw UsageError("only vertices with gradients of their own can be folded", {}, "folds");
  if (!(o.slope_weight >= 0) || std::isinf(o.slope_weight))
    throw UsageError(fmt::format("the slope weight must be 0 or more, not {}", o.slope_weight), {}, "slope_weight");
}

/// Two digits: a step in three bytes of header.
double short_number(double value, int digits) {
  double result = value;
  const std::string text = fmt::format("{:.{}e}", value, digits - 1);
  std::from_chars(text.data(), text.data() + text.size(), result);
  return result;
}

std::vector<Cell> cells_of(const Terrain& terrain, const Raster& raster) {
  std::vector<Cell> cells;
  for (const Vec2 p : terrain.tin.points) {
    const double column = std::nearbyint(p.x / raster.cell_width), row = std::nearbyint(-p.y / raster.cell_height);
    if (!(column >= 0 && column < raster.columns && row >= 0 && row < raster.rows) ||
        std::abs(column - p.x / raster.cell_width) > 1e-6 || std::abs(row + p.y / raster.cell_height) > 1e-6)
      throw BadInput("this terrain has no compact form: a vertex is no cell of the grid");
    cells.push_back(greedy::cell_at(static_cast<int>(column), static_cast<int>(row)));
  }
  std::sort(cells.begin(), cells.end());
  if (std::adjacent_find(cells.begin(), cells.end()) != cells.end())
    throw BadInput("this terrain has no compact form: two vertices lie in one cell");
  return cells;
}

CompactFrameFacts facts_of(const Raster& raster, const CompactOptions& options) {
  CompactFrameFacts facts;
  facts.kind = options.surface;
  facts.heights_only = options.heights_only;
  facts.georef = raster.georef;
  facts.grid = {raster.columns, raster.rows, raster.cell_width, raster.cell_height, {}};
  if (Mask valid = valid_mask(raster); valid.count() < raster.cells()) facts.grid.valid = std::move(valid);
  facts.tolerance = options.max_error;
  return facts;
}

HeldFitOptions fit_options(const CompactOptions& options) {
  return {.surface = options.surface,
          .heights_only = options.heights_only,
          .slope_weight = options.heights_only ? 0 : options.slope_weight};
}

double rmse_of(const std::vector<double>& errors) {
  double sum = 0;
  std::size_t count = 0;
  for (const double e : errors)
    if (!std::isnan(e)) {
      sum += e * e;
      ++count;
    }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, count)));
}

/// The step and the reference, rounded to what is short to write.
void set_steps(CompactFrameFacts& facts, double step, double mean, std::size_t vertices) {
  const double star = static_cast<double>(facts.grid.columns) * facts.grid.rows / static_cast<double>(vertices);
  facts.steps.height = short_number(step * std::pow(star, facts.steps.crowding / 16.0), 2);
  facts.reference = short_number(std::round(mean / step) * step, 4);
}

CompactModel by_budget(const FoldedVertices& vertices, const Raster& raster, const CompactOptions& options,
                       const Context& context) {
  constexpr double kStep = 1.5;  // of the fit's error
  CompactFrameFacts facts = facts_of(raster, options);
  HeldFit fit(raster, vertices.cells, fit_options(options), context, vertices.folded);
  fit.solve(kTight);
  const double step = options.height_step > 0 ? options.height_step : kStep * rmse_of(fit.errors());
  const RasterSummary summary = summarize(raster);
  const double range = summary.maximum - summary.minimum;
  const double least = range > 0 ? range / kMostSteps : 1;
  set_steps(facts, std::max(step, least), summary.mean, vertices.cells.size());
  FitSource source(fit);
  CompactEncoding encoding = encode_compact(facts, vertices.cells, source, context, vertices.folded);
  return {std::move(encoding.bytes), std::move(encoding.terrain)};
}

/// Roundings that are tried, of which the smallest file counts: none is the best on every grid.
struct Rounding {
  double height;       // of the tolerance
  std::uint8_t slope;  // as in CompactSteps
};
constexpr Rounding kSmooth[] = {{0.4, 20}, {0.5, 20}, {0.6, 15}}, kFlat[] = {{0.5, 20}, {0.65, 20}};

CompactModel by_tolerance(const FoldedVertices& vertices, const Raster& raster, const CompactOptions& options,
                          const Context& context) {
  const RasterSummary summary = summarize(raster);
  if (options.max_error * kMostSteps < summary.maximum - summary.minimum)
    throw BadInput(fmt::format("a largest error of {} is too small for heights from {} to {}: the compact form counts "
                               "up to {} steps",
                               options.max_error, summary.minimum, summary.maximum, kMostSteps),
                   {}, "max_error");
  CompactFrameFacts facts = facts_of(raster, options);
  // Half a step must stay under the tolerance, for the smallest star too (half a cell).
  const double mean_star = static_cast<double>(raster.cells()) / static_cast<double>(vertices.cells.size());
  const auto coarsest = [&](double step, int crowding) { return step * std::pow(2 * mean_star, crowding / 16.0); };
  CompactModel best;
  const auto attempt = [&](double step, double margin) {
    facts.steps.crowding = coarsest(step, 2) < 1.8 * options.max_error ? 2 : 0;
    set_steps(facts, step, summary.mean, vertices.cells.size());
    CompactEncoding made =
        encode_within(options.max_error * (1 - margin), vertices, raster, facts, fit_options(options), context);
    if (assess(made.terrain, raster, options.max_error, context).violations > 0) return;
    if (best.bytes.empty() || made.bytes.size() < best.bytes.size())
      best = {std::move(made.bytes), std::move(made.terrain)};
  };
  const std::span<const Rounding> roundings =
      options.surface == SurfaceKind::linear ? std::span<const Rounding>(kFlat) : std::span<const Rounding>(kSmooth);
  // The report's own scan judges; should it see an error that rounding hid here, the goal is tightened.
  for (double margin = 1e-9; best.bytes.empty(); margin *= 100) {
    if (margin > 0.1) throw Error(Error::Kind::internal, "the compact form does not reach its tolerance");
    for (const Rounding& r : roundings) {
      facts.steps.slope = r.slope;
      if (options.height_step == 0) attempt(r.height * options.max_error, margin);
    }
    if (options.height_step > 0) attempt(std::min(options.height_step, options.max_error), margin);
  }
  return best;
}

}  // namespace

CompactModel compact_terrain(const Terrain& terrain, const Raster& raster, const CompactOptions& options,
                             const Context& context) {
  if (!terrain.creases.empty()) throw UsageError("the compact form has no place for creases: save the exact model");
  check(options);
  return by_budget({cells_of(terrain, raster), {}}, raster, options, context);
}

CompactModel fit_compact(const Raster& raster, const CompactOptions& options, const Context& context) {
  check(options);
  if ((options.max_error > 0) == (options.vertices > 0))
    throw UsageError("the compact form is refined to a largest error or to a number of vertices: give one of them");
  if (options.heights_only && options.max_error > 0)
    throw UsageError("heights alone are refined to a number of vertices, not to a largest error", {}, "max_error");
  // Vertices of a surface whose gradients follow its heights: those of the flat one are the best that are known.
  const SurfaceKind placed = options.heights_only ? SurfaceKind::linear : options.surface;
  const SurfaceRefineOptions refined{.surface = placed,
                                     .max_error = options.max_error,
                                     .vertices = options.vertices,
                                     .slope_weight = options.slope_weight};
  const SurfaceRefineOptions wanted = with_effort(refined, options.effort);
  const bool folds = options.folds.value_or(options.max_error > 0) && placed == SurfaceKind::clough_tocher;
  const FoldedVertices vertices = folds ? refine_folded(raster, wanted, context)
                                        : FoldedVertices{cells_of(refine_surface(raster, wanted, context), raster), {}};
  return options.max_error > 0 ? by_tolerance(vertices, raster, options, context)
                               : by_budget(vertices, raster, options, context);
}

}  // namespace retalho
