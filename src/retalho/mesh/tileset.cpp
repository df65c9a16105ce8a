#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/mesh/mesh_file.h"
#include "retalho/mesh/mesh_frame.h"
#include "retalho/mesh/mesh_spool.h"
#include "retalho/mesh/mesh_stream.h"
#include "retalho/mesh/seam_mesh.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/raster/geodetic.h"

namespace retalho {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
constexpr double kLattice = 1e-4;   // metres: positions are rounded to a power of two under this
constexpr double kExact = 1 << 22;  // lattice steps; their halves are exact in a float

constexpr double kNudge = 1.0;  // local units

/// Positions and normals in east, north, up at one place.
struct Frame {
  EastNorthUp axes;
  Vec3 origin;  // earth-centred
  Vec3 turned(Vec3 v) const { return {dot(axes.east, v), dot(axes.north, v), dot(axes.up, v)}; }
};

/// Longitudes and latitudes of a block's positions moved by each of `nudges`, one nudge after the other. `first`: the
/// number of the block's first vertex.
std::vector<Vec2> degrees_of(const Geodetic& geodetic, const Georef& georef, std::span<const Vec3> positions,
                             std::initializer_list<Vec2> nudges, std::uint64_t first) {
  std::vector<Vec2> points;
  points.reserve(nudges.size() * positions.size());
  for (const Vec2 d : nudges)
    for (const Vec3& p : positions) points.push_back(georef.to_crs({p.x + d.x, p.y + d.y}));
  geodetic.to_degrees(points);
  for (std::size_t k = 0; k < points.size(); ++k)
    if (std::isnan(points[k].x) || std::abs(points[k].y) > 90)
      throw BadInput(fmt::format("vertex {} of the mesh cannot be put on the globe", first + k % positions.size()));
  return points;
}

/// At the middle of the mesh.
Frame frame_of(const MeshStream& mesh, const Geodetic& geodetic, const Georef& georef) {
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  std::uint64_t first = 0;
  mesh.each_vertex([&](const VertexBlock& block) {
    for (const Vec2 p : degrees_of(geodetic, georef, block.positions, {{0, 0}}, first)) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    first += block.positions.size();
  });
  const Vec2 middle = (low + high) / 2;
  return {east_north_up(middle), earth_centred(middle, 0)};
}

/// Each vertex by itself: positions and, by differences, normals.
void place_on_globe(const MeshStream& mesh, const Geodetic& geodetic, const Georef& georef, const Frame& frame,
                    MeshSpool& placed) {
  std::uint64_t first = 0;
  mesh.each_vertex([&](const VertexBlock& block) {
    const std::size_t n = block.positions.size();
    const std::vector<Vec2> points =
        degrees_of(geodetic, georef, block.positions, {{0, 0}, {kNudge, 0}, {0, kNudge}}, first);
    first += n;
    for (std::size_t k = 0; k < n; ++k) {
      const double z = block.positions[k].z + mesh.offset.z;
      const Vec3 p = earth_centred(points[k], z);
      Vec3 normal;
      if (!block.normals.empty()) {
        // The plane across the normal is spanned by (1, 0, a) and (0, 1, b).
        const Vec3 m = block.normals[k];
        const double a = -m.x / m.z, b = -m.y / m.z;
        const Vec3 along = earth_centred(points[n + k], z + a * kNudge) - p,
                   across = earth_centred(points[2 * n + k], z + b * kNudge) - p;
        normal = normalized(frame.turned(cross(along, across)));
      }
      placed.add_vertex(frame.turned(p - frame.origin), normal);
    }
  });
  placed.finish();
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

double half_of(const Box& box) {
  return std::max({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z}) / 2;
}

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles by the square of a raster of squares that their middle lies in; row by row, each square's in the mesh's
/// order. They lie in a file.
class Squares {
 public:
  Squares(const MeshStream& mesh, MeshSpool& placed, const Box& whole, std::size_t triangles, MeshFile& file)
      : placed_(placed), whole_(whole), file_(file) {
    const double parts = std::max(1.0, static_cast<double>(mesh.triangles) / static_cast<double>(triangles));
    const double width = whole.high.x - whole.low.x, height = whole.high.y - whole.low.y;
    columns_ = std::max(1L, std::lround(std::sqrt(parts * width / height)));
    rows_ = std::max(1L, std::lround(std::ceil(parts / static_cast<double>(columns_))));
    squares_.resize(static_cast<std::size_t>(columns_ * rows_));
    mesh.each_triangle([&](TriangleBlock block) {
      for (const Triangle& t : block) {
        Square& square = squares_[square_of(t)];
        ++square.count;
        for (const std::uint32_t v : t) square.box.add(placed_.vertex(v).position);
      }
    });
    std::uint64_t at = 0;
    for (Square& square : squares_) {
      square.first = square.next = at;
      at += square.count;
    }
    mesh.each_triangle([&](TriangleBlock block) {
      for (const Triangle& t : block) {
        Square& square = squares_[square_of(t)];
        square.waiting.push_back(t);
        if (square.waiting.size() == kWaiting) flush(square);
      }
    });
    for (Square& square : squares_) flush(square);
    std::erase_if(squares_, [](const Square& square) { return square.count == 0; });
  }

  std::size_t count() const { return squares_.size(); }
  const Box& box(std::size_t k) const { return squares_[k].box; }
  std::vector<Triangle> triangles(std::size_t k) const {
    std::vector<Triangle> all(squares_[k].count);
    file_.get(all.data(), all.size() * sizeof(Triangle), squares_[k].first * sizeof(Triangle));
    return all;
  }

 private:
  static constexpr std::size_t kWaiting = 256;
  struct Square {
    std::uint64_t count = 0, first = 0, next = 0;
    Box box;
    std::vector<Triangle> waiting;
  };

  std::size_t square_of(const Triangle& t) {
    Vec3 middle;
    for (const std::uint32_t v : t) middle = middle + placed_.vertex(v).position / 3.0;
    const auto at = [](double share, long count) {
      return std::clamp(static_cast<long>(share * static_cast<double>(count)), 0L, count - 1);
    };
    const long c = at((middle.x - whole_.low.x) / (whole_.high.x - whole_.low.x), columns_),
               r = at((whole_.high.y - middle.y) / (whole_.high.y - whole_.low.y), rows_);
    return static_cast<std::size_t>(r * columns_ + c);
  }
  void flush(Square& square) {
    file_.put(square.waiting.data(), square.waiting.size() * sizeof(Triangle), square.next * sizeof(Triangle));
    square.next += square.waiting.size();
    square.waiting.clear();
  }

  MeshSpool& placed_;
  Box whole_;
  MeshFile& file_;
  long columns_ = 1, rows_ = 1;
  std::vector<Square> squares_;
};

/// Positions are rounded to multiples of `step`.
TriangleMesh part_of(MeshSpool& placed, bool normals, const std::vector<Triangle>& triangles, double step) {
  TriangleMesh part;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  for (const Triangle& t : triangles) {
    Triangle mapped{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [found, made] = number.emplace(t[k], static_cast<std::uint32_t>(part.positions.size()));
      if (made) {
        const MeshSpool::Vertex& v = placed.vertex(t[k]);
        const Vec3 p = v.position;
        part.positions.push_back(
            {std::round(p.x / step) * step, std::round(p.y / step) * step, std::round(p.z / step) * step});
        if (normals) part.normals.push_back(v.normal);
      }
      mapped[k] = found->second;
    }
    part.triangles.push_back(mapped);
  }
  return part;
}

/// A power of two, coarse enough that a tile's half is exact in single precision.
double lattice_of(double half) {
  double step = std::exp2(std::floor(std::log2(kLattice)));
  while (half / step > kExact) step *= 2;
  return step;
}

/// The folder, made where it is missing, if tileset.json is not there or may be replaced. One that was made goes again,
/// unless something stands in it, where the work ends before its index is written.
class OutputFolder {
 public:
  OutputFolder(fs::path root, bool overwrite) : root_(std::move(root)) {
    const fs::path index = root_ / "tileset.json";
    if (fs::exists(index) && !overwrite)
      throw CannotWrite(fmt::format("'{}' exists: --overwrite replaces it", index.string()), index.string());
    std::error_code ec;
    made_ = fs::create_directories(root_, ec);
    if (ec)
      throw CannotWrite(fmt::format("cannot make the folder '{}': {}", root_.string(), ec.message()), root_.string());
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder() {
    std::error_code ec;
    if (made_) fs::remove(root_, ec);  // of an empty folder only
  }

 private:
  fs::path root_;
  bool made_ = false;
};

/// A name in the folder for files that have none once they are open.
std::string hidden_in(const fs::path& root, const char* what) {
  return (root / fmt::format(".tileset-{}-{}", getpid(), what)).string();
}

GlobeNotes write_squares(const MeshStream& mesh, const Georef& georef, const Geodetic& geodetic, const fs::path& root,
                         const TilesetOptions& options, double tolerance, bool overwrite, const Context& context) {
  if (mesh.triangles == 0) throw BadInput("the model has no triangle with data");
  const std::string index = (root / "tileset.json").string();
  const Frame frame = frame_of(mesh, geodetic, georef);
  MeshSpool placed(hidden_in(root, "placed"), index);
  place_on_globe(mesh, geodetic, georef, frame, placed);
  context.check();
  Box whole;
  for (std::uint64_t v = 0; v < placed.vertices(); ++v)
    whole.add(placed.vertex(static_cast<std::uint32_t>(v)).position);
  MeshFile file(hidden_in(root, "squares"), index);
  const Squares squares(mesh, placed, whole, options.triangles, file);
  double half = 0;
  for (std::size_t k = 0; k < squares.count(); ++k) half = std::max(half, half_of(squares.box(k)) + 1);
  const double step = lattice_of(half);
  const EastNorthUp& f = frame.axes;
  const double extent = norm(whole.high - whole.low);
  Json children = Json::array();
  GlobeNotes notes;
  Box around;
  for (std::size_t k = 0; k < squares.count(); ++k) {
    context.check();
    const TriangleMesh part = part_of(placed, mesh.normals, squares.triangles(k), step);
    const std::string name = fmt::format("tile-{}.glb", k);
    write_mesh(part, (root / name).string(), true);
    Box box;
    for (const Vec3& p : part.positions) box.add(p);
    around.add(box.low);
    around.add(box.high);
    children.push_back({{"boundingVolume", box.volume()}, {"geometricError", 0.0}, {"content", {{"uri", name}}}});
    notes.triangles += part.triangles.size();
    notes.bytes += fs::file_size(root / name);
    context.report("tileset", static_cast<double>(k + 1) / static_cast<double>(squares.count()));
  }
  // Without the tiles nothing is shown: an error as large as the whole.
  const Json tileset = {{"asset", {{"version", "1.1"}, {"generator", "retalho"}}},
                        {"geometricError", extent},
                        {"root",
                         {{"transform",
                           {f.east.x, f.east.y, f.east.z, 0.0, f.north.x, f.north.y, f.north.z, 0.0, f.up.x, f.up.y,
                            f.up.z, 0.0, frame.origin.x, frame.origin.y, frame.origin.z, 1.0}},
                          {"boundingVolume", around.volume()},
                          {"geometricError", extent},
                          {"refine", "ADD"},
                          {"children", children}}}};
  write_file(index, tileset.dump(1) + "\n", overwrite);
  notes.tiles = squares.count();
  notes.levels = 1;
  notes.step = tolerance;
  return notes;
}

}  // namespace

GlobeNotes write_tileset(const Terrain& terrain, const std::string& folder, const TilesetOptions& options,
                         bool overwrite, const Context& context) {
  if (options.triangles < 1) throw UsageError("a tile needs at least one triangle");
  const Geodetic geodetic(terrain.georef.crs_wkt);
  const double tolerance = mesh_tolerance(terrain, {.tolerance = options.tolerance});
  const TriangleMesh mesh = mesh_terrain(terrain, {.tolerance = tolerance}, context);
  const OutputFolder made(folder, overwrite);
  return write_squares(stream_of(mesh), terrain.georef, geodetic, folder, options, tolerance, overwrite, context);
}

GlobeNotes write_tileset(const TileSource& tiles, const std::string& folder, const TilesetOptions& options,
                         bool overwrite, const Context& context) {
  if (options.triangles < 1) throw UsageError("a tile needs at least one triangle");
  const Geodetic geodetic(tiles.georef.crs_wkt);
  const VertexBox box = vertex_box(tiles, context);
  if (!box.data) throw BadInput("the model has no triangle with data");
  const double tolerance = mesh_tolerance(box.low.z, box.high.z, {.tolerance = options.tolerance});
  const OutputFolder made(folder, overwrite);
  MeshSpool spool(hidden_in(folder, "mesh"), (fs::path(folder) / "tileset.json").string());
  spool_tile_mesh(tiles, tolerance, spool, context);
  MeshStream stream = spool.stream();
  stream.offset = mesh_frame(tiles.georef).offset;
  return write_squares(stream, tiles.georef, geodetic, folder, options, tolerance, overwrite, context);
}

}  // namespace retalho
