// retalho sample: a model's heights and what follows from them, on a raster or at points.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>

#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/quantities.h"
#include "retalho/tiles/reader.h"
#include "retalho/tiles/sampled_raster.h"
#include "table.h"

namespace retalho::app {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kMostCells = 65535;  // a side of an output raster
const std::vector<std::string> kWhat{"height", "slope", "aspect", "normal", "curvature"};
enum What { height, slope, aspect, normal, curvature };

struct Options {
  std::string model, output, like, points_file;
  double resolution = 0;
  std::vector<std::string> what;
  std::vector<std::string> at;
  bool cog = false;
  TileMemoryFlag tile_memory;
  bool set(What w) const { return std::find(what.begin(), what.end(), kWhat[w]) != what.end(); }
};

/// An empty raster, and where its cells lie in the model's local coordinates.
struct Target {
  Raster raster;
  Vec2 origin, step;
};

Target target_like(const Program& program, const Options& options, const Terrain& terrain, const Context& context) {
  RasterSummary summary;
  Raster like = load_grid(program, options.like, {}, summary, context);
  check_same_crs(terrain.georef, options.model, like.georef, options.like);
  Target target;
  target.raster = std::move(like);
  const Georef &from = target.raster.georef, &to = terrain.georef;
  target.origin = to.to_local(from.to_crs({0, 0}));
  target.step = {target.raster.cell_width * to.scale_x / from.scale_x,
                 target.raster.cell_height * to.scale_y / from.scale_y};
  return target;
}

Target target_of_model(const Program& program, const Options& options, const Terrain& terrain) {
  const GridDomain& grid = terrain.grid;
  if (grid.columns == 0 && options.resolution <= 0)
    throw UsageError("this model was made from points: say the cell size with --resolution, or --like a raster", {},
                     "--resolution");
  Target target;
  Raster& raster = target.raster;
  raster.georef = terrain.georef;
  if (options.resolution <= 0) {
    raster.columns = grid.columns;
    raster.rows = grid.rows;
    raster.cell_width = grid.cell_width;
    raster.cell_height = grid.cell_height;
    target.step = {grid.cell_width, grid.cell_height};
    return target;
  }
  // From the outer edge of the grid's first cell; of points: from their box's corner.
  Vec2 low{0, 0}, high{0, 0};
  if (grid.columns > 0) {
    low = {-grid.cell_width / 2, -(grid.rows - 0.5) * grid.cell_height};
    high = {(grid.columns - 0.5) * grid.cell_width, grid.cell_height / 2};
  } else {
    low = high = terrain.tin.points.at(0);
    for (const Vec2 p : terrain.tin.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
  }
  const double size = options.resolution;
  const double columns = std::max(1.0, std::ceil((high.x - low.x) / size - 1e-9));
  const double rows = std::max(1.0, std::ceil((high.y - low.y) / size - 1e-9));
  if (columns > kMostCells || rows > kMostCells)
    throw UsageError(
        fmt::format("--resolution {} would make {:.0f} x {:.0f} cells, more than {} a side: give a larger one", size,
                    columns, rows, kMostCells),
        {}, "--resolution");
  raster.columns = static_cast<int>(columns);
  raster.rows = static_cast<int>(rows);
  raster.cell_width = raster.cell_height = size;
  target.origin = {low.x + size / 2, high.y - size / 2};
  target.step = {size, size};
  const Vec2 origin = terrain.georef.to_crs(target.origin);
  raster.georef.origin_x = origin.x;
  raster.georef.origin_y = origin.y;
  if (terrain.georef.geographic)
    program.say(fmt::format("--resolution {} is in metres, as the CRS is geographic", size));
  return target;
}

std::vector<double> quantity_on(const Target& target, const TerrainEvaluator& evaluator, What what,
                                const Context& context) {
  const Raster& r = target.raster;
  std::vector<double> values(r.cells());
  if (what == curvature) {  // needs second derivatives
    parallel_chunks(static_cast<std::size_t>(r.rows), 4, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row)
        for (int column = 0; column < r.columns; ++column) {
          const auto jet = evaluator.jet(
              {target.origin.x + column * target.step.x, target.origin.y - static_cast<double>(row) * target.step.y});
          values[r.index(column, static_cast<int>(row))] = jet ? mean_curvature(*jet) : kNan;
        }
    });
    return values;
  }
  std::vector<Vec2> gradients(what == height ? 0 : r.cells());
  evaluator.grid_values(target.origin, target.step, r.columns, r.rows, values, gradients, context);
  if (what == height) return values;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isnan(values[i])) values[i] = what == slope ? slope_degrees(gradients[i]) : aspect_degrees(gradients[i]);
  return values;
}

/// What the choice of the target needs of a tiled model.
Terrain frame_of(const TiledIndex& index) {
  Terrain frame;
  frame.georef = index.georef;
  frame.grid.columns = index.columns;
  frame.grid.rows = index.rows;
  frame.grid.cell_width = index.cell_width;
  frame.grid.cell_height = index.cell_height;
  return frame;
}

SampledQuantity sampled(What what) {
  if (what == slope) return SampledQuantity::slope;
  if (what == aspect) return SampledQuantity::aspect;
  return what == curvature ? SampledQuantity::curvature : SampledQuantity::height;
}

/// Where `--like` says, without its heights.
Target target_like_place(const Options& options, const Terrain& frame) {
  Target target;
  target.raster = inspect_raster(options.like);
  check_same_crs(frame.georef, options.model, target.raster.georef, options.like);
  const Georef &from = target.raster.georef, &to = frame.georef;
  target.origin = to.to_local(from.to_crs({0, 0}));
  target.step = {target.raster.cell_width * to.scale_x / from.scale_x,
                 target.raster.cell_height * to.scale_y / from.scale_y};
  return target;
}

void say_sampled(const Program& program, const Options& options, const Target& target, What what, std::size_t valid) {
  if (valid == 0) program.say("warning: the model has no data at any cell of this raster");
  const nlohmann::ordered_json json = {{"what", kWhat[what]},
                                       {"columns", target.raster.columns},
                                       {"rows", target.raster.rows},
                                       {"cell_width", target.raster.cell_width},
                                       {"cell_height", target.raster.cell_height},
                                       {"cells", target.raster.cells()},
                                       {"valid_cells", valid}};
  if (program.json) return program.print(json);
  program.say(fmt::format("{}: {} on {} x {} cells, {} with data", options.output, kWhat[what], target.raster.columns,
                          target.raster.rows, valid));
}

void sample_raster(const Program& program, const Options& options) {
  if (options.what.size() > 1)
    throw UsageError("a raster holds one quantity: give one --what, or ask for points with --at", {}, "--what");
  const What what = options.what.empty() ? height : static_cast<What>(choose("--what", options.what[0], kWhat));
  if (what == normal)
    throw UsageError("a normal has three numbers and a raster one: --what normal works with --at and --points", {},
                     "--what");
  check_output(program, options.output,
               options.cog ? std::vector<std::string>{".tif", ".tiff"} : std::vector<std::string>{},
               {options.model, options.like});
  const Context context = program.context();
  const WriteOptions how{.driver = options.cog ? "COG" : "", .overwrite = program.overwrite};
  if (is_tiled_model(options.model) && takes_rows(options.output, how)) {
    TileReader reader(options.model, options.tile_memory.bytes());
    const Terrain frame = frame_of(reader.index());
    Target target = options.like.empty() ? target_of_model(program, options, frame) : target_like_place(options, frame);
    if (what != height) target.raster.height_unit.clear();
    const SampledRaster raster{target.raster, target.origin, target.step};
    const std::size_t valid = write_sampled(reader, raster, sampled(what), options.output, how, context);
    return say_sampled(program, options, target, what, valid);
  }
  const Terrain terrain = load_terrain(options.model);
  Target target = options.like.empty() ? target_of_model(program, options, terrain)
                                       : target_like(program, options, terrain, context);
  check_terrain_need("sampling", terrain, kVertexLoaded, kCellSampled * static_cast<double>(target.raster.cells()),
                     options.model);
  const TerrainEvaluator evaluator(terrain, context);
  std::vector<double> values = quantity_on(target, evaluator, what, context);
  const auto valid =
      static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [](double v) { return !std::isnan(v); }));
  // Single precision: a few parts in 10^8 of a height, and what every tool reads.
  target.raster.heights = std::vector<float>(values.begin(), values.end());
  if (what != height) target.raster.height_unit.clear();
  context.check();
  write_raster(target.raster, options.output, how, context);
  say_sampled(program, options, target, what, valid);
}

/// One point a line: x and y with a comma, a semicolon or white space between; more columns are ignored.
void read_lines(std::istream& in, const std::string& name, std::vector<Vec2>& points) {
  std::string line;
  for (std::size_t number = 1; std::getline(in, line); ++number) {
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\t' || c == '\r'; }, ' ');
    const std::size_t start = line.find_first_not_of(' ');
    if (start == std::string::npos || line[start] == '#') continue;
    char* end = nullptr;
    const double x = std::strtod(line.c_str() + start, &end);
    const char* second = end;
    char* last = nullptr;
    const double y = end == line.c_str() + start ? 0 : std::strtod(second, &last);
    const bool numbers = end != line.c_str() + start && last != second;
    if (!numbers && number == 1) continue;  // a header
    if (!numbers || !std::isfinite(x) || !std::isfinite(y))
      throw BadInput(fmt::format("{}: line {}: expected x and y, found '{}'", name, number, line), name,
                     fmt::format("line {}", number));
    points.push_back({x, y});
  }
  if (in.bad()) throw CannotRead(fmt::format("cannot read {}", name), name);
}

std::vector<Vec2> wanted_points(const Options& options) {
  std::vector<Vec2> points;
  for (const std::string& text : options.at) points.push_back(parse_point("--at", text));
  if (options.points_file == "-") {
    read_lines(std::cin, "standard input", points);
  } else if (!options.points_file.empty()) {
    std::ifstream file(options.points_file);
    if (!file) throw CannotRead(fmt::format("cannot open '{}'", options.points_file), options.points_file);
    read_lines(file, options.points_file, points);
  }
  return points;
}

void sample_points(const Program& program, const Options& options) {
  for (const std::string& word : options.what) choose("--what", word, kWhat);
  const std::vector<Vec2> points = wanted_points(options);
  const Context context = program.context();
  std::optional<TileReader> tiles;
  std::optional<Terrain> terrain;
  std::optional<TerrainEvaluator> evaluator;
  if (is_tiled_model(options.model)) {
    note_input(options.model);
    tiles.emplace(options.model, options.tile_memory.bytes());
  } else {
    terrain = load_terrain(options.model);
    evaluator.emplace(*terrain, context);
  }
  const Georef& georef = tiles ? tiles->index().georef : terrain->georef;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::vector<std::string> header{"x", "y", "z"};
  for (const What w : {slope, aspect})
    if (options.set(w)) header.push_back(kWhat[w]);
  if (options.set(normal)) header.insert(header.end(), {"nx", "ny", "nz"});
  if (options.set(curvature)) header.push_back(kWhat[curvature]);
  header.push_back("valid");
  Table table(header);
  const auto text = [](double v) { return std::isnan(v) ? std::string() : fmt::format("{}", v); };
  for (const Vec2 p : points) {
    const Vec2 local = georef.to_local(p);
    const std::optional<Jet> jet = tiles ? tiles->jet(local) : evaluator->jet(local);
    const Jet at = jet.value_or(Jet{kNan, {kNan, kNan}, kNan, kNan, kNan});
    nlohmann::ordered_json entry = {{"x", p.x}, {"y", p.y}, {"z", at.value}};
    std::vector<std::string> row{text(p.x), text(p.y), text(at.value)};
    const auto add = [&](What w, double value) {
      if (!options.set(w)) return;
      entry[kWhat[w]] = value;
      row.push_back(text(value));
    };
    add(slope, slope_degrees(at.gradient));
    add(aspect, aspect_degrees(at.gradient));
    if (options.set(normal)) {
      const Vec3 n = unit_normal(at.gradient);
      entry[kWhat[normal]] = jet ? nlohmann::ordered_json{n.x, n.y, n.z} : nlohmann::ordered_json(nullptr);
      for (const double v : {n.x, n.y, n.z}) row.push_back(text(v));
    }
    add(curvature, mean_curvature(at));
    entry["valid"] = jet.has_value();
    row.push_back(jet ? "true" : "false");
    list.push_back(entry);
    table.add(row);
  }
  if (program.json)
    program.print(nlohmann::ordered_json{{"points", list}});
  else
    program.print(table.csv());
}

void run(const Program& program, const Options& options) {
  const bool points = !options.at.empty() || !options.points_file.empty();
  if (points == !options.output.empty())
    throw UsageError("give either -o FILE for a raster, or --at X,Y (or --points FILE) for values at points");
  if (points && (!options.like.empty() || options.resolution != 0 || options.cog))
    throw UsageError("--like, --resolution and --cog are for rasters (-o FILE), not for points");
  if (!options.like.empty() && options.resolution != 0) throw UsageError("give --like or --resolution, not both");
  if (!std::isfinite(options.resolution) || options.resolution < 0)
    throw UsageError("--resolution must be above 0", {}, "--resolution");
  if (points)
    sample_points(program, options);
  else
    sample_raster(program, options);
}

}  // namespace

void add_sample(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(root, program, "sample", "Heights, slopes and more of a model, on a raster or at points",
                  "retalho sample dem.retalho -o smooth.tif --like dem.tif\n"
                  "retalho sample dem.retalho -o slope.tif --resolution 5 --what slope\n"
                  "retalho sample dem.retalho --at 512340,4150220 --what slope --what normal --json\n"
                  "retalho sample dem.retalho --points places.csv > heights.csv");
  command->add_option("MODEL", options->model, "A .retalho file")->required()->type_name("");
  command->add_option("-o,--output", options->output, "A raster: .tif, .asc ... (by GDAL)")->type_name("FILE");
  command->add_option("--like", options->like, "The raster whose cells to take (default: the model's own grid)")
      ->type_name("DEM");
  command
      ->add_option("--resolution", options->resolution, "Cell size, in the CRS's unit (metres where it is geographic)")
      ->type_name("R");
  command
      ->add_option("--what", options->what,
                   "height (default); slope, aspect: degrees; normal; curvature: mean, 1 / unit. Repeat it for points")
      ->type_name("KIND");
  command->add_flag("--cog", options->cog, "The raster as a Cloud-Optimised GeoTIFF (.tif), with overviews");
  add_tile_memory_flag(*command, options->tile_memory);
  command->add_option("--at", options->at, "Places in CRS coordinates")->type_name("X,Y");
  command
      ->add_option("--points", options->points_file,
                   "Places from a text file, x and y first on each line; -: standard input")
      ->type_name("FILE");
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
