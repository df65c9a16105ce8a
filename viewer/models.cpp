#include "models.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>

#include "retalho/core/error.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tin/refine.h"

namespace retalho::viewer {
namespace {

constexpr std::size_t kMostKept = 6;  // a page shows three at once, and one step back stays quick

Terrain fit_grid(const Raster& raster, SurfaceKind surface, const std::string& how, double max_error,
                 std::size_t vertices, const Context& context) {
  if (how == "surface")
    return refine_surface(raster, {.surface = surface, .max_error = max_error, .vertices = vertices}, context);
  Terrain terrain =
      make_terrain(refine_tin(raster, {max_error, vertices}, context), raster, {.surface = surface}, context);
  if (how == "interpolate") return terrain;
  return fit_least_squares(std::move(terrain), raster, {.heights_only = how == "z-only"}, context);
}

}  // namespace

ModelPointer Models::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  for (const ModelPointer& one : kept_)
    if (one->id == id) return one;
  return nullptr;
}

ModelPointer Models::get(const Json& input) const {
  ModelPointer model = find(text(input, "model", 200));
  if (!model) throw BadInput("this model is no longer kept: fit it again", {}, "model");
  return model;
}

ModelPointer Models::fit(const Json& input, const Context& context) {
  const auto begun = std::chrono::steady_clock::now();
  const auto file = static_cast<std::size_t>(whole(input, "file", 0, static_cast<std::int64_t>(inputs_.size()) - 1));
  const TerrainInput& source = inputs_[file];
  auto model = std::make_shared<FittedModel>();
  model->file = file;
  model->grid = source.grid;
  if (source.tiles) {
    model->id = fmt::format("{}", file);
    if (ModelPointer known = find(model->id)) return known;
    model->tiles = source.tiles;
  } else if (source.model) {
    model->id = fmt::format("{}", file);
    if (ModelPointer known = find(model->id)) return known;
    model->terrain = source.model;
  } else {
    const std::string surface = word(input, "surface", {"linear", "powell-sabin", "clough-tocher"});
    const std::string how = word(input, "fit", {"interpolate", "least-squares", "z-only", "surface"});
    const double max_error = number_or(input, "max_error", 0, 1e9, 0);
    const auto vertices =
        input.contains("vertices") ? static_cast<std::size_t>(whole(input, "vertices", 4, 4'000'000)) : 0;
    if (how == "surface" && max_error == 0 && vertices == 0)
      throw BadInput("a fit by the surface's own error needs a tolerance over 0 or a number of vertices", {},
                     "max_error");
    model->id = fmt::format("{} {} {} {} {}", file, surface, how, max_error, vertices);
    if (ModelPointer known = find(model->id)) return known;
    Terrain terrain = fit_grid(*source.grid, *parse_surface(surface), how, max_error, vertices, context);
    terrain.tolerance = max_error;
    model->errors = assess(terrain, *source.grid, max_error, context);
    model->terrain = std::make_shared<const Terrain>(std::move(terrain));
  }
  if (model->terrain) {
    model->evaluator = std::make_unique<TerrainEvaluator>(*model->terrain, context);
    model->bends = measure_bends(*model->evaluator, context);
  }
  model->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  const std::lock_guard lock(mutex_);
  kept_.push_front(model);
  if (kept_.size() > kMostKept) kept_.pop_back();
  return model;
}

Models::Ground Models::grid_of(const FittedModel& model, Vec2 around, double radius, const Context& context) {
  if (model.grid) return {model.grid, {}};
  if (!model.tiles) return {std::make_shared<const Raster>(raster_of_cells(*model.evaluator, context)), {}};
  const TiledIndex& index = model.tiles->index();
  const auto range = [&](double at, double cell, int count) {
    if (radius == 0) return std::pair{0, count};
    const double reach = radius / cell + 1;
    const auto within = [&](double c) { return static_cast<int>(std::clamp(c, 0.0, count - 1.0)); };
    const int first = within(std::floor(at / cell - reach));
    return std::pair{first, within(std::ceil(at / cell + reach)) - first + 1};
  };
  const auto [column, columns] = range(around.x, index.cell_width, index.columns);
  const auto [row, rows] = range(-around.y, index.cell_height, index.rows);
  if (static_cast<double>(columns) * rows > kMostSeen)
    throw BadInput(fmt::format("{} x {} cells are more than the page can look over: give a smaller radius, or use "
                               "`retalho viewshed`",
                               columns, rows),
                   {}, "radius");
  return {
      std::make_shared<const Raster>(raster_of_window(model.tiles->reader(), {column, row, columns, rows}, context)),
      {column * index.cell_width, -row * index.cell_height}};
}

namespace {

Json tiles_json(const FittedModel& model) {
  const TiledIndex& index = model.tiles->index();
  std::size_t vertices = 0, triangles = 0;
  for (const TileEntry& entry : index.tiles) {
    vertices += entry.vertices;
    triangles += entry.triangles;
  }
  return {{"surface", surface_name(index.surface)},
          {"gradients", gradient_name(index.surface == SurfaceKind::linear ? GradientKind::none
                                      : index.fitted                       ? GradientKind::fitted
                                                                           : GradientKind::normals)},
          {"vertices", vertices},
          {"triangles", triangles},
          {"coefficients", vertices * (index.surface == SurfaceKind::linear ? 1 : 3)},
          {"tiles", index.tiles.size()},
          {"tolerance", index.max_error},
          {"seconds", model.seconds}};
}

}  // namespace

Json report_json(const FittedModel& model) {
  if (model.tiles) return tiles_json(model);
  const Terrain& terrain = *model.terrain;
  Json json = {{"surface", surface_name(terrain.kind)},
               {"gradients", gradient_name(terrain.gradient_kind)},
               {"vertices", terrain.tin.vertex_count()},
               {"triangles", terrain.tin.triangle_count()},
               {"coefficients", coefficient_count(terrain)},
               {"numbers", number_count(terrain)},
               {"tolerance", terrain.tolerance},
               {"seconds", model.seconds}};
  if (!model.errors) return json;
  const ErrorReport& e = *model.errors;
  json["rmse"] = e.rmse;
  json["max_error"] = e.max_error;
  json["max_error_at"] = {e.max_error_at.x, e.max_error_at.y};
  json["slope_rmse"] = e.slope_rmse;
  json["cells"] = e.cells;
  json["valid_cells"] = e.valid_cells;
  json["violations"] = e.violations;
  return json;
}

}  // namespace retalho::viewer
