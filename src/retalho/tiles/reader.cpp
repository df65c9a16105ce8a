#include "retalho/tiles/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/raster/part.h"

namespace retalho {
namespace {

/// Of an evaluator: the ordinates of three cubic pieces and the location grid, measured as 250 to 330 bytes a triangle.
constexpr std::size_t kEvaluatorBytes = 350;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The tile that a coordinate counted in cells from the first one belongs to; of a seam: the eastern or southern one.
int tile_of(double cells, int size, int tiles) {
  return static_cast<int>(std::clamp(std::floor(cells / size), 0.0, tiles - 1.0));
}

bool on_seam(double cells, int size) {
  return cells > 0 && cells == size * std::floor(cells / size);
}

}  // namespace

OpenTile::OpenTile(Terrain terrain, Vec2 origin)
    : terrain_(std::move(terrain)), evaluator_(terrain_, Context{.threads = 1}), origin_(origin) {}

std::size_t OpenTile::bytes() const {
  const Tin& tin = terrain_.tin;
  const std::size_t a_vertex = sizeof(Vec2) + sizeof(double) + sizeof(Vec2);
  return tin.vertex_count() * a_vertex + tin.triangle_count() * (24 + kEvaluatorBytes) +
         terrain_.edge_split.size() * sizeof(double) + terrain_.grid.valid.words().size() * 8;
}

TileReader::TileReader(std::string folder, std::size_t bound)
    : folder_(std::move(folder)), bound_(bound), index_(read_tiled_index(folder_)) {}

std::shared_ptr<const OpenTile> TileReader::tile(int tile_row, int tile_column) {
  const auto place = static_cast<std::size_t>(tile_row) * static_cast<std::size_t>(index_.tile_columns()) +
                     static_cast<std::size_t>(tile_column);
  const TileEntry& entry = index_.tiles.at(place);
  if (entry.file.empty()) return nullptr;
  const std::lock_guard lock(mutex_);
  if (const auto found = kept_.find(place); found != kept_.end()) {
    used_.splice(used_.begin(), used_, found->second.used);
    return found->second.tile;
  }
  const Vec2 origin{entry.cells.column * index_.cell_width, -entry.cells.row * index_.cell_height};
  auto tile = std::make_shared<const OpenTile>(load_tile(index_, entry, folder_), origin);
  ++reads_;
  bytes_ += tile->bytes();
  used_.push_front(place);
  kept_.emplace(place, Kept{tile, used_.begin()});
  while (bytes_ > bound_ && used_.size() > 1) {
    const auto oldest = kept_.find(used_.back());
    bytes_ -= oldest->second.tile->bytes();
    kept_.erase(oldest);
    used_.pop_back();
  }
  most_ = std::max(most_, bytes_);
  return tile;
}

std::optional<Jet> TileReader::jet_in(int tile_row, int tile_column, Vec2 p) {
  const auto open = tile(tile_row, tile_column);
  return open ? open->evaluator().jet(p - open->origin()) : std::nullopt;
}

std::optional<Jet> TileReader::jet(Vec2 p) {
  const double column = p.x / index_.cell_width, row = -p.y / index_.cell_height;
  if (!std::isfinite(column) || !std::isfinite(row)) return std::nullopt;
  const int c = tile_of(column, index_.tile_size, index_.tile_columns()),
            r = tile_of(row, index_.tile_size, index_.tile_rows());
  // On a seam, and where rounding put a point beyond one, the neighbour may know more.
  const bool west = c > 0 && column<(c + 1e-6) * index_.tile_size, north = r> 0 && row < (r + 1e-6) * index_.tile_size;
  const bool east = c + 1 < index_.tile_columns() && column > (c + 1 - 1e-6) * index_.tile_size,
             south = r + 1 < index_.tile_rows() && row > (r + 1 - 1e-6) * index_.tile_size;
  std::optional<Jet> jet = jet_in(r, c, p);
  for (const int dr : {0, -1, 1})
    for (const int dc : {0, -1, 1}) {
      if (jet || (dr == 0 && dc == 0) || (dr < 0 && !north) || (dr > 0 && !south) || (dc < 0 && !west) ||
          (dc > 0 && !east))
        continue;
      jet = jet_in(r + dr, c + dc, p);
    }
  return jet;
}

std::vector<std::optional<Jet>> TileReader::jets(std::span<const Vec2> points) {
  struct Asked {
    std::int64_t tile;
    std::size_t point;
  };
  std::vector<Asked> order(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double column = points[k].x / index_.cell_width, row = -points[k].y / index_.cell_height;
    const bool place = std::isfinite(column) && std::isfinite(row);
    order[k] = {place ? std::int64_t{index_.tile_columns()} * tile_of(row, index_.tile_size, index_.tile_rows()) +
                            tile_of(column, index_.tile_size, index_.tile_columns())
                      : -1,
                k};
  }
  std::sort(order.begin(), order.end(),
            [](const Asked& a, const Asked& b) { return a.tile != b.tile ? a.tile < b.tile : a.point < b.point; });
  std::vector<std::optional<Jet>> jets(points.size());
  for (const Asked& one : order) jets[one.point] = jet(points[one.point]);
  return jets;
}

std::size_t TileReader::reads() const {
  const std::lock_guard lock(mutex_);
  return reads_;
}

std::size_t TileReader::most_kept() const {
  const std::lock_guard lock(mutex_);
  return most_;
}

namespace {

/// The part of the wanted cells that a tile answers for.
struct Block {
  int column = 0, columns = 0, row = 0, rows = 0;
};

/// Cells whose place, counted in the whole's cells, is in [from, to) along one axis; first and last tile: without end.
std::pair<int, int> range_of(double start, double step, int count, double from, double to) {
  const auto first_at = [&](double edge) {
    if (std::isinf(edge)) return edge < 0 ? 0 : count;
    auto k = static_cast<int>(std::clamp(std::ceil((edge - start) / step), 0.0, static_cast<double>(count)));
    while (k > 0 && start + (k - 1) * step >= edge) --k;
    while (k < count && start + k * step < edge) ++k;
    return k;
  };
  return {first_at(from), first_at(to)};
}

void fill_block(const OpenTile& tile, const SampledRows& rows, const Block& b, std::span<double> heights,
                std::span<Vec2> gradients, const Context& context) {
  const auto count = static_cast<std::size_t>(b.columns) * static_cast<std::size_t>(b.rows);
  std::vector<double> z(count);
  std::vector<Vec2> g(gradients.empty() ? 0 : count);
  const Vec2 first{rows.origin.x + b.column * rows.step.x, rows.origin.y - (rows.first + b.row) * rows.step.y};
  tile.evaluator().grid_values(first - tile.origin(), rows.step, b.columns, b.rows, z, g, context);
  for (int r = 0; r < b.rows; ++r)
    for (int c = 0; c < b.columns; ++c) {
      const std::size_t from =
          static_cast<std::size_t>(r) * static_cast<std::size_t>(b.columns) + static_cast<std::size_t>(c);
      const std::size_t to = static_cast<std::size_t>(b.row + r) * static_cast<std::size_t>(rows.columns) +
                             static_cast<std::size_t>(b.column + c);
      heights[to] = z[from];
      if (!g.empty()) gradients[to] = g[from];
    }
}

}  // namespace

void sample_rows(TileReader& reader, const SampledRows& rows, std::span<double> heights, std::span<Vec2> gradients,
                 const Context& context) {
  const TiledIndex& index = reader.index();
  std::fill(heights.begin(), heights.end(), kNan);
  const Vec2 cell{index.cell_width, index.cell_height};
  const double x = rows.origin.x / cell.x, y = -rows.origin.y / cell.y + rows.first * rows.step.y / cell.y;
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  for (int r = 0; r < index.tile_rows(); ++r) {
    const auto [top, bottom] =
        range_of(y, rows.step.y / cell.y, rows.rows, r == 0 ? -kEnd : static_cast<double>(r) * index.tile_size,
                 r + 1 == index.tile_rows() ? kEnd : (r + 1.0) * index.tile_size);
    if (top >= bottom) continue;
    for (int c = 0; c < index.tile_columns(); ++c) {
      const auto [left, right] =
          range_of(x, rows.step.x / cell.x, rows.columns, c == 0 ? -kEnd : static_cast<double>(c) * index.tile_size,
                   c + 1 == index.tile_columns() ? kEnd : (c + 1.0) * index.tile_size);
      if (left >= right) continue;
      context.check();
      if (const auto tile = reader.tile(r, c))
        fill_block(*tile, rows, {left, right - left, top, bottom - top}, heights, gradients, context);
    }
  }
  // On a seam, the tile that answers may have no data where its neighbour has: asked point by point.
  for (int r = 0; r < rows.rows; ++r) {
    const double row = y + r * rows.step.y / cell.y;
    const bool row_seam = on_seam(std::nearbyint(row * 1e6) / 1e6, index.tile_size);
    for (int c = 0; c < rows.columns; ++c) {
      const std::size_t k =
          static_cast<std::size_t>(r) * static_cast<std::size_t>(rows.columns) + static_cast<std::size_t>(c);
      if (!std::isnan(heights[k])) continue;
      const double column = x + c * rows.step.x / cell.x;
      if (!row_seam && !on_seam(std::nearbyint(column * 1e6) / 1e6, index.tile_size)) continue;
      const auto jet = reader.jet({rows.origin.x + c * rows.step.x, rows.origin.y - (rows.first + r) * rows.step.y});
      if (!jet) continue;
      heights[k] = jet->value;
      if (!gradients.empty()) gradients[k] = jet->gradient;
    }
  }
}

Raster raster_of_window(TileReader& reader, const CellWindow& window, const Context& context) {
  const TiledIndex& index = reader.index();
  if (window.column < 0 || window.row < 0 || window.columns < 1 || window.rows < 1 ||
      window.columns > index.columns - window.column || window.rows > index.rows - window.row)
    throw BadInput(fmt::format("the window of {} x {} cells from ({}, {}) on is not within the model's grid of {} x {}",
                               window.columns, window.rows, window.column, window.row, index.columns, index.rows));
  Raster raster;
  raster.columns = window.columns;
  raster.rows = window.rows;
  raster.cell_width = index.cell_width;
  raster.cell_height = index.cell_height;
  const Vec2 origin{window.column * index.cell_width, -window.row * index.cell_height};
  const Vec2 corner = index.georef.to_crs(origin);
  raster.georef = index.georef;
  raster.georef.origin_x = corner.x;
  raster.georef.origin_y = corner.y;
  std::vector<double> heights(raster.cells());
  // Rows of one row of tiles at a time, so that each tile is read once whatever the bound.
  for (int first = 0; first < window.rows;) {
    const int row = window.row + first;
    const int some = std::min(window.rows - first, index.tile_size - row % index.tile_size);
    const auto at = static_cast<std::size_t>(first) * static_cast<std::size_t>(window.columns),
               size = static_cast<std::size_t>(some) * static_cast<std::size_t>(window.columns);
    sample_rows(reader, {origin, {index.cell_width, index.cell_height}, window.columns, first, some},
                std::span(heights).subspan(at, size), {}, context);
    first += some;
    context.report("sample", static_cast<double>(first) / static_cast<double>(window.rows));
  }
  raster.heights = std::move(heights);
  return raster;
}

CellHeights cells_of(TileReader& reader) {
  const TiledIndex& index = reader.index();
  return {index.columns,
          index.rows,
          index.cell_width,
          index.cell_height,
          index.georef,
          [&reader, cell = Vec2{index.cell_width, index.cell_height}](int column, int row) {
            const auto jet = reader.jet({column * cell.x, -row * cell.y});
            return jet ? jet->value : kNan;
          }};
}

namespace {

/// Which cells of a tile count in it: those of a seam in the first tile, row by row, that has data and holds them;
/// where none has data, in the first.
Mask own_cells(const TiledIndex& index, const TileEntry& entry) {
  const CellWindow& w = entry.cells;
  const auto has_data = [&](int r, int c) {
    return !index
                .tiles[static_cast<std::size_t>(r) * static_cast<std::size_t>(index.tile_columns()) +
                       static_cast<std::size_t>(c)]
                .file.empty();
  };
  const bool here = has_data(entry.row, entry.column);
  const auto counts = [&](int column, int row) {
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc) {
        const int r = entry.row + dr, c = entry.column + dc;
        if ((dr == 0 && dc == 0) || r < 0 || c < 0 || r >= index.tile_rows() || c >= index.tile_columns()) continue;
        if ((dr < 0 && row > 0) || (dr > 0 && row < w.rows - 1) || (dc < 0 && column > 0) ||
            (dc > 0 && column < w.columns - 1))
          continue;
        const bool before = dr < 0 || (dr == 0 && dc < 0), data = has_data(r, c);
        if (here ? before && data : before || data) return false;
      }
    return true;
  };
  Mask own(w.columns, w.rows, true);
  for (int row = 0; row < w.rows; ++row)
    for (int column = 0; column < w.columns; ++column) {
      const bool border = row == 0 || column == 0 || row == w.rows - 1 || column == w.columns - 1;
      if (border && !counts(column, row)) own.set(column, row, false);
    }
  return own;
}

}  // namespace

bool same_grid(const TiledIndex& index, const Raster& place) {
  return index.columns == place.columns && index.rows == place.rows && index.georef.origin_x == place.georef.origin_x &&
         index.georef.origin_y == place.georef.origin_y && index.cell_width == place.cell_width &&
         index.cell_height == place.cell_height;
}

ErrorReport assess_tiles(TileReader& reader, const std::function<Raster(const CellWindow&)>& read, double tolerance,
                         TiledFacts* facts, const Context& context) {
  const TiledIndex& index = reader.index();
  ErrorSums sums;
  sums.columns = index.columns;
  std::size_t done = 0;
  for (const TileEntry& entry : index.tiles) {
    context.check();
    const CellWindow& w = entry.cells;
    CellWindow wide;
    wide.column = std::max(0, w.column - 1);
    wide.row = std::max(0, w.row - 1);
    wide.columns = std::min(index.columns, w.column + w.columns + 1) - wide.column;
    wide.rows = std::min(index.rows, w.row + w.rows + 1) - wide.row;
    const Raster around = read(wide);
    if (around.columns != wide.columns || around.rows != wide.rows)
      throw BadInput("the grid is not the one that the tiled model was made from: its size is another one");
    Raster raster = part_of(around, {w.column - wide.column, w.row - wide.row, w.columns, w.rows});
    const auto tile = reader.tile(entry.row, entry.column);
    if (tile) raster.georef = tile->terrain().georef;
    const Mask own = own_cells(index, entry);
    if (tile && facts != nullptr) {
      facts->triangles += tile->terrain().tin.triangle_count();
      facts->gradients = tile->terrain().gradient_kind;
      for (const Vec2 p : tile->terrain().tin.points)
        facts->vertices += own.get(static_cast<int>(std::lround(p.x / index.cell_width)),
                                   static_cast<int>(std::lround(-p.y / index.cell_height)))
                               ? 1
                               : 0;
    }
    assess_part({tile ? &tile->terrain() : nullptr, &raster, w, own, &around, wide}, tolerance, sums, context);
    context.report("compare", static_cast<double>(++done) / static_cast<double>(index.tiles.size()));
  }
  ErrorReport report = report_of(sums);
  const auto columns = static_cast<std::size_t>(index.columns);
  const std::size_t row = sums.largest_cell / columns, column = sums.largest_cell % columns;
  const Vec2 place{static_cast<double>(column) * index.cell_width, -static_cast<double>(row) * index.cell_height};
  report.max_error_at = index.georef.to_crs(place);
  return report;
}

}  // namespace retalho
