// Tiled models: reading the tiles of a folder and joining them.
#include "retalho/model/tiled.h"

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <unordered_map>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/model/model.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;

std::string path_in(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / name).string();
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// Tiles put together: vertices on seams become one.
class Joiner {
 public:
  explicit Joiner(const TiledIndex& index) : index_(index) {
    whole_.kind = index.surface;
    whole_.georef = index.georef;
    whole_.grid.columns = index.columns;
    whole_.grid.rows = index.rows;
    whole_.grid.cell_width = index.cell_width;
    whole_.grid.cell_height = index.cell_height;
    whole_.grid.valid = Mask(index.columns, index.rows, false);
    whole_.tolerance = index.effort.empty() ? index.max_error : 0;  // which the flat triangulation alone kept
  }

  void add(const PlacedTile& placed, const std::string& file) {
    const Terrain& tile = placed.terrain;
    whole_.gradient_kind = tile.gradient_kind;
    const bool smooth = !tile.gradients.empty();
    std::vector<std::uint32_t> number(tile.tin.vertex_count());
    for (std::size_t v = 0; v < number.size(); ++v) number[v] = vertex(placed, v, smooth, file);
    for (const auto& t : tile.tin.triangles) whole_.tin.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    if (!tile.edge_split.empty()) add_splits(tile, number, file);
    const GridDomain& g = tile.grid;
    for (int r = 0; r < g.rows; ++r)
      for (int c = 0; c < g.columns; ++c)
        if (g.valid.empty() || g.valid.get(c, r))
          whole_.grid.valid.set(placed.first_column + c, placed.first_row + r, true);
  }

  Terrain take() {
    if (whole_.grid.valid.count() == static_cast<std::size_t>(index_.columns) * static_cast<std::size_t>(index_.rows))
      whole_.grid.valid = {};
    const std::vector<std::uint32_t> former = sort_vertices();
    build_neighbors(whole_.tin);
    if (whole_.kind == SurfaceKind::powell_sabin)
      for (const auto& [a, b] : build_edges(whole_.tin).vertices)
        whole_.edge_split.push_back(splits_.at(edge_key(former[a], former[b])));
    return std::move(whole_);
  }

 private:
  static std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) {
    return (static_cast<std::uint64_t>(std::min(a, b)) << 32) | std::max(a, b);
  }

  /// Brings the vertices into the order of their rows and columns; edges then run as they do in the tiles. Returns what
  /// number each had.
  std::vector<std::uint32_t> sort_vertices() {
    Tin& tin = whole_.tin;
    std::vector<std::uint32_t> former(tin.vertex_count()), number(former.size());
    std::iota(former.begin(), former.end(), 0U);
    std::sort(former.begin(), former.end(), [&](std::uint32_t a, std::uint32_t b) {
      const Vec2 p = tin.points[a], q = tin.points[b];
      return p.y != q.y ? p.y > q.y : p.x < q.x;
    });
    for (std::uint32_t v = 0; v < former.size(); ++v) number[former[v]] = v;
    const auto sorted = [&](const auto& values) {
      auto out = values;
      for (std::size_t v = 0; v < values.size(); ++v) out[v] = values[former[v]];
      return out;
    };
    tin.points = sorted(tin.points);
    tin.heights = sorted(tin.heights);
    whole_.gradients = sorted(whole_.gradients);
    for (auto& triangle : tin.triangles)
      for (std::uint32_t& v : triangle) v = number[v];
    return former;
  }

  /// Of edges, counted from the end whose cell comes first.
  void add_splits(const Terrain& tile, const std::vector<std::uint32_t>& number, const std::string& file) {
    const EdgeTable edges = build_edges(tile.tin);
    for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
      const std::uint64_t key = edge_key(number[edges.vertices[e][0]], number[edges.vertices[e][1]]);
      const auto [found, made] = splits_.emplace(key, tile.edge_split[e]);
      if (!made && !same_bits(found->second, tile.edge_split[e]))
        throw CannotRead(fmt::format("'{}' and its neighbour split an edge of their seam in two ways: make the tiled "
                                     "model again (retalho fit --tiles)",
                                     file),
                         file);
    }
  }

  std::uint32_t vertex(const PlacedTile& placed, std::size_t v, bool smooth, const std::string& file) {
    const Terrain& tile = placed.terrain;
    const GridDomain& g = tile.grid;
    const Vec2 point = tile.tin.points[v], gradient = smooth ? tile.gradients[v] : Vec2{};
    const auto column = std::llround(point.x / g.cell_width), row = std::llround(-point.y / g.cell_height);
    const auto c = column - placed.first_column, r = row - placed.first_row;
    const bool seam = c == 0 || c == g.columns - 1 || r == 0 || r == g.rows - 1;
    const auto next = static_cast<std::uint32_t>(whole_.tin.points.size());
    if (seam) {
      const std::uint64_t key = (static_cast<std::uint64_t>(row) << 32) | static_cast<std::uint64_t>(column);
      const auto [found, made] = on_seams_.emplace(key, next);
      if (!made) {
        const std::uint32_t known = found->second;
        if (!same_bits(whole_.tin.heights[known], tile.tin.heights[v]) ||
            (smooth && !(whole_.gradients[known] == gradient)))
          throw CannotRead(fmt::format("'{}' and its neighbour differ at their common cell ({}, {}): make the tiled "
                                       "model again (retalho fit --tiles)",
                                       file, column, row),
                           file, fmt::format("cell {}, {}", column, row));
        return known;
      }
    }
    whole_.tin.points.push_back(point);
    whole_.tin.heights.push_back(tile.tin.heights[v]);
    if (smooth) whole_.gradients.push_back(gradient);
    return next;
  }

  const TiledIndex& index_;
  Terrain whole_;
  std::unordered_map<std::uint64_t, std::uint32_t> on_seams_;
  std::unordered_map<std::uint64_t, double> splits_;  // Powell-Sabin
};

}  // namespace

CellWindow TiledIndex::window(int tile_row, int tile_column) const {
  CellWindow w{tile_column * tile_size, tile_row * tile_size, 0, 0};
  w.columns = std::min(tile_size, columns - 1 - w.column) + 1;
  w.rows = std::min(tile_size, rows - 1 - w.row) + 1;
  return w;
}

std::string content_digest(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", static_cast<std::uint64_t>(hash.high64), static_cast<std::uint64_t>(hash.low64));
}

bool is_tiled_model(const std::string& path) {
  std::error_code ec;
  return fs::is_directory(path, ec) && fs::exists(fs::path(path) / kTiledIndexName, ec);
}

void write_tiled_index(const TiledIndex& index, const std::string& folder, bool overwrite) {
  write_file(path_in(folder, kTiledIndexName), index_text(index), overwrite);
}

TiledIndex read_tiled_index(const std::string& folder) {
  std::error_code ec;
  const std::string path = path_in(folder, kTiledIndexName);
  if (!fs::exists(path, ec))
    throw CannotRead(fmt::format("the folder '{}' is no tiled model: it has no {} (retalho fit --tiles makes one; "
                                 "one that was interrupted is continued by the same command)",
                                 folder, kTiledIndexName),
                     folder);
  return parse_index(read_file(path), path);
}

Terrain load_tile(const TiledIndex& index, const TileEntry& entry, const std::string& folder) {
  const std::string path = path_in(folder, entry.file);
  const std::string bytes = read_file(path);
  if (content_digest(bytes) != entry.checksum)
    throw CannotRead(
        fmt::format("'{}' is not the tile that {} speaks of: its checksum is another one", path, kTiledIndexName),
        path);
  Model model = decode_model(bytes, path);
  auto* terrain = std::get_if<Terrain>(&model);
  if (terrain == nullptr || terrain->kind != index.surface || terrain->grid.columns != entry.cells.columns ||
      terrain->grid.rows != entry.cells.rows)
    throw CannotRead(fmt::format("'{}' holds another surface than {} says", path, kTiledIndexName), path);
  return std::move(*terrain);
}

PlacedTile load_placed_tile(const TiledIndex& index, const TileEntry& entry, const std::string& folder) {
  Terrain tile = load_tile(index, entry, folder);
  for (Vec2& p : tile.tin.points) {
    const auto column = entry.cells.column + std::llround(p.x / index.cell_width);
    const auto row = entry.cells.row + std::llround(-p.y / index.cell_height);
    p = {static_cast<double>(column) * index.cell_width, -static_cast<double>(row) * index.cell_height};
  }
  tile.georef = index.georef;
  tile.grid.cell_width = index.cell_width;
  tile.grid.cell_height = index.cell_height;
  return {std::move(tile), entry.cells.column, entry.cells.row};
}

namespace {

Terrain join_tiles(const TiledIndex& index, const std::string& folder) {
  Joiner joiner(index);
  bool any = false;
  for (const TileEntry& entry : index.tiles) {
    if (entry.file.empty()) continue;
    any = true;
    joiner.add(load_placed_tile(index, entry, folder), path_in(folder, entry.file));
  }
  if (!any) throw CannotRead(fmt::format("no tile of '{}' holds any data", folder), folder);
  return joiner.take();
}

/// The cells of all tiles of the index.
CellWindow cells_of(const TiledIndex& index) {
  CellWindow all{index.columns, index.rows, 0, 0};
  int right = 0, bottom = 0;
  for (const TileEntry& entry : index.tiles) {
    const CellWindow& w = entry.cells;
    all.column = std::min(all.column, w.column);
    all.row = std::min(all.row, w.row);
    right = std::max(right, w.column + w.columns);
    bottom = std::max(bottom, w.row + w.rows);
  }
  all.columns = right - all.column;
  all.rows = bottom - all.row;
  return all;
}

}  // namespace

Terrain load_tiled_model(const std::string& folder) {
  return join_tiles(read_tiled_index(folder), folder);
}

Terrain load_tiled_part(const std::string& folder, const std::function<bool(const TileEntry&)>& wanted) {
  TiledIndex part = read_tiled_index(folder);
  std::erase_if(part.tiles, [&](const TileEntry& entry) { return !wanted(entry); });
  if (part.tiles.empty()) throw BadInput(fmt::format("no tile of '{}' lies where it was asked for", folder), folder);
  const CellWindow cells = cells_of(part);
  const Vec2 corner = part.georef.to_crs({cells.column * part.cell_width, -cells.row * part.cell_height});
  part.columns = cells.columns;
  part.rows = cells.rows;
  part.georef.origin_x = corner.x;
  part.georef.origin_y = corner.y;
  for (TileEntry& entry : part.tiles) {
    entry.cells.column -= cells.column;
    entry.cells.row -= cells.row;
  }
  return join_tiles(part, folder);
}

std::size_t model_size(const std::string& path) {
  if (is_tiled_model(path)) {
    std::size_t sum = 0;
    for (const TileEntry& entry : read_tiled_index(path).tiles) sum += entry.bytes;
    return sum;
  }
  std::error_code ec;
  const auto size = fs::file_size(path, ec);
  if (ec) throw CannotRead(fmt::format("cannot read '{}': {}", path, ec.message()), path);
  return static_cast<std::size_t>(size);
}

}  // namespace retalho
