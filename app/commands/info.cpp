// retalho info: what a raster, a point file or a model is.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "inputs.h"
#include "needs.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/model/tiled.h"
#include "retalho/terrain/height_range.h"
#include "table.h"

namespace retalho::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string file;
  GridFlags grid;
  PointOptions points;
};

/// [xmin, ymin, xmax, ymax] in the CRS, of a box in local coordinates.
Json bounds_json(const Georef& georef, Vec2 low, Vec2 high) {
  const Vec2 a = georef.to_crs(low), b = georef.to_crs(high);
  return {a.x, a.y, b.x, b.y};
}

void add_place(Json& result, const Georef& georef) {
  result["crs"] = crs_name(georef.crs_wkt).empty() ? Json(nullptr) : Json(crs_name(georef.crs_wkt));
  result["unit"] = georef.unit;
  result["geographic"] = georef.geographic;
}

Json raster_info(const Options& options, const Context& context) {
  ReadNotes notes;
  check_grid_need({}, options.file, options.grid.band);
  const Raster raster = read_raster(options.file, {options.grid.band, options.grid.nodata}, &notes, context);
  const RasterSummary summary = summarize(raster);
  Json result = {{"file", options.file},
                 {"kind", "raster"},
                 {"driver", notes.driver},
                 {"data_type", notes.data_type},
                 {"bands", notes.bands},
                 {"columns", raster.columns},
                 {"rows", raster.rows},
                 {"cell_width", raster.cell_width},
                 {"cell_height", raster.cell_height}};
  add_place(result, raster.georef);
  if (!notes.crs_name.empty()) result["crs"] = notes.crs_name;
  // Whole cells: half a cell beyond the outer centres.
  result["bounds"] =
      bounds_json(raster.georef, raster.centre(-0.5, raster.rows - 0.5), raster.centre(raster.columns - 0.5, -0.5));
  result["cells"] = summary.cells;
  result["valid_cells"] = summary.valid;
  result["minimum"] = summary.minimum;
  result["maximum"] = summary.maximum;
  result["mean"] = summary.mean;
  result["height_unit"] = raster.height_unit.empty() ? Json(nullptr) : Json(raster.height_unit);
  result["nodata"] = notes.nodata ? Json(*notes.nodata) : Json(nullptr);
  result["scale"] = notes.scale;
  result["offset"] = notes.offset;
  result["infinite"] = notes.infinite;
  result["remarks"] = notes.remarks;
  return result;
}

Json point_info(const Options& options, const Context& context) {
  check_file_need("reading the points of", kPointFile, options.file);
  PointNotes notes;
  const PointCloud cloud = read_points(options.file, options.points, &notes, context);
  const PointSummary summary = summarize(cloud);
  Json result = {{"file", options.file},     {"kind", "points"},         {"format", notes.format},
                 {"columns", notes.columns}, {"points", summary.points}, {"normals", !cloud.normals.empty()},
                 {"skipped", notes.skipped}};
  add_place(result, cloud.georef);
  if (!notes.crs_name.empty()) result["crs"] = notes.crs_name;
  result["bounds"] =
      bounds_json(cloud.georef, {summary.minimum.x, summary.minimum.y}, {summary.maximum.x, summary.maximum.y});
  result["minimum"] = summary.minimum.z;
  result["maximum"] = summary.maximum.z;
  result["remarks"] = notes.remarks;
  return result;
}

Json model_info(const Options& options, const Terrain& terrain) {
  const Tin& tin = terrain.tin;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec2 low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};
  for (const Vec2 p : tin.points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  const HeightRange range = height_range(terrain);
  Json result = {{"file", options.file},
                 {"kind", "terrain"},
                 {"surface", surface_name(terrain.kind)},
                 {"gradients", gradient_name(terrain.gradient_kind)},
                 {"vertices", tin.vertex_count()},
                 {"triangles", tin.triangle_count()},
                 {"patches", tin.triangle_count() * static_cast<std::size_t>(patches_per_triangle(terrain.kind))},
                 {"coefficients", coefficient_count(terrain)},
                 {"numbers", number_count(terrain)},
                 {"bytes", model_size(options.file)}};
  if (terrain.kind == SurfaceKind::clough_tocher)
    result["cross_derivative"] = terrain.cross_derivative == CrossDerivative::cubic ? "cubic" : "perpendicular";
  result["tolerance"] = terrain.tolerance > 0 ? Json(terrain.tolerance) : Json(nullptr);
  add_place(result, terrain.georef);
  result["bounds"] = bounds_json(terrain.georef, low, high);
  result["minimum"] = tin.heights.empty() ? Json(nullptr) : Json(range.low);
  result["maximum"] = tin.heights.empty() ? Json(nullptr) : Json(range.high);
  if (const GridDomain& grid = terrain.grid; grid.columns > 0) {
    const std::size_t cells = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
    result["grid"] = {{"columns", grid.columns},
                      {"rows", grid.rows},
                      {"cell_width", grid.cell_width},
                      {"cell_height", grid.cell_height},
                      {"valid_cells", grid.valid.empty() ? cells : grid.valid.count()}};
  }
  return result;
}

Json model_info(const Options& options, const TetraQuad& surface) {
  const TetraQuadField field(surface);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  std::vector<char> live(surface.mesh.lattice.size(), 0);
  std::size_t crossed = 0;
  for (std::size_t t = 0; t < surface.mesh.tets.size(); ++t) {
    if (!field.crosses(t)) continue;
    ++crossed;
    for (const std::uint32_t v : surface.mesh.tets[t]) {
      live[v] = 1;
      const Vec3 p = surface.mesh.position(v);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  Json result = {{"file", options.file},
                 {"kind", "tetraquad"},
                 {"split", surface.mesh.split == TetSplit::five ? "five" : "kuhn"},
                 {"step", surface.mesh.step},
                 {"vertices", surface.mesh.lattice.size()},
                 {"tetrahedra", surface.mesh.tets.size()},
                 {"crossed", crossed},
                 {"coefficients", 10 * std::count(live.begin(), live.end(), 1)},
                 {"bytes", model_size(options.file)}};
  add_place(result, surface.georef);
  if (crossed > 0) {  // of the tetrahedra that the surface passes through
    result["bounds"] = bounds_json(surface.georef, {low.x, low.y}, {high.x, high.y});
    result["minimum"] = low.z;
    result["maximum"] = high.z;
  }
  return result;
}

Json model_info(const Options& options, const PatchSet& set) {
  std::size_t nodes = 0, triangles = 0;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  Json names = Json::array();
  for (const Patch& patch : set.patches) {
    nodes += patch.positions.size();
    triangles += patch.domain.triangles.size();
    names.push_back(patch.name);
    for (const Vec3 p : patch.positions) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return {{"file", options.file},
          {"kind", "patches"},
          {"recovery", recovery_name(set.patches[0].recovery)},
          {"patches", set.patches.size()},
          {"names", names},
          {"nodes", nodes},
          {"triangles", triangles},
          {"bytes", model_size(options.file)},
          {"bounds", {low.x, low.y, high.x, high.y}},
          {"minimum", low.z},
          {"maximum", high.z}};
}

Json info(const Options& options, const Context& context) {
  if (is_model_file(options.file)) {
    check_file_need("reading the model", kModelFile, options.file);
    return std::visit([&](const auto& shape) { return model_info(options, shape); }, load_model(options.file));
  }
  if (std::filesystem::path(options.file).extension() == ".retalho") load_model(options.file);  // says what is wrong
  if (is_point_file(options.file) || !options.points.height_field.empty() || !options.points.layer.empty())
    return point_info(options, context);
  try {
    return raster_info(options, context);
  } catch (const CannotRead& as_raster) {
    if (!std::filesystem::exists(options.file)) throw;
    try {  // a vector layer
      return point_info(options, context);
    } catch (const CannotRead&) {
      throw as_raster;
    }
  }
}

std::string value_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_null()) return "none";
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return fmt::format("{:.10g}", value.get<double>());
  if (value.is_array()) {
    std::string words;
    for (const Json& item : value) words += (words.empty() ? "" : item.is_string() ? "; " : " ") + value_text(item);
    return words;
  }
  if (value.is_object()) {
    std::string words;
    for (const auto& [key, item] : value.items())
      words += fmt::format("{}{} {}", words.empty() ? "" : ", ", key, value_text(item));
    return words;
  }
  return value.dump();
}

void run(const Program& program, const Options& options) {
  const Json result = info(options, program.context());
  if (program.json) return program.print(result);
  std::vector<std::pair<std::string, std::string>> lines;
  for (const auto& [key, value] : result.items())
    if (!(value.is_array() && value.empty())) lines.emplace_back(key, value_text(value));
  program.print(list_text(lines));
}

}  // namespace

void add_info(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, program, "info", "What a raster, a point file or a model is",
                                  "retalho info dem.tif\n"
                                  "retalho info dem.retalho --json\n"
                                  "retalho info soundings.xyz");
  command->add_option("FILE", options->file, "Raster, points or model")->required()->type_name("");
  add_grid_flags(*command, options->grid);
  command
      ->add_option("--height-field", options->points.height_field, "Vector layers: the attribute that holds the height")
      ->type_name("NAME");
  command->add_option("--layer", options->points.layer, "Vector files: which layer")->type_name("NAME");
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
