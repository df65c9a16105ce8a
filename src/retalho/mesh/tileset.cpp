#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <vector>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/raster/geodetic.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr double kLattice = 1e-4;   // metres: positions are rounded to a power of two under this
constexpr double kExact = 1 << 22;  // lattice steps; their halves are exact in a float

/// The surface on the globe: positions and normals in east, north, up at one place.
struct Placed {
  EastNorthUp frame;
  Vec3 origin;  // earth-centred
  std::vector<Vec3> positions, normals;
};

Vec3 in_frame(const EastNorthUp& f, Vec3 v) {
  return {dot(f.east, v), dot(f.north, v), dot(f.up, v)};
}

/// Columns of the map from the model's local directions to the frame, at each vertex: by differences.
Placed place_on_globe(const TriangleMesh& mesh, const Georef& georef) {
  const Geodetic geodetic(georef.crs_wkt);
  const std::size_t n = mesh.positions.size();
  std::vector<Vec2> points;
  points.reserve(3 * n);
  const double nudge = 1.0;  // local units
  for (const Vec2 d : {Vec2{0, 0}, Vec2{nudge, 0}, Vec2{0, nudge}})
    for (const Vec3& p : mesh.positions) points.push_back(georef.to_crs({p.x + d.x, p.y + d.y}));
  geodetic.to_degrees(points);
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  for (std::size_t k = 0; k < n; ++k) {
    if (std::isnan(points[k].x) || std::isnan(points[n + k].x) || std::isnan(points[2 * n + k].x) ||
        std::abs(points[k].y) > 90)
      throw BadInput(fmt::format("vertex {} of the mesh cannot be put on the globe", k));
    low = {std::min(low.x, points[k].x), std::min(low.y, points[k].y)};
    high = {std::max(high.x, points[k].x), std::max(high.y, points[k].y)};
  }
  Placed placed;
  const Vec2 middle = (low + high) / 2;
  placed.frame = east_north_up(middle);
  placed.origin = earth_centred(middle, 0);
  placed.positions.reserve(n);
  placed.normals.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double z = mesh.positions[k].z + mesh.offset.z;
    const Vec3 p = earth_centred(points[k], z);
    placed.positions.push_back(in_frame(placed.frame, p - placed.origin));
    if (mesh.normals.empty()) continue;
    // The plane across the normal is spanned by (1, 0, a) and (0, 1, b).
    const Vec3 m = mesh.normals[k];
    const double a = -m.x / m.z, b = -m.y / m.z;
    const Vec3 along = earth_centred(points[n + k], z + a * nudge) - p,
               across = earth_centred(points[2 * n + k], z + b * nudge) - p;
    placed.normals.push_back(normalized(in_frame(placed.frame, cross(along, across))));
  }
  return placed;
}

struct Box {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  void add(Vec3 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  /// 3D Tiles' box: centre, then the half-axes.
  Json volume() const {
    const Vec3 c = 0.5 * (low + high), h = 0.5 * (high - low);
    return {{"box", {c.x, c.y, c.z, h.x, 0.0, 0.0, 0.0, h.y, 0.0, 0.0, 0.0, h.z}}};
  }
};

/// Triangles by the square of a raster of squares that their middle lies in; row by row.
std::vector<std::vector<std::uint32_t>> cut(const Placed& placed, const TriangleMesh& mesh, const Box& box,
                                            std::size_t triangles) {
  const double parts = std::max(1.0, static_cast<double>(mesh.triangles.size()) / static_cast<double>(triangles));
  const double width = box.high.x - box.low.x, height = box.high.y - box.low.y;
  const auto columns = std::max(1L, std::lround(std::sqrt(parts * width / height)));
  const auto rows = std::max(1L, std::lround(std::ceil(parts / static_cast<double>(columns))));
  std::vector<std::vector<std::uint32_t>> tiles(static_cast<std::size_t>(columns * rows));
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    Vec3 middle;
    for (const std::uint32_t v : mesh.triangles[t]) middle = middle + placed.positions[v] / 3.0;
    const auto at = [](double share, long count) {
      return std::clamp(static_cast<long>(share * static_cast<double>(count)), 0L, count - 1);
    };
    const long c = at((middle.x - box.low.x) / width, columns), r = at((box.high.y - middle.y) / height, rows);
    tiles[static_cast<std::size_t>(r * columns + c)].push_back(t);
  }
  std::erase_if(tiles, [](const auto& tile) { return tile.empty(); });
  return tiles;
}

TriangleMesh part_of(const Placed& placed, const TriangleMesh& mesh, const std::vector<std::uint32_t>& triangles) {
  TriangleMesh part;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  for (const std::uint32_t t : triangles) {
    std::array<std::uint32_t, 3> mapped{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      const auto [found, made] = number.emplace(v, static_cast<std::uint32_t>(part.positions.size()));
      if (made) {
        part.positions.push_back(placed.positions[v]);
        if (!placed.normals.empty()) part.normals.push_back(placed.normals[v]);
      }
      mapped[k] = found->second;
    }
    part.triangles.push_back(mapped);
  }
  return part;
}

/// Rounds to a power of two, coarse enough that a tile's half is exact in single precision.
void put_on_lattice(Placed& placed, double half) {
  double step = std::exp2(std::floor(std::log2(kLattice)));
  while (half / step > kExact) step *= 2;
  for (Vec3& p : placed.positions)
    p = {std::round(p.x / step) * step, std::round(p.y / step) * step, std::round(p.z / step) * step};
}

double half_of(const Box& box) {
  return std::max({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z}) / 2;
}

}  // namespace

GlobeNotes write_tileset(const Terrain& terrain, const std::string& folder, const TilesetOptions& options,
                         bool overwrite, const Context& context) {
  if (options.triangles < 1) throw UsageError("a tile needs at least one triangle");
  const double tolerance = mesh_tolerance(terrain, {.tolerance = options.tolerance});
  const TriangleMesh mesh = mesh_terrain(terrain, {.tolerance = tolerance}, context);
  if (mesh.triangles.empty()) throw BadInput("the model has no triangle with data");
  Placed placed = place_on_globe(mesh, terrain.georef);
  Box whole;
  for (const Vec3& p : placed.positions) whole.add(p);
  const auto tiles = cut(placed, mesh, whole, options.triangles);
  double half = 0;
  for (const auto& tile : tiles) {
    Box box;
    for (const std::uint32_t t : tile)
      for (const std::uint32_t v : mesh.triangles[t]) box.add(placed.positions[v]);
    half = std::max(half, half_of(box) + 1);
  }
  put_on_lattice(placed, half);
  const fs::path root(folder), index = root / "tileset.json";
  if (fs::exists(index) && !overwrite)
    throw CannotWrite(fmt::format("'{}' exists: --overwrite replaces it", index.string()), index.string());
  std::error_code ec;
  fs::create_directories(root, ec);
  if (ec) throw CannotWrite(fmt::format("cannot make the folder '{}': {}", folder, ec.message()), folder);
  const EastNorthUp& f = placed.frame;
  const double extent = norm(whole.high - whole.low);
  Json children = Json::array();
  GlobeNotes notes;
  Box around;
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    context.check();
    const TriangleMesh part = part_of(placed, mesh, tiles[k]);
    const std::string name = fmt::format("tile-{}.glb", k);
    write_mesh(part, (root / name).string(), true);
    Box box;
    for (const Vec3& p : part.positions) box.add(p);
    around.add(box.low);
    around.add(box.high);
    children.push_back({{"boundingVolume", box.volume()}, {"geometricError", 0.0}, {"content", {{"uri", name}}}});
    notes.triangles += part.triangles.size();
    notes.bytes += fs::file_size(root / name);
    context.report("tileset", static_cast<double>(k + 1) / static_cast<double>(tiles.size()));
  }
  // Without the tiles nothing is shown: an error as large as the whole.
  const Json tileset = {{"asset", {{"version", "1.1"}, {"generator", "retalho"}}},
                        {"geometricError", extent},
                        {"root",
                         {{"transform",
                           {f.east.x, f.east.y, f.east.z, 0.0, f.north.x, f.north.y, f.north.z, 0.0, f.up.x, f.up.y,
                            f.up.z, 0.0, placed.origin.x, placed.origin.y, placed.origin.z, 1.0}},
                          {"boundingVolume", around.volume()},
                          {"geometricError", extent},
                          {"refine", "ADD"},
                          {"children", children}}}};
  write_file(index.string(), tileset.dump(1) + "\n", overwrite);
  notes.tiles = tiles.size();
  notes.levels = 1;
  notes.step = tolerance;
  return notes;
}

}  // namespace retalho
