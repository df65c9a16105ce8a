#include "retalho/tiles/source.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace retalho {

TileSource tile_source(const std::string& folder, std::size_t bound) {
  const auto index = std::make_shared<const TiledIndex>(read_tiled_index(folder));
  TileSource source;
  source.tile_rows = index->tile_rows();
  source.tile_columns = index->tile_columns();
  source.columns = index->columns;
  source.rows = index->rows;
  source.georef = index->georef;
  source.cell_width = index->cell_width;
  source.cell_height = index->cell_height;
  std::size_t largest = 1;
  for (const TileEntry& entry : index->tiles) largest = std::max(largest, entry.vertices);
  source.at_once = std::max<std::size_t>(1, bound / (largest * kWorkedVertex));
  source.load = [index, folder](int row, int column) -> std::optional<PlacedTile> {
    const TileEntry& entry =
        index->tiles[static_cast<std::size_t>(row) * static_cast<std::size_t>(index->tile_columns()) +
                     static_cast<std::size_t>(column)];
    if (entry.file.empty()) return std::nullopt;
    return load_placed_tile(*index, entry, folder);
  };
  return source;
}

GlobeSurface globe_surface(TileReader& reader, const VertexBox& box) {
  GlobeSurface surface;
  surface.georef = reader.index().georef;
  surface.low = box.low;
  surface.high = box.high;
  surface.columns = reader.index().columns;
  surface.jets = [&reader](std::span<const Vec2> points) { return reader.jets(points); };
  return surface;
}

}  // namespace retalho
