// retalho compare: models, or the kinds of surface on one triangulation, against the grid that they stand for.
#include <fmt/format.h>

#include "fitting.h"
#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/model/baselines.h"
#include "retalho/model/model.h"
#include "retalho/model/tiled.h"
#include "retalho/tiles/reader.h"
#include "retalho/tin/refine.h"
#include "table.h"
#include "visibility_errors.h"

namespace retalho::app {
namespace {

struct Options {
  std::string dem;
  std::vector<std::string> models;
  GridFlags grid;
  BudgetFlags budget;
  VisibilityFlags visibility;
  bool markdown = false, csv = false, baselines = false;
  TileMemoryFlag tile_memory;
};

std::vector<ModelReport> compare_fits(const Program& program, const Options& options, const Raster& raster,
                                      const RasterSummary& summary, VisibilityErrors* sight, const Context& context) {
  const double range = summary.valid > 0 ? summary.maximum - summary.minimum : 0;
  const Budget budget = resolve(program, options.budget, summary.valid, range);
  const Tin tin = refine_tin(raster, {budget.max_error, budget.vertices}, context);
  CompareMore more;
  if (sight != nullptr)
    more = [&](const Terrain& terrain, const ModelReport& report) { sight->add(terrain, report.name, context); };
  std::vector<ModelReport> reports = compare_kinds(tin, raster, budget.max_error, more, context);
  if (options.baselines)
    for (ModelReport& report : smooth_rivals(tin.vertex_count(), raster, context)) reports.push_back(std::move(report));
  return reports;
}

std::vector<ModelReport> compare_models(const Options& options, const Raster& raster, VisibilityErrors* sight,
                                        const Context& context) {
  std::vector<ModelReport> reports;
  for (const std::string& path : options.models) {
    ModelFileNotes notes;
    const Terrain terrain = load_terrain(path, &notes);
    const double heights = sizeof(float) * static_cast<double>(raster.cells());
    check_terrain_need("comparing", terrain, kVertexLoaded, heights, path);
    check_same_crs(terrain.georef, path, raster.georef, options.dem);
    ModelReport report = facts_of(terrain);
    report.name = path;
    report.bytes = model_size(path);
    report.errors = assess(terrain, raster, terrain.tolerance, context);
    if (sight != nullptr) sight->add(terrain, report.name, context);
    reports.push_back(report);
    if (!options.baselines) continue;
    const Rival rival{path, report.numbers, report.bytes, notes.compact};
    for (ModelReport& flat : flat_baselines(rival, raster, context)) reports.push_back(std::move(flat));
  }
  return reports;
}

/// Do all models stand for this grid in tiles, and can the grid be read by windows? Then nothing is held whole.
bool can_stream(const Options& options) {
  if (options.models.empty() || options.visibility.radius || options.baselines) return false;
  for (const std::string& path : options.models)
    if (!is_tiled_model(path)) return false;
  try {
    const Raster place = inspect_raster(options.dem, {.band = options.grid.band});
    for (const std::string& path : options.models)
      if (!same_grid(read_tiled_index(path), place)) return false;
  } catch (const BadInput&) {  // of a format without windows
    return false;
  }
  return true;
}

std::vector<ModelReport> compare_tiles(const Program& program, const Options& options, const Context& context) {
  std::vector<ModelReport> reports;
  for (const std::string& path : options.models) {
    TileReader reader(path, options.tile_memory.bytes());
    const TiledIndex& index = reader.index();
    ReadOptions read{.band = options.grid.band, .nodata = options.grid.nodata};
    check_same_crs(index.georef, path, inspect_raster(options.dem, read).georef, options.dem);
    TiledFacts facts;
    ModelReport report;
    report.errors = assess_tiles(
        reader,
        [&](const CellWindow& window) {
          read.window = window;
          return read_raster(options.dem, read, nullptr, context);
        },
        index.max_error, &facts, context);
    report.name = path;
    report.surface = surface_name(index.surface);
    report.gradients = gradient_name(facts.gradients);
    if (index.surface == SurfaceKind::clough_tocher)
      report.cross_derivative = cross_derivative_name(CrossDerivative::perpendicular);
    report.vertices = facts.vertices;
    report.triangles = facts.triangles;
    report.coefficients = facts.vertices * (index.surface == SurfaceKind::linear ? 1 : 3);
    report.numbers = report.coefficients + 2 * facts.vertices;
    report.tolerance = index.max_error;
    report.bytes = model_size(path);
    reports.push_back(report);
    program.say(fmt::format("{}: {} tiles read one by one", path, index.tiles.size()));
  }
  return reports;
}

Table table_of(const std::vector<ModelReport>& reports, bool with_kind, const VisibilityErrors* sight) {
  std::vector<std::string> header{"model"};
  if (with_kind) header.push_back("surface");
  for (const char* name :
       {"vertices", "coefficients", "numbers", "bytes", "RMSE", "maximum", "at", "slope RMSE", "uncovered"})
    header.push_back(name);
  if (sight != nullptr)
    for (const char* name : {"seen RMSE", "seen maximum"}) header.push_back(name);
  std::size_t next = 0;
  Table table(header);
  for (const ModelReport& r : reports) {
    std::vector<std::string> row{r.name};
    if (with_kind) row.push_back(kind_text(r));
    for (const std::size_t count : {r.vertices, r.coefficients, r.numbers, r.bytes})
      row.push_back(fmt::format("{}", count));
    row.push_back(number_text(r.errors.rmse));
    row.push_back(number_text(r.errors.max_error));
    row.push_back(fmt::format("{:.8g} {:.8g}", r.errors.max_error_at.x, r.errors.max_error_at.y));
    row.push_back(number_text(r.errors.slope_rmse));
    row.push_back(fmt::format("{}", r.errors.uncovered));
    if (sight != nullptr) {
      row.push_back(number_text(sight->differences()[next].rmse));
      row.push_back(number_text(sight->differences()[next++].maximum));
    }
    table.add(row);
  }
  return table;
}

void run(const Program& program, const Options& options) {
  if (options.models.empty() && !options.budget.given())
    throw UsageError(
        "give models to compare with the grid, or --vertices, --max-error or --ratio to compare the kinds");
  if (!options.models.empty() && options.budget.given())
    throw UsageError("models and a budget (--vertices, --max-error, --ratio) exclude each other: give one of them");
  if (static_cast<int>(options.markdown) + static_cast<int>(options.csv) + static_cast<int>(program.json) > 1)
    throw UsageError("--json, --markdown and --csv exclude each other");
  if (options.baselines && options.visibility.radius)
    throw UsageError("--baselines and --visibility exclude each other: ask for one after the other", {}, "--baselines");
  if (!options.visibility.maps.empty() && !options.visibility.radius)
    throw UsageError("--visibility-maps needs --visibility RADIUS (0: no limit)", {}, "--visibility-maps");
  const Context context = program.context();
  options.tile_memory.bytes();  // checked before the work
  const bool fitted = options.models.empty();
  std::optional<VisibilityErrors> sight;
  std::vector<ModelReport> reports;
  RasterSummary summary;
  std::optional<Raster> raster;
  if (can_stream(options)) {
    reports = compare_tiles(program, options, context);
  } else {
    const Need need{"comparing", options.visibility.radius ? kCellCompared : 0, 0};
    raster = load_grid(program, options.dem, options.grid, summary, context, need);
    if (options.visibility.radius) sight.emplace(program, options.visibility, *raster, context);
    VisibilityErrors* maps = sight ? &*sight : nullptr;
    reports = fitted ? compare_fits(program, options, *raster, summary, maps, context)
                     : compare_models(options, *raster, maps, context);
  }
  VisibilityErrors* seen = sight ? &*sight : nullptr;
  if (seen != nullptr) seen->write_pictures();
  if (program.json) {
    nlohmann::ordered_json models = nlohmann::ordered_json::array();
    for (const ModelReport& report : reports) {
      nlohmann::ordered_json entry = {{"name", report.name}};
      entry.update(to_json(report));
      if (seen != nullptr) {
        const MapDifference& d = seen->differences()[models.size()];
        entry["visibility_rmse"] = d.rmse;
        entry["visibility_max"] = d.maximum;
        entry["visibility_mean"] = d.mean;
        entry["visibility_cells"] = d.cells;
      }
      models.push_back(entry);
    }
    return program.print(nlohmann::ordered_json{{"models", models}});
  }
  const Table table = table_of(reports, !fitted, seen);
  program.print(options.markdown ? table.markdown() : options.csv ? table.csv() : table.text());
}

}  // namespace

void add_compare(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(root, program, "compare", "Models against the grid that they stand for: a table of errors",
                  "retalho compare dem.tif dem.retalho flat.retalho\n"
                  "retalho compare dem.tif --vertices 1000\n"
                  "retalho compare dem.tif --ratio 1% --markdown\n"
                  "retalho compare dem.tif dem.retalho --baselines\n"
                  "retalho compare dem.tif --vertices 1000 --visibility 2000 --visibility-maps pictures");
  command->add_option("DEM", options->dem, "Elevation grid")->required()->type_name("");
  command->add_option("MODEL", options->models, "Models; none: every kind of surface is fitted and compared")
      ->type_name("");
  add_budget_flags(*command, options->budget);
  add_grid_flags(*command, options->grid);
  add_visibility_flags(*command, options->visibility);
  add_tile_memory_flag(*command, options->tile_memory);
  command->add_flag("--baselines", options->baselines,
                    "Beside each model flat surfaces with its numbers and with its bytes: greedy, and strong (heights "
                    "fitted, vertices relocated); without models smooth ones beside the strong flat one");
  command->add_flag("--markdown", options->markdown, "The table as Markdown");
  command->add_flag("--csv", options->csv, "The table as CSV");
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
