#include "contour_surface.h"

#include <fmt/format.h>

#include <algorithm>

#include "needs.h"
#include "retalho/core/error.h"
#include "retalho/core/in_order.h"
#include "retalho/model/model.h"
#include "retalho/model/tiled.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/height_range.h"
#include "retalho/tiles/source.h"
#include "retalho/tin/refine.h"

namespace retalho::app {
namespace {

const std::vector<std::string> kSurfaces{"bicubic", "linear", "powell-sabin", "clough-tocher"};
const std::vector<std::string> kTwists{"spline", "adini", "zero"};
const std::vector<std::string> kEnds{"not-a-knot", "natural"};

void measure(TracedSurface& surface) {
  const Terrain& terrain = *surface.terrain;
  const HeightRange range = height_range(terrain);
  surface.low = range.low;
  surface.high = range.high;
  surface.cell =
      terrain.grid.columns > 0 ? std::min(terrain.grid.cell_width, terrain.grid.cell_height) : mean_edge(terrain.tin);
}

/// A tiled model of which no more is read at a time than the bound allows.
void open_tiles(TracedSurface& surface, const SurfaceChoice& options, const Context& context) {
  surface.tiles = tile_source(options.input, options.tile_memory.bytes());
  surface.range = measure_range(*surface.tiles, context);
  if (!surface.range.data)
    throw CannotRead(fmt::format("no tile of '{}' holds any data", options.input), options.input);
  surface.low = surface.range.low;
  surface.high = surface.range.high;
  surface.cell = std::min(surface.tiles->cell_width, surface.tiles->cell_height);
}

}  // namespace

double mean_edge(const Tin& tin) {
  double sum = 0;
  for (const auto& t : tin.triangles) sum += norm(tin.points[t[1]] - tin.points[t[0]]);
  return tin.triangles.empty() ? 1 : sum / static_cast<double>(tin.triangles.size());
}

TracedSurface load_surface(const Program& program, const SurfaceChoice& options, const Context& context) {
  TracedSurface surface;
  const bool model = is_model_file(options.input);
  const bool points = !model && takes_points(options.input, options.points);
  const std::string kind = !options.kind.empty() ? options.kind : points ? "clough-tocher" : "bicubic";
  const std::size_t chosen = choose("--surface", kind, kSurfaces);
  if (model) {
    if (!options.kind.empty())
      throw UsageError("a model has its surface already: --surface is for grids and points", {}, "--surface");
    if (options.budget.given())
      throw UsageError(
          "a model has its vertices already: --max-error, --vertices and --ratio are for grids and points");
    if (!options.joined && is_tiled_model(options.input)) {
      open_tiles(surface, options, context);
      return surface;
    }
    surface.terrain = load_terrain(options.input);
    check_terrain_need("contouring", *surface.terrain, kVertexLoaded, 0, options.input);
    measure(surface);
    return surface;
  }
  if (points) {
    if (chosen == 0) throw UsageError("--surface bicubic needs a grid: points take the other three", {}, "--surface");
    const PointCloud cloud = load_points(program, options.input, options.points, context);
    SurfaceFlags flags;
    flags.surface = kind;
    check_breakline_budget(options.breaklines, options.budget.given());
    ConstrainedTin made;
    if (options.budget.given()) {
      const PointSummary summary = summarize(cloud);
      const Budget budget =
          resolve(program, options.budget, cloud.positions.size(), summary.maximum.z - summary.minimum.z);
      made.tin = refine_points(cloud.positions, {budget.max_error, budget.vertices}, nullptr, context);
    } else {
      made = triangulate(program, cloud, options.input, options.breaklines, nullptr, context);
    }
    SurfaceOptions how = resolve(flags, true);
    how.creases = std::move(made.edges);
    surface.terrain = make_terrain(std::move(made.tin), cloud.georef, how, context);
    measure(surface);
    return surface;
  }
  RasterSummary summary;
  Need need{"contouring"};
  if (chosen == 0 && options.whole) need.a_cell = kCellContoured;
  if (chosen == 0 && !options.whole) need.a_column = kColumnStreamed * static_cast<double>(slot_count(context));
  Raster raster = load_grid(program, options.input, options.grid, summary, context, need);
  if (chosen == 0) {
    if (options.budget.given())
      throw UsageError("--surface bicubic takes every cell: --max-error, --vertices and --ratio are for the others", {},
                       "--surface");
    surface.bicubic = {.ends = static_cast<TangentEnds>(choose("--ends", options.ends, kEnds)),
                       .twist = *parse_twist(kTwists[choose("--twist", options.twist, kTwists)]),
                       .keep_flats = !options.ring};
    surface.low = summary.minimum;
    surface.high = summary.maximum;
    surface.cell = std::min(raster.cell_width, raster.cell_height);
    surface.height_unit = raster.height_unit;
    surface.raster = std::move(raster);
    return surface;
  }
  const Budget budget = resolve(program, options.budget, summary.valid, summary.maximum - summary.minimum);
  SurfaceFlags flags;
  flags.surface = kind;
  surface.terrain = make_terrain(refine_tin(raster, {budget.max_error, budget.vertices}, context), raster,
                                 resolve(flags, false), context);
  measure(surface);
  return surface;
}

}  // namespace retalho::app
