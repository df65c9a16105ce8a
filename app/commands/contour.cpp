// retalho contour: level lines of a smooth surface, or the regions between them.
#include "retalho/level/contour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "checks.h"
#include "contour_conics.h"
#include "contour_map.h"
#include "contour_surface.h"
#include "retalho/core/error.h"
#include "retalho/level/write_vector.h"
#include "retalho/render/surface_comparison.h"
#include "table.h"

namespace retalho::app {
namespace {

const std::vector<std::string> kEndings{".gpkg", ".geojson", ".json", ".shp", ".dxf", ".svg", ".pdf"};

struct Options {
  std::string output, levels;
  double interval = 0, base = 0, tolerance = 0;
  int index_every = 5;
  bool bands = false, raw = false, conics = false;
  SheetFlags sheet;
  std::string compare;
  int zoom = 48;
  SurfaceChoice surface;
};

std::vector<double> parse_levels(const std::string& text) {
  std::vector<double> levels;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string word = text.substr(at, comma - at);
    char* end = nullptr;
    const double level = std::strtod(word.c_str(), &end);
    if (word.empty() || *end != '\0' || !std::isfinite(level))
      throw UsageError(fmt::format("--levels: '{}' is not a number (100,200,350)", word), {}, "--levels");
    levels.push_back(level);
    at = comma + 1;
  }
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

/// A smooth surface may rise above its highest sample: levels go on a little beyond both ends.
std::vector<double> levels_of(const Options& options, const TracedSurface& surface) {
  if (!options.levels.empty()) return parse_levels(options.levels);
  const double beyond = 0.25 * (surface.high - surface.low);
  return contour_levels(surface.low - beyond, surface.high + beyond, options.interval, options.base);
}

/// The picture of --compare-surfaces; returns the names of the surfaces in it.
std::vector<std::string> compare(const Program& program, const Options& options, const Context& context) {
  SurfaceComparison comparison;
  const VectorOptions file{program.overwrite, options.index_every, options.base, options.interval};
  const auto prepare = [&](double low, double high, double cell) {
    TracedSurface range;
    range.low = low;
    range.high = high;
    comparison.levels = levels_of(options, range);
    for (std::size_t k = 0; k < comparison.levels.size(); ++k)
      comparison.index.push_back(is_index_level(comparison.levels, static_cast<int>(k), file));
    comparison.tolerance = options.tolerance > 0 ? options.tolerance : 0.02 * cell;
  };
  const auto write = [&](const ComparedSurfaces& compared) {
    write_picture(compared.picture, options.compare, program.overwrite);
    return compared.names;
  };
  if (options.surface.budget.given())
    throw UsageError("--compare-surfaces draws every cell or point: leave --max-error, --vertices and --ratio out", {},
                     "--compare-surfaces");
  if (is_model_file(options.surface.input))
    throw UsageError("a model has its surface already: --compare-surfaces is for grids and points", {},
                     "--compare-surfaces");
  if (takes_points(options.surface.input, options.surface.points)) {
    const PointCloud cloud = load_points(program, options.surface.input, options.surface.points, context);
    const ConstrainedTin made =
        triangulate(program, cloud, options.surface.input, options.surface.breaklines, nullptr, context);
    const auto [low, high] = std::minmax_element(made.tin.heights.begin(), made.tin.heights.end());
    prepare(*low, *high, mean_edge(made.tin));
    return write(compare_point_surfaces(made, cloud.georef, comparison, context));
  }
  RasterSummary summary;
  const Raster raster = load_grid(program, options.surface.input, options.surface.grid, summary, context);
  const Raster part = middle_of(raster, options.zoom);
  if (part.cells() < raster.cells())
    program.say(fmt::format("the picture shows the middle {} x {} cells of {} x {}: --zoom N shows N, --zoom 0 all",
                            part.columns, part.rows, raster.columns, raster.rows));
  const RasterSummary shown = summarize(part);
  if (shown.valid == 0) throw BadInput("the part that is shown has no data: choose --zoom 0", options.surface.input);
  prepare(shown.minimum, shown.maximum, std::min(part.cell_width, part.cell_height));
  return write(compare_grid_surfaces(part, comparison, context));
}

nlohmann::ordered_json singular_json(const ContourSet& set, const Georef& georef) {
  auto list = nlohmann::ordered_json::array();
  for (const SingularPlace& place : set.singular) {
    const Vec2 low = georef.to_crs(place.low), high = georef.to_crs(place.high);
    list.push_back(
        {{"level", set.levels[static_cast<std::size_t>(place.level)]}, {"box", {low.x, low.y, high.x, high.y}}});
  }
  return list;
}

/// What was traced.
struct Tally {
  std::size_t lines = 0, closed = 0, vertices = 0;

  void add(const ContourSet& set) {
    lines += set.lines.size();
    for (const ContourLine& line : set.lines) {
      closed += line.closed ? 1 : 0;
      vertices += line.end - line.begin;
    }
  }
};

void check_conics(const Options& options) {
  if (!options.conics) return;
  if (!options.output.ends_with(".json"))
    throw UsageError("--conics writes curves (docs/curve.schema.json): name a .json file", {}, "--conics");
  if (options.bands || options.raw || options.tolerance > 0)
    throw UsageError("--conics gives exact lines: --bands, --raw and --tolerance are for polylines", {}, "--conics");
}

void run(const Program& program, const Options& options) {
  const Stopwatch watch;
  check_conics(options);
  if ((options.interval > 0) == !options.levels.empty())
    throw UsageError("say which levels: --interval D (with --base B), or --levels a,b,c", {}, "--interval");
  if (options.output.empty() && options.compare.empty())
    throw UsageError("name an output: -o FILE for lines, --compare-surfaces FILE for a picture", {}, "--output");
  check_breakline_flags(options.surface.breaklines, !is_model_file(options.surface.input) &&
                                                        takes_points(options.surface.input, options.surface.points));
  if (!options.output.empty()) {
    check_output(program, options.output, kEndings, {options.surface.input});
    check_sheet_flags(options.sheet, options.output);
  }
  if (!options.compare.empty())
    check_output(program, options.compare, {".png", ".svg", ".pdf"}, {options.surface.input, options.output});
  const Context context = program.context();
  if (!options.compare.empty()) {
    const std::vector<std::string> names = compare(program, options, context);
    if (options.output.empty()) {
      if (program.json) return program.print({{"surfaces", names}, {"seconds", watch.seconds()}});
      return program.print(list_text({{"surfaces", fmt::format("{}", fmt::join(names, "; "))},
                                      {"seconds", fmt::format("{:.2f}", watch.seconds())}}));
    }
  }
  const bool sheet = is_sheet(options.output);
  SurfaceChoice choice = options.surface;
  // Lines alone leave as they are traced; sheets and bands want the whole surface.
  choice.joined = sheet || options.conics;
  choice.whole = choice.joined || options.bands;
  TracedSurface surface = load_surface(program, choice, context);
  if (options.conics) {
    if (!surface.terrain)
      throw UsageError("--conics is for Powell-Sabin surfaces: --surface powell-sabin, or such a model", {},
                       "--conics");
    return write_conics(program, *surface.terrain, levels_of(options, surface), options.output, context);
  }
  ContourOptions contour;
  contour.tolerance = options.tolerance > 0 ? options.tolerance : 0.1 * surface.cell;
  if (!(options.tolerance > 0))
    program.say(fmt::format(
        "--tolerance {:.6g}: a tenth of {} (chosen, as none was given)", contour.tolerance,
        surface.raster || surface.tiles || surface.terrain->grid.columns > 0 ? "a cell" : "a triangle's edge"));
  // Curves are fitted to every traced vertex, and take what tracing leaves of the tolerance.
  const double tolerance = contour.tolerance;
  contour.simplify = !options.raw && !options.sheet.curves;
  if (options.sheet.curves) contour.tolerance *= kTracedShare;
  ContourExtras extras;
  extras.want_bands = options.bands;
  const std::vector<double> levels = levels_of(options, surface);
  MapSheet map;
  const Georef georef = surface.georef();
  const bool stream = !choice.whole && (surface.tiles || surface.raster);
  std::optional<BicubicGrid> bicubic;
  if (surface.raster && !stream) {
    bicubic = make_bicubic(*surface.raster, surface.bicubic, context);
    surface.raster.reset();
  }
  if (sheet) {
    map.content.extent = bicubic ? extent_of(*bicubic) : extent_of(*surface.terrain);
    map.content.low = surface.low;
    map.content.high = surface.high;
    map.content.height_unit = surface.height_unit;
    const double least = spot_prominence(levels, surface.low, surface.high);
    map.content.spots =
        bicubic ? find_spot_heights(*bicubic, least, context) : find_spot_heights(*surface.terrain, least, context);
  }
  if (options.sheet.curves && options.bands) {
    // Tints need no more vertices than polylines do: bands of their own, thinned.
    ContourOptions thinned{tolerance, !options.raw};
    bicubic ? trace_contours(*bicubic, levels, thinned, context, &extras)
            : trace_contours(*surface.terrain, levels, thinned, context, &extras);
    extras.want_bands = false;
  }
  const VectorOptions file{program.overwrite, options.index_every, options.base, options.interval};
  Tally tally;
  ContourSet set;
  if (stream) {
    write_contours(georef, options.output, file, context, [&](const TakeContours& take) {
      const TakeContours count_and_take = [&](const ContourSet& part) {
        tally.add(part);
        take(part);
      };
      set = surface.tiles ? stream_contours(*surface.tiles, surface.range, levels, contour, count_and_take, context,
                                            &extras.stats)
                          : stream_contours(*surface.raster, surface.bicubic, levels, contour, count_and_take, context,
                                            &extras.stats);
    });
  } else {
    set = surface.tiles ? trace_contours(*surface.tiles, surface.range, levels, contour, context, &extras)
          : bicubic     ? trace_contours(std::move(*bicubic), levels, contour, context, &extras)
                        : trace_contours(*surface.terrain, levels, contour, context, &extras);
    context.check();
    tally.add(set);
    if (sheet) {
      map.content.lines = &set;
      map.content.bands = options.bands ? &extras.bands : nullptr;
      map.content.georef = georef;
      map.tolerance = tolerance;
      write_map_sheet(program, map, options.sheet, options.output, file, context);
    } else if (options.bands) {
      write_bands(extras.bands, georef, options.output, file, context);
    } else {
      write_contours(set, georef, options.output, file, context);
    }
  }

  if (tally.lines == 0)
    program.say(fmt::format("no level lies between {:.6g} and {:.6g}: {}", surface.low, surface.high,
                            sheet           ? "the sheet has a frame alone"
                            : options.bands ? "one band"
                                            : "the layer has no features"));
  if (!set.singular.empty())
    program.say(
        fmt::format("{} places are singular (a saddle or a flat exactly on a level): the lines are joined there "
                    "by rule; --json lists them",
                    set.singular.size()));
  nlohmann::ordered_json json = {{"levels", set.levels.size()},  {"lines", tally.lines},
                                 {"closed_lines", tally.closed}, {"vertices", tally.vertices},
                                 {"tolerance", tolerance},       {"height_quantum", set.height_quantum}};
  if (options.bands) json["polygons"] = extras.bands.polygons.size();
  if (sheet) json["sheet"] = sheet_json(map.report, options.sheet.curves);
  json["singular"] = singular_json(set, georef);
  json["seconds"] = watch.seconds();
  if (program.json) return program.print(json);
  std::vector<std::pair<std::string, std::string>> lines{
      {"levels", fmt::format("{}", set.levels.size())},
      {"lines", fmt::format("{} ({} closed)", tally.lines, tally.closed)},
      {"vertices", fmt::format("{} (traced {})", tally.vertices, extras.stats.raw_points)},
      {"tolerance", fmt::format("{:.6g}", tolerance)},
      {"singular places", fmt::format("{}", set.singular.size())},
      {"seconds", fmt::format("{:.2f}", watch.seconds())}};
  if (options.bands) lines.insert(lines.begin() + 1, {"polygons", fmt::format("{}", extras.bands.polygons.size())});
  if (sheet) append_sheet_lines(lines, map.report, options.sheet.curves);
  program.print(list_text(lines));
}

}  // namespace

void add_contour(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(root, program, "contour", "Level lines of the smooth surface: none missed, none crossing",
                  "retalho contour dem.tif -o lines.gpkg --interval 20\n"
                  "retalho contour dem.tif -o bands.gpkg --interval 100 --bands\n"
                  "retalho contour dem.tif -o lines.shp --levels 350,400,500 --tolerance 2\n"
                  "retalho contour dem.tif --interval 20 --compare-surfaces choose.png\n"
                  "retalho contour model.retalho -o lines.geojson --interval 10\n"
                  "retalho contour survey.csv -o lines.gpkg --interval 0.5 --breaklines kerbs.gpkg\n"
                  "retalho contour survey.csv -o exact.json --interval 5 --surface powell-sabin --conics\n"
                  "retalho contour dem.tif -o map.pdf --interval 20 --bands --curves --title 'Jacksboro' --sheet A3\n"
                  "retalho contour soundings.csv -o depth.dxf --interval 0.5 --surface powell-sabin");
  command
      ->add_option("INPUT", options->surface.input, "Elevation grid, points (.xyz .csv .ply, vector layers) or model")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", options->output, ".gpkg, .geojson, .shp or .dxf; .svg or .pdf: a map sheet")
      ->type_name("FILE");
  command->add_option("--interval", options->interval, "Height between levels")->type_name("D")->check(above_zero());
  command->add_option("--base", options->base, "A height that is a level, and an index contour (default 0)")
      ->type_name("B");
  command->add_option("--levels", options->levels, "The levels themselves")->type_name("A,B,C");
  command
      ->add_option(
          "--tolerance", options->tolerance,
          "How far lines may lie from the true level lines (default a tenth of a cell; metres where the CRS is "
          "geographic)")
      ->type_name("T")
      ->check(above_zero());
  command
      ->add_option("--surface", options->surface.kind,
                   "bicubic (default for grids), linear, powell-sabin or clough-tocher (default for points)")
      ->type_name("KIND");
  command->add_option("--twist", options->surface.twist, "Bicubic: spline (default), adini, or zero as in the paper")
      ->type_name("KIND");
  command->add_option("--ends", options->surface.ends, "Bicubic: not-a-knot (default) or natural")->type_name("KIND");
  command->add_flag("--ring", options->surface.ring,
                    "Bicubic: splines all through, although they ring beside flats and lakes");
  command->add_flag("--bands", options->bands,
                    "Polygons between the levels instead of lines; on a map sheet, tints beneath them");
  command->add_flag("--raw", options->raw, "Keep every traced vertex");
  command->add_flag("--conics", options->conics,
                    "Of a Powell-Sabin surface: the exact lines, as rational quadratic curves in a .json of curves");
  command
      ->add_option("--index-every", options->index_every,
                   "Every so many levels is an index contour (default 5; 0: none)")
      ->check(CLI::Range(0, 1000));
  command
      ->add_option("--height-field", options->surface.points.height_field,
                   "Vector layers: the attribute that holds the height")
      ->type_name("NAME");
  command->add_option("--layer", options->surface.points.layer, "Vector files with several layers: which one")
      ->type_name("NAME");
  add_tile_memory_flag(*command, options->surface.tile_memory);
  add_breakline_flags(*command, options->surface.breaklines);
  command
      ->add_option("--compare-surfaces", options->compare,
                   "A picture (.png .svg .pdf) of the lines of every surface, side by side, each through all samples")
      ->type_name("FILE");
  command->add_option("--zoom", options->zoom, "Of --compare-surfaces: cells a side, of the grid's middle (48; 0: all)")
      ->check(CLI::Range(0, 65535));
  add_sheet_flags(*command, options->sheet);
  add_budget_flags(*command, options->surface.budget);
  add_grid_flags(*command, options->surface.grid);
  command->callback([&program, options] { run(program, *options); });
}

}  // namespace retalho::app
