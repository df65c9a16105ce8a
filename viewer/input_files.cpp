#include "input_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "curve_calls.h"
#include "patch_calls.h"
#include "retalho/cloud/normals.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/curve/document.h"
#include "retalho/curve/expression.h"
#include "retalho/model/model.h"
#include "retalho/model/tiled.h"
#include "retalho/patch/document.h"
#include "retalho/raster/io.h"
#include "retalho/tetraquad/document.h"
#include "tetraquad_calls.h"

namespace retalho::viewer {
namespace {

/// Hills and a gorge by formula, so that the page has something to show with no file at hand.
Raster example_grid() {
  constexpr int kSide = 241;
  Raster raster;
  raster.columns = raster.rows = kSide;
  raster.cell_width = raster.cell_height = 10;
  raster.georef.unit = "metre";
  std::vector<float> heights;
  heights.reserve(raster.cells());
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const double x = (c - 120) / 60.0, y = (r - 120) / 60.0;
      const double hills = 160 * std::exp(-(x - 0.6) * (x - 0.6) - (y + 0.4) * (y + 0.4) * 1.7) +
                           110 * std::exp(-2.2 * (x + 0.9) * (x + 0.9) - 1.3 * (y - 0.7) * (y - 0.7)) +
                           18 * std::sin(2.6 * x + 1.1 * y) * std::cos(1.9 * y - 0.8 * x);
      const double bed = y - 0.35 * std::sin(2.1 * x) - 0.1;
      heights.push_back(static_cast<float>(250 + hills - 70 * std::exp(-26 * bed * bed) + 12 * x));
    }
  raster.heights = std::move(heights);
  return raster;
}

void add_tetraquad(InputFiles& inputs, const std::string& path, const std::string& name, TetraQuad surface) {
  if (surface.mesh.tets.size() > kMostTets)
    throw BadInput(fmt::format("'{}' has {} tetrahedra, more than the page draws ({}): draw it with `retalho render`",
                               path, surface.mesh.tets.size(), kMostTets),
                   path);
  std::string words =
      fmt::format("TetraQuad, {} vertices, {} tetrahedra", surface.mesh.lattice.size(), surface.mesh.tets.size());
  inputs.tetraquads.push_back({name, std::move(words), std::make_shared<const TetraQuad>(std::move(surface))});
}

TerrainInput read_grid(const std::string& path, const std::string& name, const Context& context) {
  ReadNotes notes;
  auto grid = std::make_shared<Raster>(read_raster(path, {}, &notes, context));
  const RasterSummary summary = summarize(*grid);
  if (summary.valid < 3)
    throw BadInput(fmt::format("'{}' has fewer than three heights: there is no surface", path), path);
  return {name, describe(*grid, notes, summary), std::move(grid), nullptr};
}

void add_cloud(InputFiles& inputs, const std::string& path, const std::string& name, const Context& context) {
  PointNotes notes;
  PointCloud cloud = read_points(path, {}, &notes, context);
  std::string words = describe(cloud, notes, summarize(cloud));
  const bool given =
      std::any_of(cloud.normals.begin(), cloud.normals.end(), [](const Vec3& n) { return norm2(n) > 0; });
  if (!given || cloud.normals.size() != cloud.positions.size()) {
    cloud.normals = estimate_normals(cloud.positions, {}, nullptr, context);
    words += "; normals estimated";
  }
  inputs.clouds.push_back({name, std::move(words), std::make_shared<const PointCloud>(std::move(cloud))});
}

void read_model(InputFiles& inputs, const std::string& path, const std::string& name) {
  Model model = load_model(path);
  if (auto* terrain = std::get_if<Terrain>(&model)) {
    std::string words = fmt::format("{} model, {} vertices, {} triangles", surface_name(terrain->kind),
                                    terrain->tin.vertex_count(), terrain->tin.triangle_count());
    inputs.terrains.push_back({name, std::move(words), nullptr, std::make_shared<const Terrain>(std::move(*terrain))});
  } else if (auto* surface = std::get_if<TetraQuad>(&model)) {
    add_tetraquad(inputs, path, name, std::move(*surface));
  } else {
    auto& set = std::get<PatchSet>(model);
    std::size_t triangles = 0;
    for (const Patch& patch : set.patches) triangles += patch.domain.triangles.size();
    if (triangles > kMostPatchTriangles)
      throw BadInput(fmt::format("'{}' has {} triangles, more than the page draws ({}): draw it with `retalho render`",
                                 path, triangles, kMostPatchTriangles),
                     path);
    inputs.patches.push_back({name, fmt::format("model of {} patches, {} triangles", set.patches.size(), triangles),
                              nullptr, std::make_shared<const PatchSet>(std::move(set))});
  }
}

/// Of all tiles, those on seams as often as tiles have them.
std::size_t vertices_of(const std::string& tiles) {
  std::size_t sum = 0;
  for (const TileEntry& entry : read_tiled_index(tiles).tiles) sum += entry.vertices;
  return sum;
}

void add_tiles(InputFiles& inputs, const std::string& path, const std::string& name, const Context& context) {
  auto tiles = std::make_shared<TiledTerrain>(path, TileReader::kBound, context);
  const TiledIndex& index = tiles->index();
  std::string words = fmt::format("{} model of {} x {} cells in {} tiles, shown by its tiles: coarse where it is far",
                                  surface_name(index.surface), index.columns, index.rows, index.tiles.size());
  inputs.terrains.push_back({name, std::move(words), nullptr, nullptr, std::move(tiles)});
}

/// The text as JSON. Throws CannotRead with line and column.
Json parse_json(const std::string& text, const std::string& path) {
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::string_view before = std::string_view(text).substr(0, error.byte > 0 ? error.byte - 1 : 0);
    const std::size_t start = before.rfind('\n');
    throw CannotRead(
        fmt::format("'{}' is not JSON (line {}, column {})", path, 1 + std::count(before.begin(), before.end(), '\n'),
                    start == std::string_view::npos ? before.size() + 1 : before.size() - start),
        path);
  }
}

/// What is wrong is said with the file's name.
template <class Check>
void in_file(const std::string& path, Check&& check) {
  try {
    check();
  } catch (const BadInput& error) {
    throw BadInput(error.what(), path, error.where());
  }
}

void add_curves(InputFiles& inputs, const std::string& path, const std::string& name, const std::string& text,
                Json json) {
  const CurveDocument document = parse_curves(text, path);
  in_file(path, [&] {
    check_size(document);
    for (std::size_t i = 0; i < document.curves.size(); ++i) {
      const CurveSpec& spec = document.curves[i];
      if (spec.kind == CurveKind::implicit_form || spec.kind == CurveKind::explicit_form)
        Expression::parse(spec.f);
      else
        to_curve(spec, fmt::format("curves[{}]", i));
    }
  });
  inputs.curves.push_back({name, fmt::format("{} curves", document.curves.size()), std::move(json)});
}

void add_patches(InputFiles& inputs, const std::string& path, const std::string& name, const std::string& text,
                 Json json) {
  const std::vector<PatchSpec> specs = parse_patches(text, path);
  in_file(path, [&] {
    for (const PatchSpec& spec : specs) join_sides(spec.sides, {}, spec.where);
  });
  if (specs.size() > kMostPatches)
    throw BadInput(fmt::format("'{}' has {} patches, more than the page shows ({})", path, specs.size(), kMostPatches),
                   path);
  inputs.patches.push_back({name, fmt::format("{} patches by their curves", specs.size()), std::move(json), nullptr});
}

void read_json(InputFiles& inputs, const std::string& path, const std::string& name) {
  const std::string text = read_file(path);
  Json json = parse_json(text, path);
  if (json.is_object() && json.contains("patches"))
    add_patches(inputs, path, name, text, std::move(json));
  else if (json.is_object() && json.contains("tetrahedra"))
    add_tetraquad(inputs, path, name, parse_quadrics(text, path));
  else if (json.is_object() && json.contains("curves"))
    add_curves(inputs, path, name, text, std::move(json));
  else if (json.is_object() && json.contains("tiles"))
    throw BadInput(fmt::format("'{}' is the index of a tiled model: give its folder", path), path);
  else
    throw BadInput(fmt::format("'{}' is JSON of a kind that the page does not show: it shows patches, curves and "
                               "quadrics, by the keys \"patches\", \"curves\" and \"tetrahedra\"",
                               path),
                   path);
}

/// The view of the one file that has been read.
std::string view_of_first(const InputFiles& inputs) {
  return !inputs.terrains.empty()  ? "terrain"
         : !inputs.curves.empty()  ? "curves"
         : !inputs.patches.empty() ? "patches"
                                   : "tetraquads";
}

}  // namespace

InputFiles read_inputs(const std::vector<std::string>& paths, const Context& context, std::size_t most_joined) {
  InputFiles inputs;
  for (const std::string& path : paths) {
    std::string name = std::filesystem::path(path).filename().string();
    if (name.empty()) name = std::filesystem::path(path).parent_path().filename().string();  // a folder with a slash
    if (is_tiled_model(path) && vertices_of(path) > most_joined)
      add_tiles(inputs, path, name, context);
    else if (is_model_file(path))
      read_model(inputs, path, name);
    else if (std::filesystem::path(path).extension() == ".json")
      read_json(inputs, path, name);
    else if (is_point_file(path))
      add_cloud(inputs, path, name, context);
    else
      inputs.terrains.push_back(read_grid(path, name, context));
    if (inputs.first_view == "start") inputs.first_view = view_of_first(inputs);
  }
  if (inputs.terrains.empty()) {
    inputs.terrains_given = false;
    auto grid = std::make_shared<Raster>(example_grid());
    inputs.terrains.push_back({"Example: hills and a gorge",
                               fmt::format("{} x {} cells of 10 metre, made by formula", grid->columns, grid->rows),
                               std::move(grid), nullptr});
  }
  return inputs;
}

}  // namespace retalho::viewer
