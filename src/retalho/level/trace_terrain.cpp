#include "retalho/level/trace_terrain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "retalho/core/parallel.h"
#include "retalho/level/box_tracer.h"
#include "retalho/level/fixed_pieces.h"

namespace retalho {
namespace {

constexpr std::size_t kGrain = 2048;  // triangles a chunk

std::size_t chunk_count(std::size_t triangles) {
  return (triangles + kGrain - 1) / kGrain;
}

template <int N, class Add>
void isolate_edge(const EdgeNet<N, double>& net, const std::array<Vec2, 2>& ends, const FixedLevels& levels,
                  Trace& trace, const Add& add) {
  const auto [low, high] = std::minmax_element(net.begin(), net.end());
  const int first = levels.at_most(*low), last = levels.at_most(*high);
  for (int k = first; k < last; ++k)
    isolate_roots<N, double>(
        net, levels.threshold(k), 0, kOrdinateBits,
        [&](double t) {
          add(EdgeRoot{k, trace.add(ends[0] + t * (ends[1] - ends[0]), k)});
        },
        [&](double t0, double t1) {
          trace.leave_undecided(k, ends[0] + t0 * (ends[1] - ends[0]), ends[0] + t1 * (ends[1] - ends[0]));
        });
}

/// Does the triangle see its edge k from the lower-index end to the other?
bool forward(const Terrain& terrain, std::uint32_t triangle, int k) {
  const auto& corner = terrain.tin.triangles[triangle];
  return corner[static_cast<std::size_t>((k + 1) % 3)] < corner[static_cast<std::size_t>((k + 2) % 3)];
}

/// The ends of a half of an edge, out of the edge's own two vertices: the same bits whichever triangle asks, also where
/// the two lie in different tiles.
template <class Topology>
std::array<Vec2, 2> half_ends(const Terrain& terrain, const EdgeTable& edges, std::uint32_t edge, int half) {
  const Vec2 low = terrain.tin.points[edges.vertices[edge][0]], high = terrain.tin.points[edges.vertices[edge][1]];
  if constexpr (Topology::kHalves == 1) return {low, high};
  const Vec2 split = low + terrain.edge_split[edge] * (high - low);
  return half == 0 ? std::array<Vec2, 2>{low, split} : std::array<Vec2, 2>{split, high};
}

/// A chunk's lists of the halves that it owns, in the order of triangles, edges and (canonical) halves.
struct OwnedHalf {
  std::uint32_t half;   ///< halves * edge + half
  std::uint32_t count;  ///< of roots
};
struct EdgeChunk {
  Trace trace;
  std::vector<OwnedHalf> halves;
  std::vector<EdgeRoot> roots;
};

template <SurfaceKind Kind>
Trace trace_edges(const Terrain& terrain, const EdgeTable& edges, double per_unit, const FixedLevels& levels,
                  OuterRoots& outer, const Context& context) {
  using Pieces = FixedPieces<Kind>;
  using Topology = typename Pieces::Topology;
  const std::size_t triangles = terrain.tin.triangle_count();
  std::vector<EdgeChunk> chunks(chunk_count(triangles));
  parallel_chunks(triangles, kGrain, context, [&](std::size_t from, std::size_t to) {
    EdgeChunk& chunk = chunks[from / kGrain];
    for (auto t = static_cast<std::uint32_t>(from); t < to; ++t) {
      const Pieces pieces(terrain, edges, t, per_unit);
      if (levels.at_most(pieces.low) >= levels.at_most(pieces.high)) continue;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t e = edges.of_triangle[t][static_cast<std::size_t>(k)];
        if (edges.triangles[e][0] != t) continue;
        const bool along = forward(terrain, t, k);
        for (int half = 0; half < Topology::kHalves; ++half) {
          // The canonical half is seen as the other one, backwards, by a triangle that runs against the edge.
          const InnerEdge place = Topology::outer(k, along ? half : Topology::kHalves - 1 - half);
          auto net =
              Pieces::Patch::template edge<double>(pieces.nets[static_cast<std::size_t>(place.piece)], place.side);
          if (!along) std::reverse(net.begin(), net.end());
          const std::size_t before = chunk.roots.size();
          isolate_edge<Topology::kDegree>(net, half_ends<Topology>(terrain, edges, e, half), levels, chunk.trace,
                                          [&](const EdgeRoot& r) { chunk.roots.push_back(r); });
          if (chunk.roots.size() > before)
            chunk.halves.push_back(
                {static_cast<std::uint32_t>(Topology::kHalves) * e + static_cast<std::uint32_t>(half),
                 static_cast<std::uint32_t>(chunk.roots.size() - before)});
          chunk.trace.cell.resize(chunk.trace.points.size(), t);
        }
      }
    }
  });
  outer.halves = Topology::kHalves;
  outer.start.assign(edges.vertices.size() * static_cast<std::size_t>(Topology::kHalves) + 1, 0);
  for (const EdgeChunk& c : chunks)
    for (const OwnedHalf& h : c.halves) outer.start[h.half + 1] = h.count;
  for (std::size_t i = 1; i < outer.start.size(); ++i) outer.start[i] += outer.start[i - 1];
  outer.roots.resize(outer.start.back());
  Trace all;
  for (EdgeChunk& c : chunks) {
    const auto offset = static_cast<std::uint32_t>(all.points.size());
    std::size_t read = 0;
    for (const OwnedHalf& h : c.halves)
      for (std::uint32_t i = 0; i < h.count; ++i) {
        const EdgeRoot& r = c.roots[read++];
        outer.roots[outer.start[h.half] + i] = {r.level, r.point + offset};
      }
    all.points.insert(all.points.end(), c.trace.points.begin(), c.trace.points.end());
    all.level.insert(all.level.end(), c.trace.level.begin(), c.trace.level.end());
    all.cell.insert(all.cell.end(), c.trace.cell.begin(), c.trace.cell.end());
    all.singular.insert(all.singular.end(), c.trace.singular.begin(), c.trace.singular.end());
    all.undecided_edges += c.trace.undecided_edges;
    c = EdgeChunk{};
  }
  all.next.assign(all.points.size(), kNoPoint);
  return all;
}

struct PieceChunk {
  Trace trace;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> copies;  ///< (local point, point on a TIN edge)
};

template <SurfaceKind Kind>
class ChunkTracer {
 public:
  using Pieces = FixedPieces<Kind>;
  using Topology = typename Pieces::Topology;

  ChunkTracer(const Terrain& terrain, const EdgeTable& edges, const FixedLevels& levels, double tolerance,
              const Trace& edge_trace, const OuterRoots& outer, PieceChunk& chunk)
      : terrain_(terrain),
        edges_(edges),
        levels_(levels),
        edge_trace_(edge_trace),
        outer_(outer),
        chunk_(chunk),
        boxes_(levels, tolerance, false, chunk.trace) {}

  void trace(std::uint32_t t, double per_unit) {
    const Pieces pieces(terrain_, edges_, t, per_unit);
    if (levels_.at_most(pieces.low) >= levels_.at_most(pieces.high)) return;
    load_outer(t);
    for (std::size_t e = 0; e < Topology::kInner; ++e) {
      inner_[e].clear();
      const InnerEdge& place = Topology::kInnerEdges[e];
      const auto piece = static_cast<std::size_t>(place.piece);
      isolate_edge<Topology::kDegree>(Pieces::Patch::template edge<double>(pieces.nets[piece], place.side),
                                      Pieces::Patch::ends(pieces.frames[piece], place.side), levels_, chunk_.trace,
                                      [&](const EdgeRoot& r) { inner_[e].push_back(r); });
    }
    for (std::size_t p = 0; p < Topology::kPieces; ++p) {
      std::array<std::span<const EdgeRoot>, 3> lists;
      std::array<bool, 3> reversed{};
      for (std::size_t s = 0; s < 3; ++s) {
        const PieceSide& side = Topology::kSides[p][s];
        const auto index = static_cast<std::size_t>(side.index);
        lists[s] = side.outer ? outer_lists_[index][static_cast<std::size_t>(side.half)] : inner_[index];
        reversed[s] = side.outer ? !forward(terrain_, t, side.index) : side.reversed;
      }
      boxes_.trace_patch(pieces.nets[p], pieces.frames[p], lists, reversed);
    }
    chunk_.trace.cell.resize(chunk_.trace.points.size(), t);
  }

 private:
  /// Copies the roots on the triangle's outer edges into the chunk's own trace.
  void load_outer(std::uint32_t t) {
    for (int k = 0; k < 3; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const std::size_t first = static_cast<std::size_t>(Topology::kHalves) * edges_.of_triangle[t][index];
      const bool along = forward(terrain_, t, k);
      for (int half = 0; half < Topology::kHalves; ++half) {
        std::vector<EdgeRoot>& list = outer_lists_[index][static_cast<std::size_t>(half)];
        list.clear();
        const std::size_t canonical = first + static_cast<std::size_t>(along ? half : Topology::kHalves - 1 - half);
        for (std::uint32_t i = outer_.start[canonical]; i < outer_.start[canonical + 1]; ++i) {
          const EdgeRoot& r = outer_.roots[i];
          const std::uint32_t local = chunk_.trace.add(edge_trace_.points[r.point], r.level);
          chunk_.copies.emplace_back(local, r.point);
          list.push_back({r.level, local});
        }
      }
    }
  }

  const Terrain& terrain_;
  const EdgeTable& edges_;
  const FixedLevels& levels_;
  const Trace& edge_trace_;
  const OuterRoots& outer_;
  PieceChunk& chunk_;
  BoxTracer<typename Pieces::Patch> boxes_;
  std::array<std::array<std::vector<EdgeRoot>, 2>, 3> outer_lists_;
  std::array<std::vector<EdgeRoot>, 6> inner_;
};

/// Appends a chunk's own points; its copies of edge roots become the roots themselves.
void append(Trace& all, PieceChunk& chunk) {
  Trace& c = chunk.trace;
  std::vector<std::uint32_t> joined(c.points.size(), kNoPoint);
  for (const auto& [local, root] : chunk.copies) joined[local] = root;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    if (joined[i] != kNoPoint) continue;
    joined[i] = all.add(c.points[i], c.level[i]);
    all.cell.push_back(c.cell[i]);
  }
  for (std::size_t i = 0; i < joined.size(); ++i)
    if (c.next[i] != kNoPoint) {
      all.next[joined[i]] = joined[c.next[i]];
      if (all.keep_conics) all.conics[joined[i]] = c.conics[i];
    }
  all.singular.insert(all.singular.end(), c.singular.begin(), c.singular.end());
  all.pairs += c.pairs;
  all.certified += c.certified;
  all.boxes += c.boxes;
  all.undecided_edges += c.undecided_edges;
  all.depth = std::max(all.depth, c.depth);
  chunk = PieceChunk{};
}

template <SurfaceKind Kind>
Trace trace_kind(const Terrain& terrain, const EdgeTable& edges, double per_unit, const FixedLevels& levels,
                 double tolerance, OuterRoots& outer, const Context& context, bool conics) {
  Trace all = trace_edges<Kind>(terrain, edges, per_unit, levels, outer, context);
  all.keep_conics = conics;
  if (conics) all.conics.resize(all.points.size());
  const std::size_t triangles = terrain.tin.triangle_count();
  std::vector<PieceChunk> chunks(chunk_count(triangles));
  parallel_chunks(triangles, kGrain, context, [&](std::size_t from, std::size_t to) {
    chunks[from / kGrain].trace.keep_conics = conics;
    ChunkTracer<Kind> tracer(terrain, edges, levels, tolerance, all, outer, chunks[from / kGrain]);
    for (auto t = static_cast<std::uint32_t>(from); t < to; ++t) tracer.trace(t, per_unit);
  });
  for (PieceChunk& chunk : chunks) append(all, chunk);
  return all;
}

}  // namespace

double terrain_quanta(const Terrain& terrain, const EdgeTable& edges, const Context& context) {
  const std::size_t triangles = terrain.tin.triangle_count();
  std::vector<double> largest(chunk_count(triangles), 0);
  parallel_chunks(triangles, kGrain, context, [&](std::size_t from, std::size_t to) {
    double m = 0;
    std::array<TerrainPatch, 6> pieces;
    for (auto t = static_cast<std::uint32_t>(from); t < to; ++t) {
      const int n = triangle_patches(terrain, edges, t, pieces);
      for (int p = 0; p < n; ++p) {
        const TerrainPatch& piece = pieces[static_cast<std::size_t>(p)];
        for (int i = 0; i < ordinate_count(piece.degree); ++i)
          m = std::max(m, std::abs(piece.ordinates[static_cast<std::size_t>(i)]));
      }
    }
    largest[from / kGrain] = m;
  });
  double size = 0;
  for (const double m : largest) size = std::max(size, m);
  return quanta_per_unit(size);
}

Trace trace_terrain(const Terrain& terrain, const EdgeTable& edges, double per_unit, const FixedLevels& levels,
                    double tolerance, OuterRoots& outer, const Context& context, bool conics) {
  switch (terrain.kind) {
    case SurfaceKind::powell_sabin:
      return trace_kind<SurfaceKind::powell_sabin>(terrain, edges, per_unit, levels, tolerance, outer, context, conics);
    case SurfaceKind::clough_tocher:
      return trace_kind<SurfaceKind::clough_tocher>(terrain, edges, per_unit, levels, tolerance, outer, context,
                                                    conics);
    case SurfaceKind::linear:
      break;
  }
  return trace_kind<SurfaceKind::linear>(terrain, edges, per_unit, levels, tolerance, outer, context, conics);
}

}  // namespace retalho
