// retalho fit: an elevation grid or survey points to a terrain model, and its error report.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "breaklines.h"
#include "fit_tiles.h"
#include "fitting.h"
#include "inputs.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/core/memory.h"
#include "retalho/model/model.h"
#include "retalho/terrain/crease_lines.h"
#include "retalho/terrain/point_report.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tin/refine.h"
#include "retalho/tin/scattered.h"
#include "table.h"

namespace retalho::app {
namespace {

struct Options {
  std::string input, output;
  GridFlags grid;
  PointOptions points;
  BreaklineFlags breaklines;
  BudgetFlags budget;
  SurfaceFlags surface;
  TileFlags tiles;
};

struct Fit {
  Terrain terrain;
  ErrorReport errors;
  bool has_slope = true;
  double seconds_triangulation = 0;
  std::string compact;  ///< the file's bytes, with --format compact
};

/// What is known before: the vertices of a budget. Of a tolerance they are not.
Need need_of(const Options& options, double a_vertex) {
  Need need{"fitting", 0, 0};
  if (options.budget.vertices) need.more = a_vertex * static_cast<double>(*options.budget.vertices);
  if (!options.budget.ratio.empty()) need.a_cell = a_vertex * parse_ratio("--ratio", options.budget.ratio);
  return need;
}

Fit fit_compactly(const Program& program, const Options& options, const Context& context) {
  const std::vector<CompactOptions> kinds = compact_options(options.surface, false);
  RasterSummary summary;
  const Raster raster =
      load_grid(program, options.input, options.grid, summary, context, need_of(options, kVertexLeastSquares));
  const Budget budget =
      resolve(program, options.budget, summary.valid, summary.valid > 0 ? summary.maximum - summary.minimum : 0);
  if (budget.tolerance && budget.max_error == 0)
    throw UsageError("--format compact takes a --max-error over 0", {}, "--max-error");
  if (kinds.size() > 1 && budget.max_error == 0)
    throw UsageError("--surface auto chooses among files of the same error: give --max-error", {}, "--surface");
  Fit best;
  const Stopwatch watch;
  for (CompactOptions kind : kinds) {
    kind.max_error = budget.max_error;
    kind.vertices = budget.vertices;
    CompactModel model = fit_compact(raster, kind, context);
    if (kinds.size() > 1) program.say(fmt::format("{}: {} bytes", surface_name(kind.surface), model.bytes.size()));
    if (!best.compact.empty() && best.compact.size() <= model.bytes.size()) continue;
    best.compact = std::move(model.bytes);
  }
  best.seconds_triangulation = watch.seconds();
  best.terrain = std::get<Terrain>(decode_model(best.compact));  // judged by what is in the file
  best.errors = assess(best.terrain, raster, budget.max_error, context);
  return best;
}

/// Vertices chosen by the surface's own error, with creases as asked for.
Terrain refine(const Program& program, const Options& options, const Raster& raster, SurfaceKind kind,
               const Budget& budget, const Context& context) {
  const CreaseKind creases = resolve_creases(options.surface, options.budget, false);
  const bool heights_only = resolve_fit(options.surface, false) == FitKind::z_only;
  const SurfaceRefineOptions how = with_effort({.surface = kind,
                                                .max_error = budget.max_error,
                                                .vertices = budget.vertices,
                                                .heights_only = heights_only,
                                                .creases = creases == CreaseKind::chosen},
                                               resolve_effort(options.surface));
  if (creases != CreaseKind::lines) return refine_surface(raster, how, context);
  const std::string& file = options.surface.creases;
  const auto lines = read_crease_lines(raster.georef, options.input, file, options.surface.crease_layer, context);
  CreaseLineNotes notes;
  Terrain terrain = refine_along_lines(raster, lines, how, &notes, context);
  program.say(fmt::format("{}: {} lines inside the grid with {} vertices, {} edges along them", file, notes.lines,
                          notes.vertices, notes.edges));
  return terrain;
}

Fit fit_grid(const Program& program, const Options& options, const SurfaceOptions& surface, const Context& context) {
  const bool fitted = refines_surface(options.surface, options.budget, false) ||
                      resolve_fit(options.surface, false) != FitKind::interpolate;
  RasterSummary summary;
  const Raster raster = load_grid(program, options.input, options.grid, summary, context,
                                  need_of(options, fitted ? kVertexLeastSquares : kVertexFitted));
  const double range = summary.valid > 0 ? summary.maximum - summary.minimum : 0;
  const Budget budget = resolve(program, options.budget, summary.valid, range);
  Fit fit;
  const Stopwatch watch;
  // A grid without a range (flat, one cell, all void) leaves nothing to choose: 1 % of it is no tolerance.
  const bool chosen = budget.max_error > 0 || budget.vertices > 0;
  if (chosen && refines_surface(options.surface, options.budget, false)) {
    fit.terrain = refine(program, options, raster, surface.surface, budget, context);
    fit.seconds_triangulation = watch.seconds();
  } else {
    Tin tin = refine_tin(raster, {budget.max_error, budget.vertices}, context);
    fit.seconds_triangulation = watch.seconds();
    // A tolerance's vertices are known only now: the surface, its report and its file come on top.
    check_memory(kProcessMemory + sizeof(float) * static_cast<double>(raster.cells()) +
                     (fitted ? kVertexLeastSquares : kVertexFitted) * static_cast<double>(tin.vertex_count()),
                 fmt::format("fitting {} vertices", tin.vertex_count()), options.input);
    fit.terrain = make_fitted(std::move(tin), raster, surface, resolve_fit(options.surface, false), context);
  }
  fit.terrain.tolerance = budget.max_error;
  fit.errors = assess(fit.terrain, raster, budget.max_error, context);
  return fit;
}

Fit fit_points(const Program& program, const Options& options, const SurfaceOptions& surface, const Context& context) {
  const PointCloud cloud = load_points(program, options.input, options.points, context);
  check_memory(kProcessMemory + kPointFitted * static_cast<double>(cloud.positions.size()),
               fmt::format("fitting {} points", cloud.positions.size()), options.input);
  Fit fit;
  const Stopwatch watch;
  ScatteredNotes notes;
  Tin tin;
  double tolerance = 0;
  std::vector<std::uint32_t> creases;
  if (options.budget.given()) {
    check_breakline_budget(options.breaklines, true);
    const PointSummary summary = summarize(cloud);
    const Budget budget =
        resolve(program, options.budget, cloud.positions.size(), summary.maximum.z - summary.minimum.z);
    tolerance = budget.max_error;
    tin = refine_points(cloud.positions, {budget.max_error, budget.vertices}, &notes, context);
  } else {
    program.say("every point becomes a vertex (--max-error, --vertices or --ratio keep fewer)");
    ConstrainedTin made = triangulate(program, cloud, options.input, options.breaklines, &notes, context);
    tin = std::move(made.tin);
    creases = std::move(made.edges);
  }
  fit.seconds_triangulation = watch.seconds();
  if (notes.repeated > 0)
    program.say(fmt::format("{} points repeat another's x, y: the mean height is taken (largest difference {:.6g})",
                            notes.repeated, notes.largest_spread));
  SurfaceOptions how = surface;
  how.creases = std::move(creases);
  fit.terrain = make_terrain(std::move(tin), cloud.georef, how, context);
  fit.terrain.tolerance = tolerance;
  fit.errors = assess_points(fit.terrain, cloud.positions, tolerance, context);
  fit.has_slope = false;
  return fit;
}

std::string report_text(const ModelReport& report, const nlohmann::ordered_json& json) {
  const ErrorReport& e = report.errors;
  std::vector<std::pair<std::string, std::string>> lines{
      {"surface", kind_text(report)},
      {"vertices", fmt::format("{}", report.vertices)},
      {"triangles", fmt::format("{}", report.triangles)},
      {"coefficients", fmt::format("{}", report.coefficients)},
      {"numbers", fmt::format("{}", report.numbers)},
      {"bytes", fmt::format("{}", report.bytes)},
      {"RMSE", number_text(e.rmse)},
      {"largest error", fmt::format("{:.6g} at {:.10g}, {:.10g}", e.max_error, e.max_error_at.x, e.max_error_at.y)}};
  if (const auto creases = json.at("creases").get<std::size_t>(); creases > 0)
    lines.emplace_back("creases", fmt::format("{}", creases));
  if (report.has_slope) lines.emplace_back("slope RMSE", number_text(e.slope_rmse));
  lines.emplace_back(report.has_slope ? "valid cells" : "places", fmt::format("{} of {}", e.valid_cells, e.cells));
  if (report.tolerance > 0)
    lines.emplace_back("over tolerance", fmt::format("{} (tolerance {:.6g})", e.violations, report.tolerance));
  lines.emplace_back("seconds", fmt::format("{:.2f} (triangulation {:.2f})", json.at("seconds").get<double>(),
                                            json.at("seconds_triangulation").get<double>()));
  return list_text(lines);
}

void run(const Program& program, const Options& options) {
  const Stopwatch watch;
  if (options.tiles.size) {
    if (!options.surface.creases.empty())
      throw UsageError("--creases takes no --tiles: edges at a seam would depend on both sides", {}, "--creases");
    if (takes_points(options.input, options.points)) throw UsageError("--tiles takes grids", {}, "--tiles");
    if (compact_format(options.surface))
      throw UsageError("--tiles writes exact models: leave --format compact out", {}, "--format");
    return fit_tiles(program, options.tiles, options.input, options.output, options.grid, options.budget,
                     options.surface);
  }
  if (options.tiles.jobs != 0) throw UsageError("--jobs goes with --tiles", {}, "--jobs");
  const bool from_points = takes_points(options.input, options.points), compact = compact_format(options.surface);
  check_breakline_flags(options.breaklines, from_points);
  resolve_creases(options.surface, options.budget, from_points);
  if (compact) compact_options(options.surface, from_points);
  const SurfaceOptions surface = compact ? SurfaceOptions{} : resolve(options.surface, from_points);
  const bool by_surface = compact || refines_surface(options.surface, options.budget, from_points);
  if (!compact) resolve_fit(options.surface, from_points);
  check_output(program, options.output, {".retalho"}, {options.input});
  const Context context = program.context();
  const Fit fit = compact       ? fit_compactly(program, options, context)
                  : from_points ? fit_points(program, options, surface, context)
                                : fit_grid(program, options, surface, context);
  context.check();
  if (compact)
    write_file(options.output, fit.compact, program.overwrite);
  else
    save_model(fit.terrain, options.output, program.overwrite);
  ModelReport report = facts_of(fit.terrain);
  report.bytes = std::filesystem::file_size(options.output);
  report.errors = fit.errors;
  report.has_slope = fit.has_slope;
  report.refined = by_surface;
  say_violations(program, report);
  nlohmann::ordered_json json = to_json(report);
  json["creases"] = fit.terrain.creases.size();
  json["seconds"] = watch.seconds();
  json["seconds_triangulation"] = fit.seconds_triangulation;
  if (program.json)
    program.print(json);
  else
    program.print(report_text(report, json));
}

}  // namespace

void add_fit(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(root, program, "fit", "An elevation grid or survey points to a terrain model, with its error report",
                  "retalho fit dem.tif -o dem.retalho --max-error 2\n"
                  "retalho fit dem.tif -o flat.retalho --surface linear --ratio 1%\n"
                  "retalho fit dem.tif -o best.retalho --ratio 1% --effort best\n"
                  "retalho fit dem.tif -o quick.retalho --max-error 2 --refine flat\n"
                  "retalho fit country.vrt -o country --tiles 2048 --max-error 1\n"
                  "retalho fit dem.tif -o small.retalho --max-error 2 --format compact\n"
                  "retalho fit survey.csv -o site.retalho --breaklines kerbs.gpkg\n"
                  "retalho fit soundings.xyz -o seabed.retalho --surface powell-sabin\n"
                  "retalho fit survey.gpkg --height-field elevation -o site.retalho --max-error 0.1");
  command->add_option("DEM", options->input, "Elevation grid, or points (.xyz .csv .ply, vector layers)")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", options->output, "The model, ending in .retalho; with --tiles a folder")
      ->required()
      ->type_name("FILE");
  add_budget_flags(*command, options->budget);
  add_surface_flags(*command, options->surface);
  add_crease_flags(*command, options->surface);
  add_tile_flags(*command, options->tiles);
  add_grid_flags(*command, options->grid);
  command
      ->add_option("--height-field", options->points.height_field, "Vector layers: the attribute that holds the height")
      ->type_name("NAME");
  command->add_option("--layer", options->points.layer, "Vector files: which layer")->type_name("NAME");
  add_breakline_flags(*command, options->breaklines);
  command->add_option("--crs", options->points.crs, "Points in formats without a CRS: theirs")->type_name("CRS");
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
