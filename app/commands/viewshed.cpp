// retalho viewshed: what is seen from where, how much each cell sees, and the sight line between two points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "checks.h"
#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/model/tiled.h"
#include "retalho/raster/part.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/visibility/intervisibility.h"
#include "retalho/visibility/line_of_sight.h"
#include "retalho/visibility/surface_viewshed.h"
#include "retalho/visibility/viewshed.h"
#include "sight_line.h"
#include "viewshed_tiles.h"

namespace retalho::app {
namespace {

const std::vector<std::string> kWhat{"visible", "count", "height"};
const std::vector<std::string> kVoid{"transparent", "blocks"};

struct Options {
  std::string input, output, what = "visible", voids = "transparent", to;
  GridFlags grid;
  std::vector<std::string> observers;
  double observer_height = 2, target_height = 0, radius = 0, refraction = 0.13, frequency = 0;
  std::vector<double> azimuth, vertical;
  bool curvature = false, intervisibility = false, exact = false;
  int directions = 180, stride = 0;
  TileMemoryFlag tile_memory;
};

/// Where the observers stand, as the options say it: X,Y or X,Y,HEIGHT in the CRS.
struct Place {
  Vec2 crs;
  double height;
};
Place parse_place(const std::string& text, double height) {
  const std::size_t first = text.find(','), second = first == std::string::npos ? first : text.find(',', first + 1);
  if (second == std::string::npos) return {parse_point("--observer", text), height};
  char* end = nullptr;
  const std::string last = text.substr(second + 1);
  height = std::strtod(last.c_str(), &end);
  if (last.empty() || *end != '\0' || !std::isfinite(height))
    throw UsageError(fmt::format("--observer '{}': expected X,Y or X,Y,HEIGHT", text), {}, "--observer");
  return {parse_point("--observer", text.substr(0, second)), height};
}

SightPlaces places_of(const Options& options) {
  SightPlaces places;
  for (const std::string& text : options.observers) places.observers.push_back(parse_place(text, 0).crs);
  if (!options.to.empty()) places.target = parse_point("--to", options.to);
  places.radius = options.radius;
  return places;
}

/// The grid, or the model sampled at the cells of the grid that it was made from.
Raster load_heights(const Program& program, const Options& options, const Context& context) {
  if (!is_model_file(options.input)) {
    RasterSummary summary;
    return load_grid(program, options.input, options.grid, summary, context,
                     {"the map of", options.intervisibility ? kCellIntervisible : kCellSeen, 0});
  }
  if (is_tiled_model(options.input)) {
    TileReader reader(options.input, options.tile_memory.bytes());
    SightPlaces places;
    if (!options.intervisibility) places = places_of(options);
    return cells_in_reach(program, reader, options.input, places,
                          options.intervisibility ? kCellIntervisible : kCellSeen, context);
  }
  const Terrain terrain = load_terrain(options.input);
  const double cells = static_cast<double>(terrain.grid.columns) * terrain.grid.rows;
  check_terrain_need("the map of", terrain, kVertexLoaded,
                     cells * (sizeof(double) + (options.intervisibility ? kCellIntervisible : kCellSeen)),
                     options.input);
  Raster raster = raster_of_cells(TerrainEvaluator(terrain, context), context);
  program.say(
      fmt::format("{}: the model at the {} x {} cells of its grid", options.input, raster.columns, raster.rows));
  return raster;
}

void check_metres(const Program& program, const Georef& georef) {
  if (georef.unit != "metre" && georef.unit != "meter" && georef.unit != "m")
    program.say(fmt::format("warning: --earth-curvature and --frequency need metres; the distances here are in '{}'",
                            georef.unit));
}

ViewshedOptions field_of(const Options& options) {
  ViewshedOptions field;
  field.target_height = options.target_height;
  field.radius = options.radius;
  if (options.azimuth.size() == 2) {
    field.azimuth_from = options.azimuth[0];
    field.azimuth_to = options.azimuth[1] < options.azimuth[0] ? options.azimuth[1] + 360 : options.azimuth[1];
  }
  if (options.vertical.size() == 2) {
    field.lowest = options.vertical[0];
    field.highest = options.vertical[1];
  }
  field.earth_curvature = options.curvature;
  field.refraction = options.refraction;
  field.voids = static_cast<VoidRule>(choose("--void", options.voids, kVoid));
  return field;
}

SightOptions sight_of(const Options& options) {
  return {options.target_height, options.frequency, options.curvature, options.refraction, field_of(options).voids};
}

/// Writes the map that `raster` has become, and says how long it took.
void finish(const Program& program, const Options& options, Raster& raster, std::vector<float> map,
            nlohmann::ordered_json json, const std::string& words, const Stopwatch& watch, const Context& context) {
  raster.heights = std::move(map);
  raster.height_unit.clear();
  context.check();
  write_raster(raster, options.output, {.overwrite = program.overwrite}, context);
  json["seconds"] = watch.seconds();
  if (program.json) return program.print(json);
  program.print(words);
}

void run_intervisibility(const Program& program, const Options& options, const Stopwatch& watch) {
  if (!options.observers.empty() || !options.to.empty())
    throw UsageError("--intervisibility looks from every cell: leave out --observer and --to", {}, "--intervisibility");
  if (options.exact) throw UsageError("--intervisibility works on cells: leave out --exact", {}, "--exact");
  const Context context = program.context();
  Raster raster = load_heights(program, options, context);
  const std::size_t cells = raster.cells();
  const IntervisibilityOptions field{options.directions, options.observer_height, options.target_height,
                                     options.radius};
  std::vector<float> map;
  if (options.stride > 0) {
    raster.heights = exact_intervisibility(raster, options.stride, field, context);
    raster = thinned(raster, options.stride);
    map = std::get<std::vector<float>>(raster.heights);
  } else {
    map = intervisibility_map(raster, field, context);
    program.say(
        "a cell is seen when the straight line to its centre is nowhere under the terrain, heights linear between "
        "neighbouring cells; the map is within about 0.06 % of the cells (RMSE at 180 directions); --stride counts "
        "exactly");
  }
  double sum = 0;
  std::size_t n = 0;
  for (const float v : map)
    if (!std::isnan(v)) {
      sum += static_cast<double>(v);
      ++n;
    }
  const double mean = n > 0 ? sum / static_cast<double>(n) : 0.0;
  nlohmann::ordered_json json = {{"cells", cells}, {"valid_cells", n}, {"mean_cells_seen", mean}};
  if (options.stride > 0)
    json["stride"] = options.stride;
  else
    json["directions"] = options.directions;
  finish(program, options, raster, std::move(map), json,
         fmt::format("cells seen     {:.6g} on average, from {} cells\n", mean, n), watch, context);
}

/// 1 or 0, the number of observers, or the height that is needed: as --what says.
std::vector<float> result_of(std::size_t what, const std::vector<std::uint32_t>& counts, std::size_t& seen,
                             const std::function<bool(std::size_t)>& valid) {
  std::vector<float> result(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    seen += counts[i] > 0 ? 1U : 0U;
    result[i] = !valid(i)   ? std::numeric_limits<float>::quiet_NaN()
                : what == 0 ? (counts[i] > 0 ? 1.0F : 0.0F)
                            : static_cast<float>(counts[i]);
  }
  return result;
}
std::vector<float> result_of_needed(std::vector<float> needed, double target_height, std::size_t& seen) {
  for (const float h : needed) seen += static_cast<double>(h) <= target_height ? 1U : 0U;
  return needed;
}

/// A sight line over the cells of a tiled model, of which no more are read than lie beside it.
void run_tiled_line(const Program& program, const Options& options, const Context& context) {
  context.check();
  TileReader reader(options.input, options.tile_memory.bytes());
  const CellHeights cells = cells_of(reader);
  if (options.curvature || options.frequency > 0) check_metres(program, cells.georef);
  const Place place = parse_place(options.observers.front(), options.observer_height);
  const Observer observer = observer_at(cells, place.crs, place.height);
  const Observer target = observer_at(cells, parse_point("--to", options.to), 0);
  const SightLine line = line_of_sight(cells, observer, target.column, target.row, sight_of(options));
  program.say(fmt::format("{}: {} of {} tiles read", options.input, reader.reads(), reader.index().tiles.size()));
  report_sight_line(program, line, cells.georef, options.frequency > 0, options.output);
}

/// On cells: of the grid, or of the model's own grid.
void run_cells(const Program& program, const Options& options, const Stopwatch& watch) {
  const Context context = program.context();
  if (!options.to.empty() && is_tiled_model(options.input)) return run_tiled_line(program, options, context);
  Raster raster = load_heights(program, options, context);
  if (options.curvature || options.frequency > 0) check_metres(program, raster.georef);
  std::vector<Observer> observers;
  for (const std::string& text : options.observers) {
    const Place place = parse_place(text, options.observer_height);
    observers.push_back(observer_at(raster, place.crs, place.height));
  }
  const ViewshedOptions field = field_of(options);
  if (!options.to.empty()) {
    const Observer target = observer_at(raster, parse_point("--to", options.to), 0);
    return report_sight_line(program,
                             line_of_sight(raster, observers.front(), target.column, target.row, sight_of(options)),
                             raster.georef, options.frequency > 0, options.output);
  }
  std::size_t seen = 0;
  const std::size_t what = choose("--what", options.what, kWhat);
  std::vector<float> map =
      what == 2 ? result_of_needed(needed_heights(raster, observers, field, context), field.target_height, seen)
                : result_of(what, observer_counts(raster, observers, field, context), seen,
                            [&](std::size_t i) { return !std::isnan(raster.at(i)); });
  finish(program, options, raster, std::move(map),
         {{"observers", observers.size()}, {"visible_cells", seen}, {"cells", raster.cells()}, {"exact", false}},
         fmt::format("visible cells  {} of {}\n", seen, raster.cells()), watch, context);
}

/// On a model's surface itself.
void run_surface(const Program& program, const Options& options, const Stopwatch& watch) {
  if (!is_model_file(options.input))
    throw UsageError(
        fmt::format("--exact asks for a model, and '{}' is none: fit the grid first (retalho fit)", options.input),
        options.input, "--exact");
  const Context context = program.context();
  const Terrain terrain = is_tiled_model(options.input) ? tiles_in_reach(program, options.input, places_of(options))
                                                        : load_terrain(options.input);
  check_terrain_need("the map of", terrain, kVertexLoaded,
                     static_cast<double>(terrain.grid.columns) * terrain.grid.rows * (sizeof(double) + kCellSeen),
                     options.input);
  const TerrainEvaluator evaluator(terrain, context);
  if (options.curvature || options.frequency > 0) check_metres(program, terrain.georef);
  std::vector<SurfaceObserver> observers;
  for (const std::string& text : options.observers) {
    const Place place = parse_place(text, options.observer_height);
    observers.push_back({terrain.georef.to_local(place.crs), place.height});
  }
  const ViewshedOptions field = field_of(options);
  if (!options.to.empty()) {
    const Vec2 target = terrain.georef.to_local(parse_point("--to", options.to));
    return report_sight_line(program, surface_line_of_sight(evaluator, observers.front(), target, sight_of(options)),
                             terrain.georef, options.frequency > 0, options.output);
  }
  std::size_t seen = 0;
  const std::size_t what = choose("--what", options.what, kWhat);
  Raster raster = raster_of_cells(evaluator, context);
  std::vector<float> map;
  if (what == 2) {
    map = result_of_needed(surface_needed_heights(evaluator, observers, field, context), field.target_height, seen);
  } else {
    map = result_of(what, surface_observer_counts(evaluator, observers, field, context), seen,
                    [&](std::size_t i) { return !std::isnan(raster.at(i)); });
  }
  program.say(fmt::format("{}: the {} surface itself, at the centres of {} x {} cells", options.input,
                          surface_name(terrain.kind), raster.columns, raster.rows));
  finish(program, options, raster, std::move(map),
         {{"observers", observers.size()}, {"visible_cells", seen}, {"cells", raster.cells()}, {"exact", true}},
         fmt::format("visible cells  {} of {}\n", seen, raster.cells()), watch, context);
}

void run(const Program& program, const Options& options) {
  const Stopwatch watch;
  if (!options.intervisibility && options.observers.empty())
    throw UsageError("give --observer X,Y (or --intervisibility)", {}, "--observer");
  if (options.stride > 0 && !options.intervisibility)
    throw UsageError("--stride thins the map of --intervisibility: give both", {}, "--stride");
  if (options.to.empty() && options.output.empty()) throw UsageError("give the output with -o", {}, "-o");
  if (!options.output.empty()) check_output(program, options.output, {}, {options.input});
  choose("--what", options.what, kWhat);
  choose("--void", options.voids, kVoid);
  if (options.intervisibility) return run_intervisibility(program, options, watch);
  options.exact ? run_surface(program, options, watch) : run_cells(program, options, watch);
}

}  // namespace

void add_viewshed(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      root, program, "viewshed", "What is seen from where; how many cells each cell sees; a sight line",
      "  retalho viewshed dem.tif -o seen.tif --observer 502300,4401200,10\n"
      "  retalho viewshed dem.tif -o count.tif --what count --observer 502300,4401200 --observer 503000,4402000\n"
      "  retalho viewshed dem.tif --observer 502300,4401200,15 --to 505000,4403000 --frequency 2.4e9 -o sight.svg\n"
      "  retalho viewshed model.retalho -o seen.tif --exact --observer 502300,4401200,10\n"
      "  retalho viewshed model.retalho -o map.tif --intervisibility --radius 3000");
  command->add_option("INPUT", options->input, "Elevation grid or model")->required();
  command->add_option("-o,--output", options->output, "Raster of the result; of --to a picture");
  command
      ->add_option("--observer", options->observers,
                   "Where it stands, in the CRS, and its height above the ground; may be repeated")
      ->type_name("X,Y[,H]");
  command->add_option("--observer-height", options->observer_height,
                      "Eye above the ground where --observer gives none, and of --intervisibility (default 2)");
  command->add_option("--target-height", options->target_height, "Of what is looked at, above the ground (default 0)");
  command
      ->add_option("--radius", options->radius, "Largest distance (default: none; metres where the CRS is geographic)")
      ->check(zero_or_more());
  command->add_option("--what", options->what,
                      "visible (1 or 0, default), count (observers that see the cell) or height (needed to be seen)");
  command->add_option("--azimuth", options->azimuth, "Horizontal field, degrees clockwise from north")
      ->expected(2)
      ->type_name("FROM TO");
  command->add_option("--vertical", options->vertical, "Vertical field, degrees above the horizontal")
      ->expected(2)
      ->type_name("LOW HIGH");
  command->add_flag("--earth-curvature", options->curvature, "Lower heights by the Earth's curvature less refraction");
  command->add_option("--refraction", options->refraction, "With --earth-curvature: 0.13 light (default), 0.25 radio");
  command->add_option("--void", options->voids, "Void cells: transparent (default) or blocks");
  command
      ->add_option("--to", options->to,
                   "Only the sight line from the observer to here: on standard output, and with -o a profile as .svg, "
                   ".pdf or .png")
      ->type_name("X,Y");
  command->add_option("--frequency", options->frequency, "With --to: Hz, for the Fresnel zone")->check(zero_or_more());
  command->add_flag("--intervisibility", options->intervisibility, "For each cell the number of cells that it sees");
  command->add_flag(
      "--exact", options->exact,
      "A model's surface itself decides, not its heights at cells; observers stand where they are said to");
  command
      ->add_option(
          "--stride", options->stride,
          "With --intervisibility: exact counts from every N-th cell of every N-th row; cells N times as large")
      ->type_name("N")
      ->check(above_zero());
  command->add_option("--directions", options->directions, "Of --intervisibility (default 180)")
      ->check(CLI::Range(4, 3600));
  add_tile_memory_flag(*command, options->tile_memory);
  add_grid_flags(*command, options->grid);
  command->callback([&program, options] { run(program, *options); });
}

}  // namespace retalho::app
