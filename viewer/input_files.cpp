#include "input_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "retalho/cloud/normals.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/raster/io.h"
#include "retalho/tetraquad/document.h"

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

void add_tetraquad(InputFiles& inputs, const std::string& name, TetraQuad surface) {
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
    add_tetraquad(inputs, name, std::move(*surface));
  } else {
    throw BadInput(
        fmt::format("'{}' holds triangular patches, which the page makes from curves: save the curves as JSON and open "
                    "them in the page, or draw the model with `retalho render`",
                    path),
        path);
  }
}

}  // namespace

InputFiles read_inputs(const std::vector<std::string>& paths, const Context& context) {
  InputFiles inputs;
  for (const std::string& path : paths) {
    const std::string name = std::filesystem::path(path).filename().string();
    if (is_model_file(path))
      read_model(inputs, path, name);
    else if (std::filesystem::path(path).extension() == ".json")
      add_tetraquad(inputs, name, read_quadrics(path));
    else if (is_point_file(path))
      add_cloud(inputs, path, name, context);
    else
      inputs.terrains.push_back(read_grid(path, name, context));
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
