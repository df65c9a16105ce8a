#include "retalho/mesh/terrain_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/core/memory.h"
#include "retalho/core/parallel.h"
#include "retalho/mesh/mesh_frame.h"
#include "retalho/mesh/patch_cutter.h"
#include "retalho/terrain/creases.h"
#include "retalho/terrain/height_range.h"

namespace retalho {
namespace {

constexpr std::size_t kGrain = 512;                   // triangles of the TIN at a time
constexpr double kTriangleBytes = 95;                 // at the peak, checked and written; 83 to 91 measured
constexpr std::uint64_t kMostTriangles = 1400000000;  // what 32-bit indices allow, three a triangle

Vec3 normal_of(Vec2 gradient) {
  return normalized(Vec3{-gradient.x, -gradient.y, 1});
}
Vec3 raised(Vec2 p, double z) {
  return {p.x, p.y, z};
}

Vec2 centre_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3};
}

TriangleMesh linear_mesh(const Terrain& terrain) {
  TriangleMesh mesh;
  const Tin& tin = terrain.tin;
  mesh.positions.reserve(tin.vertex_count());
  for (std::size_t v = 0; v < tin.vertex_count(); ++v) mesh.positions.push_back(raised(tin.points[v], tin.heights[v]));
  mesh.normals.assign(tin.vertex_count(), Vec3{});
  for (const auto& v : tin.triangles) {
    const Vec3 a = mesh.positions[v[0]], b = mesh.positions[v[1]], c = mesh.positions[v[2]];
    const Vec3 twice_area = cross(b - a, c - a);
    for (const std::uint32_t k : v) mesh.normals[k] = mesh.normals[k] + twice_area;
    if (terrain.grid.has_data(centre_of(a, b, c))) mesh.triangles.push_back(v);
  }
  for (Vec3& n : mesh.normals) n = norm2(n) > 0 ? normalized(n) : Vec3{0, 0, 1};
  return mesh;
}

/// Pieces along one edge of the TIN.
constexpr std::size_t spans_of(int degree) {
  return degree == 2 ? 2 : 1;
}

/// A piece of a split triangle with its corners in the order (from, to, centre): `from` and `to` on the TIN's edge.
template <int Degree>
struct Piece {
  std::array<Vec2, 3> corners;
  TriangleNet<Degree> net;
};

/// The pieces of a triangle: spans_of(Degree) on each edge k, counter-clockwise from corner k + 1, after
/// triangle_patches, which gives (centre, from, to) for Powell-Sabin and (from, to, centre) for Clough-Tocher.
template <int Degree>
std::array<Piece<Degree>, 3 * spans_of(Degree)> pieces_of(const Terrain& terrain, const EdgeTable& edges,
                                                          std::uint32_t triangle) {
  std::array<TerrainPatch, 6> patches;
  triangle_patches(terrain, edges, triangle, patches);
  std::array<Piece<Degree>, 3 * spans_of(Degree)> pieces;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    TriangleNet<Degree> net;
    std::copy_n(patches[i].ordinates.begin(), net.size(), net.begin());
    constexpr int kTurn = Degree == 2 ? 1 : 0;
    pieces[i].net = rotated_net<Degree>(net, kTurn);
    for (std::size_t k = 0; k < 3; ++k) pieces[i].corners[k] = patches[i].corners[(k + kTurn) % 3];
  }
  return pieces;
}

template <int Degree>
class SmoothMesher {
 public:
  SmoothMesher(const Terrain& terrain, double tolerance, const Context& context)
      : terrain_(terrain), context_(context), edges_(build_edges(terrain.tin)), rule_{tolerance} {}

  TriangleMesh run() {
    measure_edges();
    number_edges();
    place_corners();
    cut_triangles();
    join_chunks();
    return std::move(mesh_);
  }

 private:
  using Side = EdgeNet<Degree>;
  using Cutter = PatchCutter<Degree>;
  using EdgeUse = typename Cutter::EdgeUse;
  static constexpr std::size_t kSpans = spans_of(Degree);
  using Pieces = std::array<Piece<Degree>, 3 * kSpans>;
  using EdgeShape = std::array<Side, kSpans>;  ///< ordinates of an edge of the TIN, from its lower-index end

  struct Chunk {
    std::vector<Vec3> positions, normals;
    std::vector<std::array<std::uint32_t, 3>> triangles;  ///< inner vertices as if this were the only chunk
  };

  bool ahead(std::uint32_t triangle, std::size_t k) const {
    const auto& v = terrain_.tin.triangles[triangle];
    return v[(k + 1) % 3] < v[(k + 2) % 3];
  }
  bool owns(std::uint32_t triangle, std::size_t k) const {
    return edges_.triangles[edges_.of_triangle[triangle][k]][0] == triangle;
  }

  /// The ordinates of every edge, from the first of its triangles, and how many vertices they ask for.
  void measure_edges() {
    context_.report("edges", 0);
    shapes_.resize(edges_.vertices.size());
    first_cut_.assign(edges_.vertices.size() + 1, 0);
    parallel_chunks(terrain_.tin.triangle_count(), kGrain, context_, [&](std::size_t begin, std::size_t end) {
      for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
        const Pieces pieces = pieces_of<Degree>(terrain_, edges_, t);
        for (std::size_t k = 0; k < 3; ++k)
          if (owns(t, k)) measure_edge(pieces, t, k);
      }
    });
  }

  void measure_edge(const Pieces& pieces, std::uint32_t t, std::size_t k) {
    const std::uint32_t e = edges_.of_triangle[t][k];
    const bool forward = ahead(t, k);
    std::uint64_t cuts = kSpans - 1;
    for (std::size_t s = 0; s < kSpans; ++s) {
      const auto& net = pieces[kSpans * k + (forward ? s : kSpans - 1 - s)].net;
      shapes_[e][s] = forward ? edge_of<Degree>(net, 0, 1) : edge_of<Degree>(net, 1, 0);
      cuts += count_cuts<Degree>(rule_, shapes_[e][s]);
    }
    first_cut_[e + 1] = cuts;
  }

  void number_edges() {
    first_cut_[0] = terrain_.tin.vertex_count();
    for (std::size_t e = 0; e + 1 < first_cut_.size(); ++e) first_cut_[e + 1] += first_cut_[e];
    check_size(first_cut_.back());
    first_inner_ = static_cast<std::uint32_t>(first_cut_.back());
  }

  void check_size(std::uint64_t triangles) const {
    if (triangles > kMostTriangles)
      throw BadInput(fmt::format("a tolerance of {} makes more than {} triangles: use a larger one", rule_.tolerance,
                                 kMostTriangles));
    check_memory(kProcessMemory + kTriangleBytes * static_cast<double>(triangles),
                 fmt::format("a tolerance of {}, which makes {} triangles or more,", rule_.tolerance, triangles), {});
  }

  void place_corners() {
    const Tin& tin = terrain_.tin;
    mesh_.positions.resize(first_inner_);
    mesh_.normals.resize(first_inner_);
    for (std::size_t v = 0; v < tin.vertex_count(); ++v) {
      mesh_.positions[v] = raised(tin.points[v], tin.heights[v]);
      mesh_.normals[v] = normal_of(terrain_.gradients[v]);
    }
    if (terrain_.creases.empty()) return;
    // A vertex has one normal: on a crease the middle one of its sectors'.
    std::vector<Vec3> sums(tin.vertex_count());
    const auto vertex = sector_vertices(tin, terrain_.corner_gradients, terrain_.gradients.size());
    for (std::size_t n = 0; n < vertex.size(); ++n)
      sums[vertex[n]] = sums[vertex[n]] + normal_of(terrain_.gradients[n]);
    for (std::size_t v = 0; v < sums.size(); ++v)
      if (norm(sums[v]) > 0) mesh_.normals[v] = sums[v] / norm(sums[v]);
  }

  void cut_triangles() {
    context_.report("triangles", 0);
    const std::size_t count = terrain_.tin.triangle_count();
    chunks_.resize((count + kGrain - 1) / kGrain);
    std::atomic<std::uint64_t> made{0};
    parallel_chunks(count, kGrain, context_, [&](std::size_t begin, std::size_t end) {
      Chunk& chunk = chunks_[begin / kGrain];
      Cutter cutter(rule_);
      for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
        cutter.start(first_inner_ + static_cast<std::uint32_t>(chunk.positions.size()));
        cut_triangle(t, cutter);
        store(t, cutter, chunk);
      }
      check_size(made += chunk.triangles.size());
    });
  }

  void cut_triangle(std::uint32_t t, Cutter& cutter) const {
    const Pieces pieces = pieces_of<Degree>(terrain_, edges_, t);
    const auto use_patch = [&](std::size_t piece) {
      const auto& c = pieces[piece].corners;
      cutter.set_patch(pieces[piece].net, c[0], c[1], c[2]);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = terrain_.tin.triangles[t][k];
      cutter.add_vertex(terrain_.tin.points[v], terrain_.tin.heights[v],
                        terrain_.gradients[gradient_of(terrain_, t, k)], v);
    }
    use_patch(0);
    const Vec2 middle = pieces[0].corners[2];
    const std::uint32_t centre =
        cutter.add_vertex(middle, pieces[0].net[static_cast<std::size_t>(ordinate_index(Degree, 0, 0))],
                          cutter.gradient_at(middle, cutter.vertices[0].gradient, cutter.vertices[1].gradient));
    std::array<EdgeUse, 3> spoke;  // from each corner to the centre
    for (std::size_t k = 0; k < 3; ++k) {
      use_patch(kSpans * k);
      const auto corner = static_cast<std::uint32_t>((k + 1) % 3);
      spoke[corner] = cutter.add_edge(corner, centre, edge_of<Degree>(pieces[kSpans * k].net, 0, 2));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      std::array<std::uint32_t, kSpans + 1> stop;  // vertices along the edge, from corner k + 1 to corner k + 2
      std::array<EdgeUse, kSpans> outer;
      add_outer_edge(t, k, pieces, cutter, stop, outer);
      std::array<EdgeUse, kSpans + 1> inward{spoke[(k + 1) % 3]};
      inward.back() = spoke[(k + 2) % 3];
      for (std::size_t s = 1; s < kSpans; ++s) {
        use_patch(kSpans * k + s);
        inward[s] = cutter.add_edge(stop[s], centre, edge_of<Degree>(pieces[kSpans * k + s].net, 0, 2));
      }
      for (std::size_t s = 0; s < kSpans; ++s) {
        use_patch(kSpans * k + s);
        cutter.cut(pieces[kSpans * k + s].net, {stop[s], stop[s + 1], centre},
                   {outer[s], inward[s + 1], inward[s].turned()});
      }
    }
  }

  /// The edge of the TIN opposite corner k with all its cuts, numbered from its lower-index end whichever side asks.
  void add_outer_edge(std::uint32_t t, std::size_t k, const Pieces& pieces, Cutter& cutter,
                      std::array<std::uint32_t, kSpans + 1>& stop, std::array<EdgeUse, kSpans>& outer) const {
    const std::uint32_t e = edges_.of_triangle[t][k];
    const bool forward = ahead(t, k);
    auto id = static_cast<std::uint32_t>(first_cut_[e]);
    stop.front() = static_cast<std::uint32_t>((k + 1) % 3);
    stop.back() = static_cast<std::uint32_t>((k + 2) % 3);
    for (std::size_t s = 0; s < kSpans; ++s) {
      const std::size_t span = forward ? s : kSpans - 1 - s;  // counted from corner k + 1
      const auto& piece = pieces[kSpans * k + span];
      cutter.set_patch(piece.net, piece.corners[0], piece.corners[1], piece.corners[2]);
      const std::size_t from = forward ? span : span + 1, to = forward ? span + 1 : span;
      const bool last = s + 1 == kSpans;
      if (!last) {
        const Vec2 split = piece.corners[forward ? 1 : 0];
        stop[to] = cutter.add_vertex(split, shapes_[e][s].back(),
                                     cutter.gradient_at(split, cutter.vertices[stop[from]].gradient, {}), 0);
      }
      outer[span] = cutter.add_edge(stop[from], stop[to], shapes_[e][s], id);
      if (!forward) outer[span] = outer[span].turned();
      if (!last) cutter.vertices[stop[to]].id = id++;
    }
  }

  /// Vertices on the TIN's edges go to their own places, by the first of the edge's triangles; the others to the chunk.
  void store(std::uint32_t t, const Cutter& cutter, Chunk& chunk) {
    chunk.positions.resize(cutter.next_id() - first_inner_);
    chunk.normals.resize(chunk.positions.size());
    const auto owned = [&](std::uint32_t id) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t e = edges_.of_triangle[t][k];
        if (id >= first_cut_[e] && id < first_cut_[e + 1]) return owns(t, k);
      }
      return false;
    };
    for (const CutVertex& v : cutter.vertices) {
      if (v.id < first_inner_ && !owned(v.id)) continue;
      const bool inner = v.id >= first_inner_;
      (inner ? chunk.positions[v.id - first_inner_] : mesh_.positions[v.id]) = raised(v.point, v.height);
      (inner ? chunk.normals[v.id - first_inner_] : mesh_.normals[v.id]) = normal_of(v.gradient);
    }
    for (const auto& v : cutter.triangles) {
      const CutVertex &a = cutter.vertices[v[0]], &b = cutter.vertices[v[1]], &c = cutter.vertices[v[2]];
      if (terrain_.grid.has_data((a.point + b.point + c.point) / 3)) chunk.triangles.push_back({a.id, b.id, c.id});
    }
  }

  void join_chunks() {
    std::size_t vertices = mesh_.positions.size(), triangles = 0;
    for (const Chunk& c : chunks_) vertices += c.positions.size(), triangles += c.triangles.size();
    if (vertices >= kNone) check_size(kMostTriangles + 1);
    mesh_.positions.reserve(vertices);
    mesh_.normals.reserve(vertices);
    mesh_.triangles.reserve(triangles);
    for (Chunk& c : chunks_) {
      const auto shift = static_cast<std::uint32_t>(mesh_.positions.size()) - first_inner_;
      mesh_.positions.insert(mesh_.positions.end(), c.positions.begin(), c.positions.end());
      mesh_.normals.insert(mesh_.normals.end(), c.normals.begin(), c.normals.end());
      for (auto v : c.triangles) {
        for (std::uint32_t& k : v)
          if (k >= first_inner_) k += shift;
        mesh_.triangles.push_back(v);
      }
      c = Chunk();
    }
  }

  const Terrain& terrain_;
  const Context& context_;
  EdgeTable edges_;
  CutRule<Degree> rule_;
  std::vector<EdgeShape> shapes_;
  std::vector<std::uint64_t> first_cut_;  ///< number of the first vertex inside each edge
  std::uint32_t first_inner_ = 0;         ///< number of the first vertex inside a triangle
  std::vector<Chunk> chunks_;
  TriangleMesh mesh_;
};

}  // namespace

void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<std::uint32_t> place(mesh.positions.size(), kNone);
  for (const auto& v : mesh.triangles)
    for (const std::uint32_t k : v) place[k] = 0;
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == kNone) continue;
    mesh.positions[kept] = mesh.positions[v];
    mesh.normals[kept] = mesh.normals[v];
    place[v] = kept++;
  }
  if (kept == mesh.positions.size()) return;
  mesh.positions.resize(kept);
  mesh.normals.resize(kept);
  for (auto& v : mesh.triangles)
    for (std::uint32_t& k : v) k = place[k];
}

MeshFrame mesh_frame(const Georef& georef) {
  const bool metres = georef.scale_x == 1 && georef.scale_y == 1;
  MeshFrame frame;
  if (metres && !georef.geographic) frame.offset = {georef.origin_x, georef.origin_y, 0};
  frame.unit = georef.unit == "unit" ? "" : georef.unit;
  if (metres) frame.crs_wkt = georef.crs_wkt;
  return frame;
}

double mesh_tolerance(const Terrain& terrain, const TerrainMeshOptions& options) {
  if (terrain.tin.heights.empty()) throw BadInput("a terrain without vertices has no mesh");
  const HeightRange range = height_range(terrain);
  return mesh_tolerance(range.low, range.high, options);
}

double mesh_tolerance(double low, double high, const TerrainMeshOptions& options) {
  const double largest = std::max(std::abs(low), std::abs(high));
  if (!(options.tolerance >= 0) || std::isinf(options.tolerance))
    throw UsageError(fmt::format("a tolerance of {}: give a height greater than 0", options.tolerance));
  if (options.tolerance == 0) return high > low ? (high - low) / 1000 : std::max(largest, 1.0) / 1000;
  if (options.tolerance < 1e-12 * largest)
    throw UsageError(fmt::format("a tolerance of {} is finer than the digits of heights around {}: give a larger one",
                                 options.tolerance, largest));
  return options.tolerance;
}

TriangleMesh mesh_terrain(const Terrain& terrain, const TerrainMeshOptions& options, const Context& context) {
  const double tolerance = mesh_tolerance(terrain, options);
  TriangleMesh mesh;
  switch (terrain.kind) {
    case SurfaceKind::linear:
      mesh = linear_mesh(terrain);
      break;
    case SurfaceKind::powell_sabin:
      mesh = SmoothMesher<2>(terrain, tolerance, context).run();
      break;
    case SurfaceKind::clough_tocher:
      mesh = SmoothMesher<3>(terrain, tolerance, context).run();
      break;
  }
  drop_unused_vertices(mesh);
  const MeshFrame frame = mesh_frame(terrain.georef);
  mesh.offset = frame.offset;
  mesh.unit = frame.unit;
  mesh.crs_wkt = frame.crs_wkt;
  context.report("mesh", 1);
  return mesh;
}

}  // namespace retalho
