#include "retalho/level/seam_joiner.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace retalho {
namespace {

struct TileCell {
  long long column, row;
};

TileCell cell_at(const Terrain& terrain, std::uint32_t vertex) {
  const Vec2 p = terrain.tin.points[vertex];
  return {std::llround(p.x / terrain.grid.cell_width), std::llround(-p.y / terrain.grid.cell_height)};
}

/// The open side that an edge lies on.
std::optional<TileSide> side_of(const PlacedTile& tile, TileCell a, TileCell b, const std::array<bool, 4>& open) {
  const auto on = [](long long u, long long v, long long at) { return u == at && v == at; };
  const std::array<bool, 4> lies{on(a.row, b.row, tile.first_row), on(a.column, b.column, tile.first_column),
                                 on(a.row, b.row, tile.first_row + tile.terrain.grid.rows - 1),
                                 on(a.column, b.column, tile.first_column + tile.terrain.grid.columns - 1)};
  for (std::size_t side = 0; side < 4; ++side)
    if (lies[side]) return open[side] ? std::optional(static_cast<TileSide>(side)) : std::nullopt;
  return std::nullopt;
}

}  // namespace

std::vector<SeamRoot> seam_roots(const PlacedTile& tile, const EdgeTable& edges, const OuterRoots& outer,
                                 const std::array<bool, 4>& open) {
  std::vector<SeamRoot> roots;
  const auto halves = static_cast<std::size_t>(outer.halves);
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    if (edges.triangles[e][1] != kNone || outer.start[halves * e] == outer.start[halves * (e + 1)]) continue;
    const TileCell a = cell_at(tile.terrain, edges.vertices[e][0]), b = cell_at(tile.terrain, edges.vertices[e][1]);
    const std::optional<TileSide> side = side_of(tile, a, b, open);
    if (!side) continue;
    const std::uint64_t cell = (static_cast<std::uint64_t>(a.row) << 32) | static_cast<std::uint64_t>(a.column);
    for (std::size_t h = 0; h < halves; ++h)
      for (std::uint32_t i = outer.start[halves * e + h]; i < outer.start[halves * e + h + 1]; ++i)
        roots.push_back(
            {outer.roots[i].point, *side, cell, static_cast<std::uint32_t>(2 * (i - outer.start[halves * e + h]) + h)});
  }
  std::sort(roots.begin(), roots.end(), [](const SeamRoot& u, const SeamRoot& v) { return u.point < v.point; });
  return roots;
}

SeamJoiner::SeamJoiner(int tile_columns) : south_(static_cast<std::size_t>(tile_columns)) {}

LineChains::Place SeamJoiner::place_of(std::uint32_t point, const std::vector<SeamRoot>& roots) {
  const auto found = std::lower_bound(roots.begin(), roots.end(), point,
                                      [](const SeamRoot& r, std::uint32_t p) { return r.point < p; });
  if (found == roots.end() || found->point != point) return LineChains::kEnd;
  const Name name{found->cell, found->place};
  if (found->side == TileSide::north || found->side == TileSide::west) {
    const Seam& seam = found->side == TileSide::north ? north_ : west_;
    const auto waits = seam.find(name);
    return waits == seam.end() ? LineChains::kEnd : waits->second;
  }
  Seam& seam = found->side == TileSide::south ? south_[static_cast<std::size_t>(column_)] : east_;
  return seam.emplace(name, next_place_++).first->second;
}

void SeamJoiner::add(RawLines& lines, const std::vector<SeamRoot>& roots, int column, const EndName& name_end) {
  column_ = column;
  north_ = std::exchange(south_[static_cast<std::size_t>(column)], {});
  west_ = column == 0 ? Seam{} : std::exchange(east_, {});
  std::size_t kept = 0;
  for (std::size_t l = 0; l < lines.set.lines.size(); ++l) {
    const ContourLine line = lines.set.lines[l];
    const std::uint32_t number = next_line_++;
    const bool named = name_end && !line.closed;
    const std::uint32_t start = named ? name_end(lines.ends[l][0]) : number,
                        stop = named ? name_end(lines.ends[l][1]) : number;
    const LineChains::Place head = line.closed ? LineChains::kEnd : place_of(lines.ends[l][0], roots),
                            tail = line.closed ? LineChains::kEnd : place_of(lines.ends[l][1], roots);
    if (head == LineChains::kEnd && tail == LineChains::kEnd) {
      lines.set.lines[kept] = line;
      lines.ends[kept++] = {start, stop};
      continue;
    }
    chains_.add(
        {line.level, head, tail, start, stop, std::span(lines.set.points).subspan(line.begin, line.end - line.begin)});
  }
  lines.set.lines.resize(kept);
  lines.ends.resize(kept);
  // What still waits here waits for nothing; its order must not be the hash table's.
  std::vector<LineChains::Place> left;
  for (const Seam* seam : {&north_, &west_})
    for (const auto& [name, place] : *seam) left.push_back(place);
  std::sort(left.begin(), left.end());
  for (const LineChains::Place place : left) chains_.close(place);
  chains_.move_done(lines);
  sort_lines(lines);
}

}  // namespace retalho
