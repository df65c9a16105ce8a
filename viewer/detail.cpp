#include "detail.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "retalho/core/parallel.h"

namespace retalho::viewer {
namespace {

constexpr int kMostPieces = 64;   // along an edge
constexpr double kBehind = 1000;  // times the error is allowed where no one looks

/// The distance of `p` from the segment a b.
double distance_to(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 way = b - a;
  const double length2 = norm2(way);
  const double t = length2 > 0 ? std::clamp(dot(p - a, way) / length2, 0.0, 1.0) : 0.0;
  return norm(p - (a + t * way));
}

/// Pieces that bring an error of `bend` down to `allowed`: it falls with their square.
int pieces_for(double bend, double allowed) {
  int n = 1;
  while (n < kMostPieces && bend > allowed * n * n) n *= 2;
  return n;
}

/// Which of an edge's `coarse` pieces' ends the place `i` of `fine` falls onto: the nearest.
int snapped(int i, int fine, int coarse) {
  const int each = fine / coarse;
  return (i + each / 2) / each;
}

class Cutter {
 public:
  Cutter(const TerrainEvaluator& evaluator, const SurfaceBends& bends, const DetailOptions& options)
      : evaluator_(evaluator), tin_(evaluator.terrain().tin), edges_(evaluator.edges()), bends_(bends) {
    const auto place = [&](std::uint32_t v) {
      return Vec3{tin_.points[v].x, tin_.points[v].y, options.stretch * tin_.heights[v]};
    };
    const auto behind = [&](Vec3 p) { return dot(p - options.eye, options.forward) < 0; };
    // What is nearer than this is as near as this: an eye in the surface must not ask for everything.
    edge_allowed_.reserve(edges_.vertices.size());
    for (const auto& [a, b] : edges_.vertices) {
      const Vec3 from = place(a), to = place(b);
      const double near = 1e-3 * norm(to - from), unseen = behind(from) && behind(to) ? kBehind : 1;
      edge_allowed_.push_back(unseen * std::max(near, distance_to(options.eye, from, to)) / options.stretch);
    }
    centre_allowed_.reserve(tin_.triangle_count());
    for (const auto& v : tin_.triangles) {
      const Vec3 a = place(v[0]), b = place(v[1]), c = place(v[2]);
      const double near = 1e-3 * norm(b - a), unseen = behind(a) && behind(b) && behind(c) ? kBehind : 1;
      centre_allowed_.push_back(unseen * std::max(near, norm(options.eye - (a + b + c) / 3)) / options.stretch);
    }
  }

  /// Decides the levels for `angle`; the number of triangles that they make.
  std::size_t set_levels(double angle) {
    edge_pieces_.resize(edges_.vertices.size());
    for (std::size_t e = 0; e < edge_pieces_.size(); ++e)
      edge_pieces_[e] =
          static_cast<std::uint8_t>(pieces_for(static_cast<double>(bends_.edges[e]), angle * edge_allowed_[e]));
    pieces_.resize(tin_.triangle_count());
    std::size_t count = 0;
    for (std::size_t t = 0; t < pieces_.size(); ++t) {
      const auto& e = edges_.of_triangle[t];
      const double allowed =
          angle * std::min({centre_allowed_[t], edge_allowed_[e[0]], edge_allowed_[e[1]], edge_allowed_[e[2]]});
      int n = pieces_for(static_cast<double>(bends_.triangles[t]), allowed);
      for (const std::uint32_t edge : e) n = std::max(n, static_cast<int>(edge_pieces_[edge]));
      pieces_[t] = static_cast<std::uint8_t>(n);
      count += static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
    }
    return count;
  }

  TriangleMesh run(const Context& context) {
    first_on_edge_.resize(edge_pieces_.size());
    std::size_t vertices = tin_.vertex_count();
    for (std::size_t e = 0; e < edge_pieces_.size(); ++e) {
      first_on_edge_[e] = static_cast<std::uint32_t>(vertices);
      vertices += static_cast<std::size_t>(edge_pieces_[e] - 1);
    }
    mesh_.positions.resize(vertices);
    mesh_.normals.resize(vertices);
    for (std::size_t e = 0; e < edge_pieces_.size(); ++e) place_edge(e);
    for (std::uint32_t t = 0; t < pieces_.size(); ++t) {
      if (t % 4096 == 0) context.check();
      cut(t);
    }
    return std::move(mesh_);
  }

  void note(DetailNotes& notes) const {
    notes.finest = pieces_.empty() ? 1 : *std::max_element(pieces_.begin(), pieces_.end());
    notes.cut = static_cast<std::size_t>(std::count_if(pieces_.begin(), pieces_.end(), [](int n) { return n > 1; }));
  }

 private:
  void put(std::size_t id, std::uint32_t triangle, Vec2 p) {
    const Jet jet = evaluator_.jet_in(triangle, p);
    mesh_.positions[id] = {p.x, p.y, jet.value};
    mesh_.normals[id] = normalized(Vec3{-jet.gradient.x, -jet.gradient.y, 1});
  }

  /// From the end with the lower index, by the first of its triangles.
  void place_edge(std::size_t e) {
    const auto [a, b] = edges_.vertices[e];
    const std::uint32_t triangle = edges_.triangles[e][0];
    const int n = edge_pieces_[e];
    for (const std::uint32_t end : {a, b}) {
      put(end, triangle, tin_.points[end]);
      mesh_.positions[end].z = tin_.heights[end];
    }
    for (int k = 1; k < n; ++k)
      put(first_on_edge_[e] + static_cast<std::size_t>(k - 1), triangle,
          tin_.points[a] + (static_cast<double>(k) / n) * (tin_.points[b] - tin_.points[a]));
  }

  /// The vertex at place k of n along the edge opposite to `corner`, counted from corner + 1.
  std::uint32_t on_edge(std::uint32_t t, std::size_t corner, int k, int n) const {
    const std::uint32_t e = edges_.of_triangle[t][corner];
    const std::uint32_t from = tin_.triangles[t][(corner + 1) % 3], to = tin_.triangles[t][(corner + 2) % 3];
    const int pieces = edge_pieces_[e];
    // Counted from the lower end, so that both triangles of the edge fall onto the same vertices.
    const int at = from < to ? snapped(k, n, pieces) : pieces - snapped(k, n, pieces);
    if (at == 0) return std::min(from, to);
    if (at == pieces) return std::max(from, to);
    return first_on_edge_[e] + static_cast<std::uint32_t>(at - 1);
  }

  void cut(std::uint32_t t) {
    const auto& corners = tin_.triangles[t];
    const std::array<Vec2, 3> c{tin_.points[corners[0]], tin_.points[corners[1]], tin_.points[corners[2]]};
    const int n = pieces_[t];
    const auto point = [&](double i, double j) {  // i steps to corner 1, j to corner 2
      return c[0] + (i / n) * (c[1] - c[0]) + (j / n) * (c[2] - c[0]);
    };
    ids_.clear();
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i + j <= n; ++i) {
        if (j == 0)
          ids_.push_back(on_edge(t, 2, i, n));
        else if (i + j == n)
          ids_.push_back(on_edge(t, 0, j, n));
        else if (i == 0)
          ids_.push_back(on_edge(t, 1, n - j, n));
        else {
          ids_.push_back(static_cast<std::uint32_t>(mesh_.positions.size()));
          mesh_.positions.emplace_back();
          mesh_.normals.emplace_back();
          put(ids_.back(), t, point(i, j));
        }
      }
    const auto row = [n](int j) { return j * (2 * n + 3 - j) / 2; };
    const auto id = [&](int i, int j) { return ids_[static_cast<std::size_t>(row(j) + i)]; };
    const auto& grid = evaluator_.terrain().grid;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t d, Vec2 middle) {
      if (a != b && b != d && d != a && grid.has_data(middle)) mesh_.triangles.push_back({a, b, d});
    };
    const double third = 1.0 / 3;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i + j < n; ++i) {
        add(id(i, j), id(i + 1, j), id(i, j + 1), point(i + third, j + third));
        if (i + j + 1 < n) add(id(i + 1, j), id(i + 1, j + 1), id(i, j + 1), point(i + 2 * third, j + 2 * third));
      }
  }

  const TerrainEvaluator& evaluator_;
  const Tin& tin_;
  const EdgeTable& edges_;
  const SurfaceBends& bends_;
  std::vector<double> edge_allowed_, centre_allowed_;  // height that an error of the whole angle 1 may have
  std::vector<std::uint8_t> edge_pieces_, pieces_;
  std::vector<std::uint32_t> first_on_edge_, ids_;
  TriangleMesh mesh_;
};

}  // namespace

SurfaceBends measure_bends(const TerrainEvaluator& evaluator, const Context& context) {
  const Tin& tin = evaluator.terrain().tin;
  const EdgeTable& edges = evaluator.edges();
  SurfaceBends bends{std::vector<float>(edges.vertices.size()), std::vector<float>(tin.triangle_count())};
  if (evaluator.terrain().kind == SurfaceKind::linear) return bends;
  const auto along = [](const Jet& jet, Vec2 d) {
    return std::abs(jet.xx * d.x * d.x + 2 * jet.xy * d.x * d.y + jet.yy * d.y * d.y);
  };
  parallel_chunks(edges.vertices.size(), 1024, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t e = begin; e < end; ++e) {
      const Vec2 a = tin.points[edges.vertices[e][0]], way = tin.points[edges.vertices[e][1]] - a;
      double most = 0;
      for (const double s : {0.0, 0.25, 0.5, 0.75, 1.0})
        most = std::max(most, along(evaluator.jet_in(edges.triangles[e][0], a + s * way), way));
      bends.edges[e] = static_cast<float>(most / 8);
    }
  });
  parallel_chunks(tin.triangle_count(), 1024, context, [&](std::size_t begin, std::size_t end) {
    for (auto t = static_cast<std::uint32_t>(begin); t < end; ++t) {
      const auto& v = tin.triangles[t];
      const std::array<Vec2, 3> c{tin.points[v[0]], tin.points[v[1]], tin.points[v[2]]};
      const Vec2 centre = (c[0] + c[1] + c[2]) / 3;
      double most = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        // The part between two corners and the centre: near its three corners, inside of it.
        const Vec2 from = c[k], to = c[(k + 1) % 3], middle = (from + to + centre) / 3;
        for (const Vec2 corner : {from, to, centre}) {
          const Jet jet = evaluator.jet_in(t, 0.96 * corner + 0.04 * middle);
          for (std::size_t i = 0; i < 3; ++i) most = std::max(most, along(jet, c[(i + 1) % 3] - c[i]));
        }
      }
      bends.triangles[t] = static_cast<float>(most / 6);
    }
  });
  return bends;
}

TriangleMesh detail_mesh(const TerrainEvaluator& evaluator, const SurfaceBends& bends, const DetailOptions& options,
                         DetailNotes* notes, const Context& context) {
  Cutter cutter(evaluator, bends, options);
  double angle = options.angle;
  if (cutter.set_levels(angle) > options.budget) {
    // The number of triangles falls as the angle grows: the smallest angle within the budget, to 2 %.
    double low = std::log(angle), high = low + 30;
    while (high - low > 0.02) {
      context.check();
      const double middle = 0.5 * (low + high);
      (cutter.set_levels(std::exp(middle)) > options.budget ? low : high) = middle;
    }
    angle = std::exp(high);
    cutter.set_levels(angle);
  }
  if (notes) {
    notes->angle = angle;
    cutter.note(*notes);
  }
  return cutter.run(context);
}

}  // namespace retalho::viewer
