#include "retalho/mesh/seam_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/mesh/mesh_frame.h"
#include "retalho/mesh/terrain_mesh.h"

namespace retalho {
namespace {

/// The sides that a place lies on. Vertices on a seam have its very coordinate: cells times their size, and halves of
/// edges along it.
class SeamLines {
 public:
  SeamLines(const PlacedTile& tile, const TilePlace& place)
      : place_(place),
        north_(-static_cast<double>(tile.first_row) * tile.terrain.grid.cell_height),
        west_(static_cast<double>(tile.first_column) * tile.terrain.grid.cell_width),
        south_(-static_cast<double>(tile.first_row + tile.terrain.grid.rows - 1) * tile.terrain.grid.cell_height),
        east_(static_cast<double>(tile.first_column + tile.terrain.grid.columns - 1) * tile.terrain.grid.cell_width) {}

  std::uint8_t of(double x, double y) const {
    return static_cast<std::uint8_t>(
        (place_.north && y == north_ ? kNorthSeam : kNoSeam) | (place_.west && x == west_ ? kWestSeam : kNoSeam) |
        (place_.south && y == south_ ? kSouthSeam : kNoSeam) | (place_.east && x == east_ ? kEastSeam : kNoSeam));
  }

 private:
  TilePlace place_;
  double north_, west_, south_, east_;
};

}  // namespace

namespace {

/// What each triangle of a linear surface gives its corners on seams.
std::vector<TileMesh::Share> shares_of(const Tin& tin, const SeamLines& lines) {
  std::vector<TileMesh::Share> shares;
  const auto corner = [&](std::uint32_t v) { return Vec3{tin.points[v].x, tin.points[v].y, tin.heights[v]}; };
  for (const auto& v : tin.triangles)
    for (const std::uint32_t k : v) {
      const Vec2 p = tin.points[k];
      const std::uint8_t seams = lines.of(p.x, p.y);
      if (seams == kNoSeam) continue;
      const Vec3 a = corner(v[0]), b = corner(v[1]), c = corner(v[2]);
      shares.push_back({p, seams, cross(b - a, c - a)});
    }
  return shares;
}

/// The mesher would look for the cells where the tile's own lie: it is given a terrain without any, and what is in the
/// void goes here.
void drop_void(const PlacedTile& tile, TriangleMesh& mesh) {
  std::erase_if(mesh.triangles, [&](const std::array<std::uint32_t, 3>& v) {
    const Vec3 a = mesh.positions[v[0]], b = mesh.positions[v[1]], c = mesh.positions[v[2]];
    return !tile.has_data({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3});
  });
  drop_unused_vertices(mesh);
}

}  // namespace

TileMesh mesh_tile(PlacedTile tile, double tolerance, const TilePlace& place, const Context& context) {
  TileMesh made;
  const SeamLines lines(tile, place);
  const GridDomain cells = std::exchange(tile.terrain.grid, {});
  made.mesh = mesh_terrain(tile.terrain, {.tolerance = tolerance}, context);
  tile.terrain.grid = cells;
  drop_void(tile, made.mesh);
  made.check = check_mesh(made.mesh);
  made.parts = parts_of(made.mesh, made.part_count);
  for (const Vec3& p : made.mesh.positions) made.seams.push_back(lines.of(p.x, p.y));
  if (tile.terrain.kind == SurfaceKind::linear) made.shares = shares_of(tile.terrain.tin, lines);
  return made;
}

std::size_t SeamMesh::PlaceHash::operator()(const Place& p) const {
  const auto x = std::bit_cast<std::uint64_t>(p[0]), y = std::bit_cast<std::uint64_t>(p[1]);
  const std::uint64_t h = (x * 0x9e3779b97f4a7c15ULL) ^ std::rotl(y * 0xc2b2ae3d27d4eb4fULL, 31);
  return static_cast<std::size_t>(h ^ (h >> 29));
}

SeamMesh::Seam& SeamMesh::seam_of(std::uint8_t seams) {
  if ((seams & kNorthSeam) != 0) return above_;
  if ((seams & kSouthSeam) != 0) return below_;
  return (seams & kWestSeam) != 0 ? west_ : east_;
}

std::uint32_t SeamMesh::root(std::uint32_t part) {
  while (parent_[part] != part) part = parent_[part] = parent_[parent_[part]];
  return part;
}

std::vector<std::uint32_t> SeamMesh::place_vertices(const TileMesh& tile) {
  const auto first_part = static_cast<std::uint32_t>(parent_.size());
  for (std::size_t k = 0; k < tile.part_count; ++k) parent_.push_back(static_cast<std::uint32_t>(parent_.size()));
  for (const TileMesh::Share& share : tile.shares) {
    Known& known = seam_of(share.seams).vertices[{share.place.x, share.place.y}];
    known.sum = known.sum + share.twice_area;
    known.shared = true;
  }
  if (spool_.vertices() + tile.mesh.positions.size() > most_vertices_)
    throw BadInput(fmt::format(
        "the mesh has more than {} vertices, which is all that its files can number: use a larger tolerance",
        most_vertices_));
  std::vector<std::uint32_t> numbers(tile.mesh.positions.size());
  for (std::size_t v = 0; v < numbers.size(); ++v) {
    const Vec3 p = tile.mesh.positions[v];
    if (tile.seams[v] == kNoSeam) {
      numbers[v] = spool_.add_vertex(p, tile.mesh.normals[v]);
      continue;
    }
    Known& known = seam_of(tile.seams[v]).vertices[{p.x, p.y}];
    const std::uint32_t part = first_part + tile.parts[v];
    if (known.number == kNoPart) {
      known.number = spool_.add_vertex(p, tile.mesh.normals[v]);
      known.height = p.z;
      known.part = part;
    } else if (std::bit_cast<std::uint64_t>(known.height) != std::bit_cast<std::uint64_t>(p.z)) {
      throw CannotRead(
          fmt::format(
              "two neighbouring tiles differ at local place ({}, {}), on their seam: make the tiled model again "
              "(retalho fit --tiles)",
              p.x, p.y),
          {});
    }
    numbers[v] = known.number;
    parent_[root(part)] = root(known.part);
  }
  return numbers;
}

void SeamMesh::join_edges(const TileMesh& tile, const std::vector<std::uint32_t>& numbers) {
  for (const auto& t : tile.mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const auto side = static_cast<std::uint8_t>(tile.seams[a] & tile.seams[b]);
      if (side == kNoSeam) continue;
      const std::uint32_t low = std::min(numbers[a], numbers[b]), high = std::max(numbers[a], numbers[b]);
      const bool upwards = numbers[a] == low;
      const OpenEdge edge{tile.mesh.positions[a], tile.mesh.positions[b]};
      const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | high;
      Seam& seam = seam_of(side);
      if ((side & (kSouthSeam | kEastSeam)) != 0) {
        seam.edges.emplace(key, Waiting{upwards, edge});
        continue;
      }
      const auto found = seam.edges.find(key);
      if (found == seam.edges.end()) {
        seam.alone.push_back(edge);
        continue;
      }
      check_.open_edges -= 2;
      check_.nonmanifold_edges += found->second.upwards == upwards ? 1 : 0;
      seam.edges.erase(found);
    }
}

void SeamMesh::leave(Seam& seam) {
  for (const auto& [place, known] : seam.vertices)
    if (known.shared && known.number != kNoPart)
      spool_.set_normal(known.number, norm2(known.sum) > 0 ? normalized(known.sum) : Vec3{0, 0, 1});
  if (!seam.alone.empty() && !seam.edges.empty()) {
    std::vector<OpenEdge> open = std::move(seam.alone);
    for (const auto& [key, waiting] : seam.edges) open.push_back(waiting.edge);
    check_.cracks += count_cracks(std::move(open));
  }
  seam = {};
}

void SeamMesh::add(const TileMesh& tile, bool last_of_row) {
  check_.open_edges += tile.check.open_edges;
  check_.cracks += tile.check.cracks;
  check_.nonmanifold_edges += tile.check.nonmanifold_edges;
  check_.degenerate_triangles += tile.check.degenerate_triangles;
  const std::vector<std::uint32_t> numbers = place_vertices(tile);
  join_edges(tile, numbers);
  for (const auto& t : tile.mesh.triangles) spool_.add_triangle({numbers[t[0]], numbers[t[1]], numbers[t[2]]});
  leave(west_);
  std::swap(west_, east_);
  if (!last_of_row) return;
  leave(west_);
  leave(above_);
  std::swap(above_, below_);
}

MeshCheck SeamMesh::finish() {
  leave(above_);
  for (std::uint32_t part = 0; part < parent_.size(); ++part) check_.components += root(part) == part ? 1 : 0;
  check_.boundary_edges = check_.open_edges - check_.cracks;
  return check_;
}

}  // namespace retalho
