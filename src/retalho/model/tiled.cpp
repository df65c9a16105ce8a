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
    whole_.tolerance = index.max_error;
  }

  void add(const Terrain& tile, const TileEntry& entry, const std::string& file) {
    whole_.gradient_kind = tile.gradient_kind;
    const bool smooth = !tile.gradients.empty();
    const CellWindow& w = entry.cells;
    std::vector<std::uint32_t> number(tile.tin.vertex_count());
    for (std::size_t v = 0; v < number.size(); ++v) {
      const auto column = w.column + std::llround(tile.tin.points[v].x / index_.cell_width);
      const auto row = w.row + std::llround(-tile.tin.points[v].y / index_.cell_height);
      const Vec2 gradient = smooth ? tile.gradients[v] : Vec2{};
      const bool seam =
          column == w.column || column == w.column + w.columns - 1 || row == w.row || row == w.row + w.rows - 1;
      number[v] = vertex(row, column, seam, tile.tin.heights[v], gradient, smooth, file);
    }
    for (const auto& t : tile.tin.triangles) whole_.tin.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    if (!tile.edge_split.empty()) add_splits(tile, number, file);
    for (int r = 0; r < w.rows; ++r)
      for (int c = 0; c < w.columns; ++c)
        if (tile.grid.valid.empty() || tile.grid.valid.get(c, r)) whole_.grid.valid.set(w.column + c, w.row + r, true);
  }

  Terrain take() {
    if (whole_.grid.valid.count() == static_cast<std::size_t>(index_.columns) * static_cast<std::size_t>(index_.rows))
      whole_.grid.valid = {};
    build_neighbors(whole_.tin);
    if (whole_.kind == SurfaceKind::powell_sabin)
      for (const auto& [a, b] : build_edges(whole_.tin).vertices)
        whole_.edge_split.push_back(splits_.at(edge_key(a, b)));
    return std::move(whole_);
  }

 private:
  static std::uint64_t edge_key(std::uint32_t low, std::uint32_t high) {
    return (static_cast<std::uint64_t>(low) << 32) | high;
  }

  /// Splits are counted from the end with the lower number, and the numbers are others here.
  void add_splits(const Terrain& tile, const std::vector<std::uint32_t>& number, const std::string& file) {
    const EdgeTable edges = build_edges(tile.tin);
    for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
      const std::uint32_t a = number[edges.vertices[e][0]], b = number[edges.vertices[e][1]];
      const double split = a < b ? tile.edge_split[e] : 1 - tile.edge_split[e];
      const auto [found, made] = splits_.emplace(edge_key(std::min(a, b), std::max(a, b)), split);
      if (!made && !same_bits(found->second, split))
        throw CannotRead(fmt::format("'{}' and its neighbour split an edge of their seam in two ways: make the tiled "
                                     "model again (retalho fit --tiles)",
                                     file),
                         file);
    }
  }

  std::uint32_t vertex(long long row, long long column, bool seam, double height, Vec2 gradient, bool smooth,
                       const std::string& file) {
    const auto next = static_cast<std::uint32_t>(whole_.tin.points.size());
    if (seam) {
      const std::uint64_t key = (static_cast<std::uint64_t>(row) << 32) | static_cast<std::uint64_t>(column);
      const auto [found, made] = on_seams_.emplace(key, next);
      if (!made) {
        const std::uint32_t known = found->second;
        if (!same_bits(whole_.tin.heights[known], height) || (smooth && !(whole_.gradients[known] == gradient)))
          throw CannotRead(fmt::format("'{}' and its neighbour differ at their common cell ({}, {}): make the tiled "
                                       "model again (retalho fit --tiles)",
                                       file, column, row),
                           file, fmt::format("cell {}, {}", column, row));
        return known;
      }
    }
    whole_.tin.points.push_back(
        {static_cast<double>(column) * index_.cell_width, -static_cast<double>(row) * index_.cell_height});
    whole_.tin.heights.push_back(height);
    if (smooth) whole_.gradients.push_back(gradient);
    return next;
  }

  const TiledIndex& index_;
  Terrain whole_;
  std::unordered_map<std::uint64_t, std::uint32_t> on_seams_;
  std::unordered_map<std::uint64_t, double> splits_;  // Powell-Sabin: of edges, from the lower number
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

Terrain load_tiled_model(const std::string& folder) {
  const TiledIndex index = read_tiled_index(folder);
  Joiner joiner(index);
  bool any = false;
  for (const TileEntry& entry : index.tiles) {
    if (entry.file.empty()) continue;
    any = true;
    joiner.add(load_tile(index, entry, folder), entry, path_in(folder, entry.file));
  }
  if (!any) throw CannotRead(fmt::format("no tile of '{}' holds any data", folder), folder);
  return joiner.take();
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
