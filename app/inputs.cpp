#include "inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "checks.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/model/tiled.h"

namespace retalho::app {
namespace {

std::string& input() {
  static std::string path;
  return path;
}

/// The number at the start of `text`, which must be finite; moves `text` behind it. nullopt when there is none.
std::optional<double> take_number(const char*& text) {
  char* end = nullptr;
  const double value = std::strtod(text, &end);
  if (end == text || !std::isfinite(value)) return std::nullopt;
  text = end;
  return value;
}

}  // namespace

void note_input(const std::string& path) {
  input() = path;
}
const std::string& noted_input() {
  return input();
}

void add_grid_flags(CLI::App& command, GridFlags& flags) {
  command.add_option("--band", flags.band, "Band of the raster, from 1")->type_name("N")->check(above_zero());
  command.add_option("--nodata", flags.nodata, "Heights equal to this are void too")->type_name("V");
}

Raster load_grid(const Program& program, const std::string& path, const GridFlags& flags, RasterSummary& summary,
                 const Context& context, const Need& need) {
  note_input(path);
  ReadNotes notes;
  const Stopwatch watch;
  check_grid_need(need, path, flags.band);
  Raster raster = read_raster(path, {flags.band, flags.nodata}, &notes, context);
  summary = summarize(raster);
  program.say(fmt::format("{}: {}", path, retalho::describe(raster, notes, summary)));
  for (const std::string& remark : notes.remarks) program.say("  " + remark);
  program.detail(fmt::format("reading: {:.3f} s", watch.seconds()));
  return raster;
}

PointCloud load_points(const Program& program, const std::string& path, const PointOptions& options,
                       const Context& context) {
  note_input(path);
  PointNotes notes;
  check_file_need("reading the points of", kPointFile, path);
  const Stopwatch watch;
  PointCloud cloud = read_points(path, options, &notes, context);
  program.say(fmt::format("{}: {}", path, retalho::describe(cloud, notes, summarize(cloud))));
  for (const std::string& remark : notes.remarks) program.say("  " + remark);
  program.detail(fmt::format("reading: {:.3f} s", watch.seconds()));
  return cloud;
}

bool takes_points(const std::string& path, const PointOptions& options) {
  if (is_point_file(path) || !options.height_field.empty() || !options.layer.empty()) return true;
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  static const std::vector<std::string> vectors{".shp", ".geojson", ".json", ".fgb", ".gml", ".kml", ".gpkg"};
  return std::find(vectors.begin(), vectors.end(), ending) != vectors.end();
}

Model load_any_model(const std::string& path, ModelFileNotes* notes) {
  note_input(path);
  if (std::filesystem::exists(path) && !is_model_file(path))
    throw CannotRead(fmt::format("'{}' is not a model file of retalho: make one with `retalho fit`", path), path);
  if (is_tiled_model(path)) {
    std::size_t vertices = 0;
    for (const TileEntry& entry : read_tiled_index(path).tiles) vertices += entry.vertices;
    check_vertex_need("joining the tiles of", vertices, kVertexLoaded, 0, path);
  } else {
    check_file_need("reading the model", kModelFile, path);
  }
  return load_model(path, notes);
}

std::size_t TileMemoryFlag::bytes() const {
  constexpr double kMost = 1 << 30;  // a million gigabytes: the number of bytes fits
  if (!(megabytes >= 1 && megabytes <= kMost))
    throw UsageError(fmt::format("--tile-memory must be 1 MB or more, not {:g}", megabytes), {}, "--tile-memory");
  return static_cast<std::size_t>(megabytes) << 20;
}

void add_tile_memory_flag(CLI::App& command, TileMemoryFlag& flag) {
  command.add_option("--tile-memory", flag.megabytes, "Tiled models: how much of them is kept in memory (default 512)")
      ->type_name("MB");
}

Terrain load_terrain(const std::string& path, ModelFileNotes* notes) {
  Model model = load_any_model(path, notes);
  if (Terrain* terrain = std::get_if<Terrain>(&model)) return std::move(*terrain);
  throw BadInput(fmt::format("'{}' holds no terrain: this command works on models made by `retalho fit`", path), path);
}

std::string crs_name(const std::string& wkt) {
  const std::size_t open = wkt.find('"');
  const std::size_t close = open == std::string::npos ? open : wkt.find('"', open + 1);
  return close == std::string::npos ? std::string() : wkt.substr(open + 1, close - open - 1);
}

void check_same_crs(const Georef& a, const std::string& a_file, const Georef& b, const std::string& b_file) {
  const std::string a_name = crs_name(a.crs_wkt), b_name = crs_name(b.crs_wkt);
  if (a_name.empty() || b_name.empty() || a_name == b_name) return;
  throw BadInput(fmt::format("'{}' is in the CRS '{}', '{}' in '{}': bring one into the other's (gdalwarp) first",
                             a_file, a_name, b_file, b_name),
                 a_file);
}

Vec2 parse_point(const std::string& option, const std::string& text) {
  const char* at = text.c_str();
  const std::optional<double> x = take_number(at);
  const bool comma = *at == ',';
  if (comma) ++at;
  const std::optional<double> y = take_number(at);
  if (!x || !comma || !y || *at != '\0')
    throw UsageError(fmt::format("{}: '{}' is not X,Y: two numbers with a comma and no space", option, text), {},
                     option);
  return {*x, *y};
}

std::pair<int, int> parse_size(const std::string& option, const std::string& text) {
  const char* at = text.c_str();
  const std::optional<double> width = take_number(at);
  const bool cross = *at == 'x' || *at == 'X';
  if (cross) ++at;
  const std::optional<double> height = take_number(at);
  const auto good = [](std::optional<double> v) { return v && *v >= 16 && *v <= 20000 && *v == std::floor(*v); };
  if (!good(width) || !cross || !good(height) || *at != '\0')
    throw UsageError(fmt::format("{}: '{}' is not WxH in pixels, such as 1200x800 (16 to 20000)", option, text), {},
                     option);
  return {static_cast<int>(*width), static_cast<int>(*height)};
}

double parse_ratio(const std::string& option, const std::string& text) {
  const char* at = text.c_str();
  std::optional<double> value = take_number(at);
  if (value && *at == '%') {
    *value /= 100;
    ++at;
  }
  if (!value || *at != '\0' || !(*value > 0) || *value > 1)
    throw UsageError(fmt::format("{}: '{}' is not a share of the valid cells, such as 1% or 0.01", option, text), {},
                     option);
  return *value;
}

}  // namespace retalho::app
