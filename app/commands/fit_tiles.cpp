#include "fit_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "needs_in_space.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/tiles/make.h"
#include "table.h"

namespace retalho::app {
namespace {

TileOptions options_of(const TileFlags& flags, const BudgetFlags& budget, const SurfaceFlags& surface) {
  if ((budget.max_error ? 1 : 0) + (budget.vertices ? 1 : 0) + (budget.ratio.empty() ? 0 : 1) != 1)
    throw UsageError("--tiles takes one of --max-error E, --vertices N and --ratio R", {}, "--tiles");
  const bool refine = (!surface.refine.empty() || !surface.effort.empty()) && refines_surface(surface, budget, false);
  if (refine && budget.max_error)
    throw UsageError(
        "--tiles takes --refine surface with --vertices or --ratio: a seam's cells cannot be held to a "
        "--max-error by what is inside of a tile",
        {}, "--refine");
  const FitKind fit = resolve_fit(surface, false);
  if (fit == FitKind::z_only)
    throw UsageError(
        "--tiles takes --fit interpolate or least-squares: gradients that follow from fitted heights would "
        "depend on both sides of a seam",
        {}, "--tiles");
  const SurfaceOptions resolved = resolve(surface, false);
  if (resolved.gradients != GradientKind::normals || resolved.cross_derivative != CrossDerivative::perpendicular)
    throw UsageError("--tiles takes --gradients normals and --cross-derivative perpendicular", {}, "--tiles");
  TileOptions options;
  options.size = *flags.size;
  options.max_error = budget.max_error.value_or(0);
  if (budget.vertices && *budget.vertices == 0) throw UsageError("--vertices must be 1 or more", {}, "--vertices");
  options.vertices = budget.vertices.value_or(0);
  if (!budget.ratio.empty()) options.ratio = parse_ratio("--ratio", budget.ratio);
  options.surface = resolved.surface;
  options.fitted = refine || fit == FitKind::least_squares;
  if (refine) options.refine = resolve_effort(surface);
  return options;
}

}  // namespace

void add_tile_flags(CLI::App& command, TileFlags& flags) {
  command
      .add_option("--tiles", flags.size,
                  "Grids that do not fit into memory: a folder of tiles of N x N cells; run again, it goes on")
      ->type_name("N");
  command.add_option("--jobs", flags.jobs, "With --tiles: how many tiles at a time (default: --threads)")
      ->type_name("N");
}

void fit_tiles(const Program& program, const TileFlags& flags, const std::string& input, const std::string& output,
               const GridFlags& grid, const BudgetFlags& budget, const SurfaceFlags& surface) {
  namespace fs = std::filesystem;
  const Stopwatch watch;
  const TileOptions options = options_of(flags, budget, surface);
  if (fs::exists(output) && !fs::is_directory(output))
    throw CannotWrite(fmt::format("'{}' is a file: with --tiles the output is a folder", output), output);
  const Context context = program.context();
  const TilePlan plan = plan_tiles(input, options, {.band = grid.band, .nodata = grid.nodata});
  program.say(fmt::format("{}: {} x {} cells in {} x {} tiles", input, plan.frame.columns, plan.frame.rows,
                          plan.frame.tile_columns(), plan.frame.tile_rows()));
  const int side = std::min(options.size, std::max(plan.frame.columns, plan.frame.rows)) + 1;
  const int tiles = plan.frame.tile_columns() * plan.frame.tile_rows();
  check_tiles_need(side, std::min(tiles, flags.jobs > 0 ? flags.jobs : thread_count(context)), input);
  const TiledIndex index = make_tiles(plan, output, flags.jobs, program.overwrite, context);
  std::size_t vertices = 0, triangles = 0, bytes = 0, empty = 0;
  for (const TileEntry& tile : index.tiles) {
    vertices += tile.vertices;
    triangles += tile.triangles;
    bytes += tile.bytes;
    empty += tile.file.empty() ? 1 : 0;
  }
  const nlohmann::ordered_json json = {{"surface", surface_name(index.surface)},
                                       {"fit", index.fitted ? "least-squares" : "interpolate"},
                                       {"refine", index.effort.empty() ? "flat" : "surface"},
                                       {"max_error", index.max_error},
                                       {"budget", index.budget},
                                       {"tiles", index.tiles.size()},
                                       {"empty_tiles", empty},
                                       {"vertices_of_tiles", vertices},
                                       {"triangles", triangles},
                                       {"bytes", bytes},
                                       {"cells", static_cast<std::size_t>(index.columns) * index.rows},
                                       {"seconds", watch.seconds()}};
  if (program.json) return program.print(json);
  program.print(list_text({{"surface", surface_name(index.surface)},
                           {"tolerance", fmt::format("{:.6g}", index.max_error)},
                           {"tiles", fmt::format("{} ({} without data)", index.tiles.size(), empty)},
                           {"vertices", fmt::format("{} (those on seams counted in each tile)", vertices)},
                           {"triangles", fmt::format("{}", triangles)},
                           {"bytes", fmt::format("{}", bytes)},
                           {"seconds", fmt::format("{:.2f}", watch.seconds())}}));
}

}  // namespace retalho::app
