// retalho viewshed: what is seen from where, how much each cell sees, and the sight line between two points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/visibility/intervisibility.h"
#include "retalho/visibility/line_of_sight.h"
#include "retalho/visibility/viewshed.h"

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
  bool curvature = false, intervisibility = false;
  int directions = 180;
};

/// The grid, or the model sampled at the cells of the grid that it was made from.
Raster load_heights(const Program& program, const Options& options, const Context& context) {
  if (!is_model_file(options.input)) {
    RasterSummary summary;
    return load_grid(program, options.input, options.grid, summary, context);
  }
  const Terrain terrain = load_terrain(options.input);
  if (terrain.grid.columns == 0)
    throw BadInput(
        fmt::format(
            "'{}' was made from points and has no cells: sample it on a raster first (retalho sample --resolution R)",
            options.input),
        options.input);
  Raster raster;
  raster.columns = terrain.grid.columns;
  raster.rows = terrain.grid.rows;
  raster.cell_width = terrain.grid.cell_width;
  raster.cell_height = terrain.grid.cell_height;
  raster.georef = terrain.georef;
  std::vector<double> heights(raster.cells());
  TerrainEvaluator(terrain, context)
      .grid_values({0, 0}, {raster.cell_width, raster.cell_height}, raster.columns, raster.rows, heights, {}, context);
  raster.heights = std::move(heights);
  program.say(
      fmt::format("{}: the model at the {} x {} cells of its grid", options.input, raster.columns, raster.rows));
  return raster;
}

Observer parse_observer(const Raster& raster, const std::string& text, double height) {
  const std::size_t first = text.find(','), second = first == std::string::npos ? first : text.find(',', first + 1);
  if (second == std::string::npos) return observer_at(raster, parse_point("--observer", text), height);
  char* end = nullptr;
  const std::string last = text.substr(second + 1);
  height = std::strtod(last.c_str(), &end);
  if (last.empty() || *end != '\0' || !std::isfinite(height))
    throw UsageError(fmt::format("--observer '{}': expected X,Y or X,Y,HEIGHT", text), {}, "--observer");
  return observer_at(raster, parse_point("--observer", text.substr(0, second)), height);
}

void check_metres(const Program& program, const Raster& raster) {
  if (raster.georef.unit != "metre" && raster.georef.unit != "meter" && raster.georef.unit != "m")
    program.say(fmt::format("warning: --earth-curvature and --frequency need metres; the distances here are in '{}'",
                            raster.georef.unit));
}

/// The sight line between an observer and a point: verdict, clearances and profile.
void sight_line(const Program& program, const Options& options, const Raster& raster, const Observer& observer) {
  const Observer target = observer_at(raster, parse_point("--to", options.to), 0);
  const SightLine line = line_of_sight(raster, observer, target.column, target.row,
                                       {options.target_height, options.frequency, options.curvature, options.refraction,
                                        static_cast<VoidRule>(choose("--void", options.voids, kVoid))});
  nlohmann::ordered_json json = {{"visible", line.visible}, {"distance", line.profile.back().distance}};
  const auto number = [](double v) {
    return std::isfinite(v) ? nlohmann::ordered_json(v) : nlohmann::ordered_json(nullptr);
  };
  json["clearance"] = number(line.clearance);
  json["blocked_at"] = number(line.blocked_at);
  if (options.frequency > 0) json["fresnel_clearance"] = number(line.fresnel_clear);
  json["profile"] = nlohmann::ordered_json::array();
  for (const ProfilePoint& p : line.profile) {
    const Vec2 at = raster.georef.to_crs(p.at);
    nlohmann::ordered_json point = {
        {"distance", p.distance}, {"x", at.x}, {"y", at.y}, {"ground", number(p.ground)}, {"sight", p.sight}};
    if (options.frequency > 0) point["fresnel_radius"] = p.fresnel;
    json["profile"].push_back(point);
  }
  if (program.json) return program.print(json);
  std::string text =
      line.visible
          ? fmt::format("visible over {:.6g}, lowest clearance {:.6g}\n", line.profile.back().distance, line.clearance)
          : fmt::format("not visible: blocked at {:.6g} of {:.6g}\n", line.blocked_at, line.profile.back().distance);
  if (options.frequency > 0)
    text += fmt::format("first Fresnel zone: {:.0f} % clear at the narrowest\n",
                        100 * std::clamp(line.fresnel_clear, 0.0, 1.0));
  program.print(text);
}

void run(const Program& program, const Options& options) {
  const Stopwatch watch;
  if (options.intervisibility && (!options.observers.empty() || !options.to.empty()))
    throw UsageError("--intervisibility looks from every cell: leave out --observer and --to", {}, "--intervisibility");
  if (!options.intervisibility && options.observers.empty())
    throw UsageError("give --observer X,Y (or --intervisibility)", {}, "--observer");
  if (options.to.empty() && options.output.empty()) throw UsageError("give the output with -o", {}, "-o");
  if (!options.output.empty()) check_output(program, options.output, {}, {options.input});
  const std::size_t what = choose("--what", options.what, kWhat), voids = choose("--void", options.voids, kVoid);
  const Context context = program.context();
  Raster raster = load_heights(program, options, context);
  if (options.curvature || options.frequency > 0) check_metres(program, raster);
  nlohmann::ordered_json json;
  if (options.intervisibility) {
    std::vector<float> map = intervisibility_map(
        raster, {options.directions, options.observer_height, options.target_height, options.radius}, context);
    double sum = 0;
    std::size_t n = 0;
    for (const float v : map)
      if (!std::isnan(v)) {
        sum += static_cast<double>(v);
        ++n;
      }
    raster.heights = std::move(map);
    json = {{"directions", options.directions},
            {"cells", raster.cells()},
            {"valid_cells", n},
            {"mean_cells_seen", n > 0 ? sum / static_cast<double>(n) : 0.0}};
    program.say(
        "a cell is seen when the straight line to its centre is nowhere under the terrain, heights linear between "
        "neighbouring cells; the map is within about 0.06 % of the cells (RMSE at 180 directions)");
  } else {
    std::vector<Observer> observers;
    for (const std::string& text : options.observers)
      observers.push_back(parse_observer(raster, text, options.observer_height));
    if (!options.to.empty()) return sight_line(program, options, raster, observers.front());
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
    field.voids = static_cast<VoidRule>(voids);
    std::vector<float> result(raster.cells());
    std::size_t seen = 0;
    const std::vector<std::uint32_t> counts = observer_counts(raster, observers, field, context);
    for (const std::uint32_t c : counts) seen += c > 0 ? 1U : 0U;
    if (what == 2) {
      result = needed_heights(raster, observers, field, context);
    } else {
      for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = std::isnan(raster.at(i)) ? std::numeric_limits<float>::quiet_NaN()
                    : what == 0              ? (counts[i] > 0 ? 1.0F : 0.0F)
                                             : static_cast<float>(counts[i]);
    }
    raster.heights = std::move(result);
    json = {{"observers", observers.size()}, {"visible_cells", seen}, {"cells", raster.cells()}};
  }
  raster.height_unit.clear();
  context.check();
  write_raster(raster, options.output, {.overwrite = program.overwrite}, context);
  json["seconds"] = watch.seconds();
  if (program.json) return program.print(json);
  if (options.intervisibility)
    program.say(fmt::format("{}: cells seen by each cell, {} directions, {:.6g} on average", options.output,
                            options.directions, json["mean_cells_seen"].get<double>()));
  else
    program.print(fmt::format("visible cells  {} of {}\n", json["visible_cells"].get<std::size_t>(), raster.cells()));
}

}  // namespace

void add_viewshed(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      root, program, "viewshed", "What is seen from where; how many cells each cell sees; a sight line",
      "  retalho viewshed dem.tif -o seen.tif --observer 502300,4401200,10\n"
      "  retalho viewshed dem.tif -o count.tif --what count --observer 502300,4401200 --observer 503000,4402000\n"
      "  retalho viewshed dem.tif --observer 502300,4401200,15 --to 505000,4403000 --frequency 2.4e9 --json\n"
      "  retalho viewshed model.retalho -o map.tif --intervisibility --radius 3000");
  command->add_option("INPUT", options->input, "Elevation grid or model")->required();
  command->add_option("-o,--output", options->output, "Raster of the result");
  command
      ->add_option("--observer", options->observers,
                   "Where it stands, in the CRS, and its height above the ground; may be repeated")
      ->type_name("X,Y[,H]");
  command->add_option("--observer-height", options->observer_height,
                      "Eye above the ground where --observer gives none, and of --intervisibility (default 2)");
  command->add_option("--target-height", options->target_height, "Of what is looked at, above the ground (default 0)");
  command
      ->add_option("--radius", options->radius, "Largest distance (default: none; metres where the CRS is geographic)")
      ->check(CLI::NonNegativeNumber);
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
  command->add_option("--to", options->to, "Only the sight line from the observer to here, on standard output")
      ->type_name("X,Y");
  command->add_option("--frequency", options->frequency, "With --to: Hz, for the Fresnel zone")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--intervisibility", options->intervisibility, "For each cell the number of cells that it sees");
  command->add_option("--directions", options->directions, "Of --intervisibility (default 180)")
      ->check(CLI::Range(4, 3600));
  add_grid_flags(*command, options->grid);
  command->callback([&program, options] { run(program, *options); });
}

}  // namespace retalho::app
