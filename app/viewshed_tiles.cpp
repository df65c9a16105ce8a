#include "viewshed_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "needs.h"
#include "retalho/core/memory.h"
#include "retalho/model/tiled.h"
#include "retalho/visibility/viewshed.h"

namespace retalho::app {
namespace {

/// A rectangle in cells.
struct CellBox {
  double left, top, right, bottom;
};

/// All cells within the radius of a place, and one more to each side.
CellBox reach_of(const TiledIndex& index, Vec2 crs, double radius) {
  const Vec2 p = index.georef.to_local(crs);
  const double column = p.x / index.cell_width, row = -p.y / index.cell_height;
  const double across = radius / index.cell_width + 1, down = radius / index.cell_height + 1;
  return {std::floor(column - across), std::floor(row - down), std::ceil(column + across), std::ceil(row + down)};
}

bool meet(const CellBox& a, const CellBox& b) {
  return a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;
}

/// Does the segment pass the box? The box is convex: it does when neither an axis nor the line parts them.
bool passes(Vec2 from, Vec2 to, const CellBox& box) {
  const CellBox segment{std::min(from.x, to.x), std::min(from.y, to.y), std::max(from.x, to.x), std::max(from.y, to.y)};
  if (!meet(segment, box)) return false;
  int left = 0, right = 0;
  for (const Vec2 corner :
       {Vec2{box.left, box.top}, Vec2{box.right, box.top}, Vec2{box.left, box.bottom}, Vec2{box.right, box.bottom}}) {
    const double side = cross(to - from, corner - from);
    left += side >= 0 ? 1 : 0;
    right += side <= 0 ? 1 : 0;
  }
  return left > 0 && right > 0;
}

CellBox box_of(const CellWindow& w) {
  return {w.column - 1.0, w.row - 1.0, w.column + w.columns * 1.0, w.row + w.rows * 1.0};
}

bool needed(const TiledIndex& index, const TileEntry& entry, const SightPlaces& places) {
  const CellBox tile = box_of(entry.cells);
  const auto cell = [&](Vec2 crs) {
    const Vec2 p = index.georef.to_local(crs);
    return Vec2{p.x / index.cell_width, -p.y / index.cell_height};
  };
  return std::any_of(places.observers.begin(), places.observers.end(), [&](Vec2 observer) {
    if (places.target) return passes(cell(observer), cell(*places.target), tile);
    return places.radius == 0 || meet(reach_of(index, observer, places.radius), tile);
  });
}

}  // namespace

Raster cells_in_reach(const Program& program, TileReader& reader, const std::string& path, const SightPlaces& places,
                      double a_cell, const Context& context) {
  const TiledIndex& index = reader.index();
  const CellHeights cells = cells_of(reader);
  for (const Vec2 observer : places.observers) observer_at(cells, observer, 0);  // says what is wrong with its place
  CellWindow window{0, 0, index.columns, index.rows};
  if (places.radius > 0 && !places.observers.empty()) {
    CellBox all = reach_of(index, places.observers.front(), places.radius);
    for (const Vec2 observer : places.observers) {
      const CellBox one = reach_of(index, observer, places.radius);
      all = {std::min(all.left, one.left), std::min(all.top, one.top), std::max(all.right, one.right),
             std::max(all.bottom, one.bottom)};
    }
    const auto within = [](double cell, int count) { return static_cast<int>(std::clamp(cell, 0.0, count - 1.0)); };
    window.column = within(all.left, index.columns);
    window.row = within(all.top, index.rows);
    window.columns = within(all.right, index.columns) - window.column + 1;
    window.rows = within(all.bottom, index.rows) - window.row + 1;
  }
  check_memory(kProcessMemory + static_cast<double>(window.columns) * window.rows * (sizeof(double) + a_cell),
               fmt::format("the map of {} x {} cells of a tiled model", window.columns, window.rows), path);
  Raster raster = raster_of_window(reader, window, context);
  program.say(fmt::format("{}: the model at {} x {} of its {} x {} cells{}; {} of {} tiles read", path, raster.columns,
                          raster.rows, index.columns, index.rows,
                          places.radius > 0 ? ", those that --radius reaches" : "", reader.reads(),
                          index.tiles.size()));
  return raster;
}

Terrain tiles_in_reach(const Program& program, const std::string& path, const SightPlaces& places) {
  const TiledIndex index = read_tiled_index(path);
  std::size_t vertices = 0, tiles = 0;
  for (const TileEntry& entry : index.tiles)
    if (needed(index, entry, places)) {
      vertices += entry.vertices;
      ++tiles;
    }
  check_vertex_need("the map of", vertices, kVertexLoaded, 0, path);
  program.say(fmt::format("{}: {} of {} tiles read", path, tiles, index.tiles.size()));
  return load_tiled_part(path, [&](const TileEntry& entry) { return needed(index, entry, places); });
}

}  // namespace retalho::app
