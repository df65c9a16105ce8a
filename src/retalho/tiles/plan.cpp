#include "retalho/tiles/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr int kLeastSize = 16, kMostSize = 16384;
constexpr int kNaming = 1;  // to be raised when the same input would give other tiles

std::string parameters(const TilePlan& plan, int tile_row, int tile_column) {
  const TiledIndex& f = plan.frame;
  return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {}|", kNaming, tile_row, tile_column, f.columns, f.rows,
                     f.tile_size, f.max_error, f.cell_width, f.cell_height, f.georef.origin_x, f.georef.origin_y,
                     f.georef.scale_x, f.georef.scale_y, f.georef.crs_wkt);
}

}  // namespace

bool has_area(const Raster& raster) {
  bool first = false, second = false;
  std::int64_t c0 = 0, r0 = 0, dc = 0, dr = 0;
  for (int r = 0; r < raster.rows; ++r)
    for (int c = 0; c < raster.columns; ++c) {
      if (!raster.valid(c, r)) continue;
      if (!first) {
        first = true;
        c0 = c;
        r0 = r;
      } else if (!second) {
        second = true;
        dc = c - c0;
        dr = r - r0;
      } else if (dc * (r - r0) != dr * (c - c0)) {
        return true;
      }
    }
  return false;
}

TilePlan plan_tiles(const std::string& source, const TileOptions& options, const ReadOptions& read) {
  if (options.size < kLeastSize || options.size > kMostSize)
    throw UsageError(fmt::format("tiles have {} to {} cells a side, not {}", kLeastSize, kMostSize, options.size), {},
                     "--tiles");
  if (!std::isfinite(options.max_error) || options.max_error < 0)
    throw UsageError(fmt::format("max_error must be 0 or more, not {}", options.max_error), {}, "--max-error");
  if (!(options.ratio >= 0 && options.ratio <= 1))
    throw UsageError(fmt::format("ratio must be in (0, 1], not {}", options.ratio), {}, "--ratio");
  if ((options.max_error > 0) + (options.vertices > 0) + (options.ratio > 0) > 1)
    throw UsageError("tiles take one of max_error, vertices and ratio", {}, "--vertices");
  if (options.refine && (options.max_error > 0 || (options.vertices == 0 && options.ratio == 0)))
    throw UsageError("tiles are refined by their surface to a budget: give vertices or ratio, not max_error", {},
                     "--refine");
  if (options.refine && !options.fitted)
    throw UsageError("a surface that is refined by its own error is fitted: leave interpolate out", {}, "--fit");
  if (options.refine && options.surface == SurfaceKind::powell_sabin)
    throw UsageError(
        "tiles of a Powell-Sabin surface are not refined by it: its edges on a seam would depend on what both tiles "
        "choose beside it. Take clough-tocher",
        {}, "--surface");
  TilePlan plan{source, read, {}, options.ratio};
  const Raster place = inspect_raster(source, read);
  if (place.columns < 2 || place.rows < 2)
    throw BadInput(fmt::format("a grid of {} x {} cells has no area", place.columns, place.rows), source);
  plan.frame.columns = place.columns;
  plan.frame.rows = place.rows;
  plan.frame.cell_width = place.cell_width;
  plan.frame.cell_height = place.cell_height;
  plan.frame.georef = place.georef;
  plan.frame.tile_size = options.size;
  plan.frame.surface = options.surface;
  plan.frame.max_error = options.max_error;
  plan.frame.fitted = options.fitted;
  plan.frame.budget = options.vertices;
  if (options.refine) plan.frame.effort = effort_name(*options.refine);
  return plan;
}

Raster read_tile(const TilePlan& plan, int tile_row, int tile_column, const Context& context) {
  const CellWindow w = plan.frame.window(tile_row, tile_column);
  ReadOptions read = plan.read;
  read.window = w;
  Raster raster = read_raster(plan.source, read, nullptr, context);
  raster.georef.crs_wkt =
      plan.frame.georef.crs_wkt;  // the plan's words, whoever reads and however GDAL puts them there
  return raster;
}

std::string tin_name(const TilePlan& plan, int tile_row, int tile_column, const Context& context) {
  const Raster raster = read_tile(plan, tile_row, tile_column, context);
  if (!has_area(raster)) return {};
  std::string key = parameters(plan, tile_row, tile_column);
  std::visit(
      [&](const auto& heights) {
        key += fmt::format("{}|", sizeof heights[0]);
        key += content_digest({reinterpret_cast<const char*>(heights.data()), heights.size() * sizeof heights[0]});
      },
      raster.heights);
  return fmt::format("tin-{}-{}-{}.retalho", tile_row, tile_column, content_digest(key));
}

std::string tile_name(const TilePlan& plan, int tile_row, int tile_column, const NeighborNames& tins) {
  std::string key = parameters(plan, tile_row, tile_column) + surface_name(plan.frame.surface);
  if (plan.frame.fitted) key += " least-squares";
  if (!plan.frame.effort.empty()) key += " refined " + plan.frame.effort;
  for (const std::string& tin : tins) key += "|" + tin;
  return fmt::format("tile-{}-{}-{}.retalho", tile_row, tile_column, content_digest(key));
}

}  // namespace retalho
