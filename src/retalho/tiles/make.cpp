#include "retalho/tiles/make.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>
#include <optional>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tiles/jobs.h"
#include "retalho/tiles/seam.h"
#include "retalho/tiles/strips.h"
#include "retalho/tin/refine.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

std::string path_in(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}

/// The terrain in a file that is there and whole; nothing else. A torn file (of another program, or a bad disk) is as
/// good as none.
std::optional<Terrain> find_whole(const std::string& path) {
  std::error_code ec;
  if (!fs::exists(path, ec)) return std::nullopt;
  try {
    Model model = load_model(path);
    if (auto* terrain = std::get_if<Terrain>(&model)) return std::move(*terrain);
  } catch (const CannotRead&) {
  }
  return std::nullopt;
}

Terrain load_tin(const std::string& folder, const std::string& name) {
  const std::string path = path_in(folder, name);
  std::optional<Terrain> terrain = find_whole(path);
  if (!terrain) throw CannotRead(fmt::format("the triangulation '{}' is missing or damaged: run it again", path), path);
  return std::move(*terrain);
}

std::size_t place_of(const TiledIndex& frame, int tile_row, int tile_column) {
  return static_cast<std::size_t>(tile_row) * static_cast<std::size_t>(frame.tile_columns()) +
         static_cast<std::size_t>(tile_column);
}
int row_of(const TiledIndex& frame, std::size_t place) {
  return static_cast<int>(place / static_cast<std::size_t>(frame.tile_columns()));
}
int column_of(const TiledIndex& frame, std::size_t place) {
  return static_cast<int>(place % static_cast<std::size_t>(frame.tile_columns()));
}

/// Puts the fitted data of the border in their places, and fits the rest of the tile to its cells.
Terrain fitted(const TilePlan& plan, int tile_row, int tile_column, Terrain terrain, const TilesAround& tiles,
               const Context& context) {
  const auto border = fit_seams(plan, tiles, context);
  std::vector<std::uint8_t> held(terrain.tin.vertex_count(), 0);
  for (std::uint32_t v = 0; v < held.size(); ++v) {
    const PlacedTin self{tiles[4].cells, &terrain.tin};
    const auto found = border.find(cell_of(plan.frame, self, v).key());
    if (found == border.end()) continue;
    held[v] = 1;
    terrain.tin.heights[v] = found->second.height;
    if (!terrain.gradients.empty()) terrain.gradients[v] = found->second.gradient;
  }
  LeastSquaresOptions options;
  options.held = held;
  return fit_least_squares(std::move(terrain), read_tile(plan, tile_row, tile_column, context), options, context);
}

/// The vertices inside chosen by the surface, as many as the flat triangulation has. The sides where there are other
/// tiles keep that one's vertices: what they are and what they store, the seam's own strip decides (tiles/strips.h).
Terrain refined(const TilePlan& plan, int tile_row, int tile_column, const Tin& flat, const TilesAround& tiles,
                const Context& context) {
  const auto border = fit_seams(plan, tiles, context);
  const Raster raster = read_tile(plan, tile_row, tile_column, context);
  const std::array<bool, 4> frozen{tile_row > 0, tile_column > 0, tile_row + 1 < plan.frame.tile_rows(),
                                   tile_column + 1 < plan.frame.tile_columns()};
  std::vector<SideVertex> sides;
  for (std::uint32_t v = 0; v < flat.vertex_count(); ++v) {
    const GridCell cell = cell_of(plan.frame, {tiles[4].cells, &flat}, v);
    SideVertex side;
    side.column = static_cast<int>(cell.column) - tiles[4].cells.column;
    side.row = static_cast<int>(cell.row) - tiles[4].cells.row;
    const std::array<bool, 4> on{side.row == 0, side.column == 0, side.row == raster.rows - 1,
                                 side.column == raster.columns - 1};
    bool kept = false;
    for (std::size_t k = 0; k < 4; ++k) kept = kept || (frozen[k] && on[k]);
    if (!kept) continue;
    sides.push_back(side);
    if (const auto found = border.find(cell.key()); found != border.end()) {
      sides.back().held = true;
      sides.back().height = found->second.height;
      sides.back().gradient = found->second.gradient;
    }
  }
  const SurfaceRefineOptions options =
      with_effort({.surface = plan.frame.surface, .vertices = flat.vertex_count()}, *parse_effort(plan.frame.effort));
  return refine_inside(raster, sides, frozen, options, context);
}

Terrain surface_of(const TilePlan& plan, int tile_row, int tile_column, const NeighborNames& tins,
                   const std::string& folder, const Context& context) {
  Terrain flat = load_tin(folder, tins[4]);
  if (plan.frame.surface == SurfaceKind::linear && !plan.frame.fitted) return flat;
  std::array<Terrain, 9> around;
  TilesAround tiles;
  for (std::size_t k = 0; k < 9; ++k) {
    if (tins[k].empty()) continue;
    tiles[k].cells =
        plan.frame.window(tile_row - 1 + static_cast<int>(k) / 3, tile_column - 1 + static_cast<int>(k) % 3);
    around[k] = k == 4 ? flat : load_tin(folder, tins[k]);
    tiles[k].tin = &around[k].tin;
  }
  std::vector<PlacedTin> neighbors;
  for (std::size_t k = 0; k < 9; ++k)
    if (k != 4 && tiles[k].tin != nullptr) neighbors.push_back(tiles[k]);
  if (!plan.frame.effort.empty()) return refined(plan, tile_row, tile_column, flat.tin, tiles, context);
  SurfaceOptions options;
  options.surface = plan.frame.surface;
  options.gradients = GradientKind::given;
  if (options.surface != SurfaceKind::linear) options.given = seam_gradients(plan.frame, tiles[4], neighbors, context);
  Terrain terrain = make_terrain(std::move(flat.tin), flat.georef, options, context);
  if (options.surface != SurfaceKind::linear) terrain.gradient_kind = GradientKind::normals;
  if (options.surface == SurfaceKind::powell_sabin)
    terrain.edge_split = seam_splits(plan.frame, tiles[4], neighbors, context);
  terrain.grid = std::move(flat.grid);
  terrain.tolerance = flat.tolerance;
  if (!plan.frame.fitted) return terrain;
  return fitted(plan, tile_row, tile_column, std::move(terrain), tiles, context);
}

/// Is this very index in the folder already?
bool holds(const std::string& folder, const TiledIndex& index) {
  return is_tiled_model(folder) && index_text(read_tiled_index(folder)) == index_text(index);
}

}  // namespace

void check_tiles_folder(const TilePlan& plan, const std::string& folder, bool overwrite) {
  if (overwrite || !is_tiled_model(folder)) return;
  TiledIndex there = read_tiled_index(folder), here = plan.frame;
  there.tiles.clear();
  if (plan.open()) {  // what is not known yet is taken as it is there
    if (plan.ratio > 0 && there.budget > 0) here.budget = there.budget;
    if (there.budget > 0) here.max_error = there.max_error;
  }
  if (index_text(there) == index_text(here)) return;
  throw CannotWrite(
      fmt::format("'{}' is a tiled model of another grid or with other parameters: give another folder, or "
                  "--overwrite to replace its index",
                  folder),
      folder);
}

void make_tin(const TilePlan& plan, int tile_row, int tile_column, const std::string& name, const std::string& folder,
              const Context& context) {
  const std::string path = path_in(folder, name);
  if (find_whole(path)) return;
  const Raster raster = read_tile(plan, tile_row, tile_column, context);
  SurfaceOptions options;
  options.surface = SurfaceKind::linear;
  Terrain flat =
      make_terrain(refine_tin(raster, {.max_error = plan.frame.max_error}, context), raster, options, context);
  flat.tolerance = plan.frame.max_error;
  save_model(flat, path, true);
}

TileEntry make_tile(const TilePlan& plan, int tile_row, int tile_column, const NeighborNames& tins,
                    const std::string& folder, const Context& context) {
  TileEntry entry;
  entry.row = tile_row;
  entry.column = tile_column;
  entry.cells = plan.frame.window(tile_row, tile_column);
  if (tins[4].empty()) return entry;
  entry.file = tile_name(plan, tile_row, tile_column, tins);
  const std::string path = path_in(folder, entry.file);
  std::optional<Terrain> surface = find_whole(path);
  if (!surface) {
    surface = surface_of(plan, tile_row, tile_column, tins, folder, context);
    save_model(*surface, path, true);
  }
  const std::string bytes = read_file(path);
  entry.bytes = bytes.size();
  entry.checksum = content_digest(bytes);
  entry.vertices = surface->tin.vertex_count();
  entry.triangles = surface->tin.triangle_count();
  return entry;
}

NeighborNames names_around(const TiledIndex& frame, const std::vector<std::string>& tins, int tile_row,
                           int tile_column) {
  NeighborNames names;
  for (int k = 0; k < 9; ++k) {
    const int r = tile_row - 1 + k / 3, c = tile_column - 1 + k % 3;
    if (r >= 0 && c >= 0 && r < frame.tile_rows() && c < frame.tile_columns())
      names[static_cast<std::size_t>(k)] = tins.at(place_of(frame, r, c));
  }
  return names;
}

std::vector<std::size_t> missing_tiles(const TilePlan& plan, const std::vector<std::string>& tins,
                                       const std::string& folder) {
  std::vector<std::size_t> missing;
  for (std::size_t k = 0; k < tins.size(); ++k) {
    const int r = row_of(plan.frame, k), c = column_of(plan.frame, k);
    if (!tins[k].empty() && !find_whole(path_in(folder, tile_name(plan, r, c, names_around(plan.frame, tins, r, c)))))
      missing.push_back(k);
  }
  return missing;
}

std::vector<std::size_t> missing_tins(const TilePlan& plan, const std::vector<std::string>& tins,
                                      const std::vector<std::size_t>& tiles, const std::string& folder) {
  std::vector<bool> needed(tins.size());
  for (const std::size_t k : tiles)
    for (int r = row_of(plan.frame, k) - 1; r <= row_of(plan.frame, k) + 1; ++r)
      for (int c = column_of(plan.frame, k) - 1; c <= column_of(plan.frame, k) + 1; ++c)
        if (r >= 0 && c >= 0 && r < plan.frame.tile_rows() && c < plan.frame.tile_columns())
          needed[place_of(plan.frame, r, c)] = true;
  std::vector<std::size_t> missing;
  for (std::size_t k = 0; k < tins.size(); ++k)
    if (needed[k] && !tins[k].empty() && !find_whole(path_in(folder, tins[k]))) missing.push_back(k);
  return missing;
}

TiledIndex finish_tiles(const TilePlan& plan, std::vector<TileEntry> entries, const std::vector<std::string>& tins,
                        const std::string& folder, bool overwrite) {
  TiledIndex index = plan.frame;
  index.tiles = std::move(entries);
  std::sort(index.tiles.begin(), index.tiles.end(), [](const TileEntry& a, const TileEntry& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });
  if (index.tiles.size() != index.tile_count())
    throw UsageError(fmt::format("{} tiles are made, where the grid has {}", index.tiles.size(), index.tile_count()));
  if (!holds(folder, index)) write_tiled_index(index, folder, overwrite);
  std::error_code ec;
  for (const std::string& tin : tins)
    if (!tin.empty()) fs::remove(path_in(folder, tin), ec);
  return index;
}

TilePlan settle_here(const TilePlan& plan, int jobs, const Context& context) {
  if (!plan.open()) return plan;
  const TiledIndex& frame = plan.frame;
  std::vector<TileLook> looks(frame.tile_count());
  run_jobs(looks.size(), jobs, "look", context, [&](std::size_t k, const Context& inner) {
    looks[k] = look_at_tile(plan, row_of(frame, k), column_of(frame, k), inner);
  });
  return settle(plan, looks, [&](double max_error) {
    std::vector<std::size_t> counts(looks.size());
    run_jobs(counts.size(), jobs, "budget", context, [&](std::size_t k, const Context& inner) {
      const int r = row_of(frame, k), c = column_of(frame, k);
      counts[k] = count_vertices(plan, r, c, max_error, areas_around(frame, looks, r, c), inner);
    });
    return std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  });
}

TiledIndex make_tiles(const TilePlan& asked, const std::string& folder, int jobs, bool overwrite,
                      const Context& context) {
  check_tiles_folder(asked, folder, overwrite);
  const TilePlan plan = settle_here(asked, jobs, context);
  check_tiles_folder(plan, folder, overwrite);
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec) throw CannotWrite(fmt::format("cannot make the folder '{}': {}", folder, ec.message()), folder);
  const TiledIndex& frame = plan.frame;
  std::vector<std::string> tins(frame.tile_count());
  run_jobs(tins.size(), jobs, "look", context, [&](std::size_t k, const Context& inner) {
    tins[k] = tin_name(plan, row_of(frame, k), column_of(frame, k), inner);
  });
  const std::vector<std::size_t> tiles = missing_tiles(plan, tins, folder);
  const std::vector<std::size_t> flat = missing_tins(plan, tins, tiles, folder);
  run_jobs(flat.size(), jobs, "triangulation", context, [&](std::size_t k, const Context& inner) {
    make_tin(plan, row_of(frame, flat[k]), column_of(frame, flat[k]), tins[flat[k]], folder, inner);
  });
  std::vector<TileEntry> entries(tins.size());
  run_jobs(tins.size(), jobs, "surface", context, [&](std::size_t k, const Context& inner) {
    const int r = row_of(frame, k), c = column_of(frame, k);
    entries[k] = make_tile(plan, r, c, names_around(frame, tins, r, c), folder, inner);
  });
  context.check();
  return finish_tiles(plan, std::move(entries), tins, folder, overwrite);
}

}  // namespace retalho
