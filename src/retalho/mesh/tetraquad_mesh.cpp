#include "retalho/mesh/tetraquad_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr std::array<std::array<std::size_t, 3>, 6> kPaths = {
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

/// A tetrahedron cut into divisions^3 parts (edgewise subdivision): every face is cut into equal triangles, so that
/// neighbours match however their corners are numbered.
struct Lattice {
  std::vector<std::array<int, 4>> nodes;            ///< parts of `divisions` at the four corners
  std::vector<std::array<std::uint32_t, 4>> parts;  ///< by node
  std::vector<char> mirrored;                       ///< of each part: turned against the whole

  explicit Lattice(int divisions) {
    const auto at = [divisions](const std::array<int, 3>& y) {
      const auto side = static_cast<std::size_t>(divisions + 1);
      return (static_cast<std::size_t>(y[0]) * side + static_cast<std::size_t>(y[1])) * side +
             static_cast<std::size_t>(y[2]);
    };
    const auto inside = [divisions](const std::array<int, 3>& y) {
      return divisions >= y[0] && y[0] >= y[1] && y[1] >= y[2] && y[2] >= 0;
    };
    std::vector<std::uint32_t> number(at({divisions, divisions, divisions}) + 1, 0);
    std::vector<std::array<int, 3>> places;
    for (int a = 0; a <= divisions; ++a)
      for (int b = 0; b <= a; ++b)
        for (int c = 0; c <= b; ++c) {
          number[at({a, b, c})] = static_cast<std::uint32_t>(nodes.size());
          nodes.push_back({divisions - a, a - b, b - c, c});
          places.push_back({a, b, c});
        }
    for (const auto& place : places)
      for (const auto& path : kPaths) {
        std::array<int, 3> y = place;
        std::array<std::uint32_t, 4> part = {number[at(y)], 0, 0, 0};
        bool whole = true;
        for (std::size_t n = 0; n < 3 && whole; ++n) {
          ++y[path[n]];
          whole = inside(y);
          if (whole) part[n + 1] = number[at(y)];
        }
        if (!whole) continue;
        parts.push_back(part);
        mirrored.push_back(is_mirrored(part));
      }
  }

 private:
  bool is_mirrored(const std::array<std::uint32_t, 4>& part) const {
    const auto way = [&](std::size_t to, std::size_t d) { return nodes[part[to]][d] - nodes[part[0]][d]; };
    return way(1, 1) * (way(2, 2) * way(3, 3) - way(2, 3) * way(3, 2)) -
               way(1, 2) * (way(2, 1) * way(3, 3) - way(2, 3) * way(3, 1)) +
               way(1, 3) * (way(2, 1) * way(3, 2) - way(2, 2) * way(3, 1)) <
           0;
  }
};

/// 64 bits from two numbers, well mixed.
struct PairHash {
  std::size_t operator()(const std::pair<std::uint32_t, std::uint32_t>& p) const {
    std::uint64_t h = (static_cast<std::uint64_t>(p.first) << 32 | p.second) * 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};
struct NodeHash {
  std::size_t operator()(const LatticePoint& p) const {
    std::uint64_t h = static_cast<std::uint32_t>(p[0]) * 0x9E3779B97F4A7C15U;
    h = (h ^ (h >> 31) ^ static_cast<std::uint32_t>(p[1])) * 0xBF58476D1CE4E5B9U;
    h = (h ^ (h >> 29) ^ static_cast<std::uint32_t>(p[2])) * 0x94D049BB133111EBU;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};

TetBarycentric blend(const TetBarycentric& a, const TetBarycentric& b, double t) {
  TetBarycentric r{};
  for (std::size_t i = 0; i < 4; ++i) r[i] = (1 - t) * a[i] + t * b[i];
  return r;
}

/// Where the cubic changes its sign between a and b, where it has the values fa and fb: a bracketed secant (Illinois).
double root_between(const TetCubic& c, const TetBarycentric& a, const TetBarycentric& b, double fa, double fb) {
  double low = 0, high = 1, t = fa / (fa - fb);
  for (int n = 0; n < 60 && high - low > 1e-13; ++n) {
    t = std::clamp((low * fb - high * fa) / (fb - fa), low, high);
    const double f = evaluate(c, blend(a, b, t));
    if (f == 0) break;
    const bool with_low = (f < 0) == (fa < 0);
    if (with_low) {
      if (t == low) break;
      low = t;
      fa = f;
      fb /= 2;
    } else {
      if (t == high) break;
      high = t;
      fb = f;
      fa /= 2;
    }
    if (n % 4 == 3) {  // never slower than halving
      const double middle = (low + high) / 2, g = evaluate(c, blend(a, b, middle));
      if ((g < 0) == (fa < 0)) {
        low = middle;
        fa = g;
      } else {
        high = middle;
        fb = g;
      }
      if (fa == fb) break;
    }
  }
  constexpr double margin = 1e-7;  // an edge's root at its end would make triangles without an area
  return std::clamp(t, margin, 1 - margin);
}

class Marcher {
 public:
  Marcher(const TetraQuadField& field, int divisions) : field_(field), lattice_(divisions), divisions_(divisions) {}

  TriangleMesh run(const Context& context) {
    const TetMesh& tets = field_.surface().mesh;
    // A cut tetrahedron's work grows with the cube of the divisions.
    const auto parts = static_cast<std::size_t>(divisions_);
    const std::size_t every = std::max<std::size_t>(1, 1024 / (parts * parts * parts));
    for (std::size_t t = 0; t < tets.tets.size(); ++t) {
      if (t % every == 0) context.check();
      const TetCubic& c = field_.ordinates(t);
      const auto [low, high] = bounds(c);
      const double rounding = 1e-13 * std::max(-low, high);  // neighbours must not disagree about a shared face
      if (low > rounding || high < -rounding) continue;
      cut(t);
    }
    const Georef& georef = field_.surface().georef;
    const bool shifted_only = !georef.geographic && georef.scale_x == 1 && georef.scale_y == 1;
    if (shifted_only) mesh_.offset = {georef.origin_x, georef.origin_y, 0};
    return std::move(mesh_);
  }
  double deviation() const { return deviation_; }

 private:
  struct Node {
    std::uint32_t number;
    double value;
    TetBarycentric b;
  };

  void cut(std::size_t t) {
    const TetMesh& tets = field_.surface().mesh;
    const TetCorners& corners = tets.tets[t];
    here_.clear();
    for (const auto& parts : lattice_.nodes) {
      LatticePoint key{};
      Node node{};
      for (std::size_t i = 0; i < 4; ++i) {
        node.b[i] = static_cast<double>(parts[i]) / divisions_;
        for (std::size_t d = 0; d < 3; ++d) key[d] += parts[i] * tets.lattice[corners[i]][d];
      }
      const auto [at, fresh] = nodes_.try_emplace(key, static_cast<std::uint32_t>(values_.size()));
      if (fresh) values_.push_back(evaluate(field_.ordinates(t), node.b));
      node.number = at->second;
      node.value = values_[at->second];
      here_.push_back(node);
    }
    for (std::size_t n = 0; n < lattice_.parts.size(); ++n)
      cut_part(t, lattice_.parts[n], (field_.frame(t).volume6 < 0) != (lattice_.mirrored[n] != 0));
  }

  void cut_part(std::size_t t, const std::array<std::uint32_t, 4>& part, bool mirrored) {
    std::array<const Node*, 4> inside{}, outside{};
    std::size_t in = 0, out = 0;
    for (const std::uint32_t n : part) {
      const bool is_inside = here_[n].value < 0;
      // Sorting the corners, inside first, exchanges it with the outside ones before it.
      if (is_inside && out % 2 != 0) mirrored = !mirrored;
      (is_inside ? inside[in++] : outside[out++]) = &here_[n];
    }
    if (in == 1) {
      triangle(t,
               {edge(t, *inside[0], *outside[0]), edge(t, *inside[0], *outside[1]), edge(t, *inside[0], *outside[2])},
               mirrored);
    } else if (in == 3) {
      triangle(t,
               {edge(t, *inside[0], *outside[0]), edge(t, *inside[1], *outside[0]), edge(t, *inside[2], *outside[0])},
               mirrored);
    } else if (in == 2) {
      const std::uint32_t a = edge(t, *inside[0], *outside[0]), b = edge(t, *inside[0], *outside[1]),
                          c = edge(t, *inside[1], *outside[1]), d = edge(t, *inside[1], *outside[0]);
      triangle(t, {a, b, c}, mirrored);
      triangle(t, {a, c, d}, mirrored);
    }
  }

  /// The vertex on the edge between two nodes of different signs.
  std::uint32_t edge(std::size_t t, const Node& a, const Node& b) {
    const Node& first = a.number < b.number ? a : b;
    const Node& second = a.number < b.number ? b : a;
    const auto [at, fresh] =
        edges_.try_emplace({first.number, second.number}, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (fresh) {
      const double r = root_between(field_.ordinates(t), first.b, second.b, first.value, second.value);
      const TetBarycentric b4 = blend(first.b, second.b, r);
      Vec3 p{};
      for (std::size_t i = 0; i < 4; ++i)
        p = p + b4[i] * field_.surface().mesh.position(field_.surface().mesh.tets[t][i]);
      const Vec3 g = field_.gradient(t, b4).gradient;
      const double length = norm(g);
      mesh_.positions.push_back(p);
      mesh_.normals.push_back(length > 0 ? g / length : Vec3{0, 0, 1});
    }
    return at->second;
  }

  /// Counter-clockwise from outside, by the corners' order alone.
  void triangle(std::size_t t, std::array<std::uint32_t, 3> v, bool mirrored) {
    if (mirrored) std::swap(v[1], v[2]);
    const Vec3 a = mesh_.positions[v[0]], b = mesh_.positions[v[1]], c = mesh_.positions[v[2]];
    mesh_.triangles.push_back(v);
    const Vec3 origin = field_.surface().mesh.origin;
    const double step = field_.surface().mesh.step;
    for (const Vec3 p : {(a + b + c) / 3, (a + b) / 2, (b + c) / 2, (c + a) / 2}) {
      const Jet3 jet = field_.gradient(t, field_.frame(t).barycentric((p - origin) / step));
      deviation_ = std::max(deviation_, std::abs(jet.value) / std::max(norm(jet.gradient), 1e-3));
    }
  }

  const TetraQuadField& field_;
  Lattice lattice_;
  int divisions_;
  TriangleMesh mesh_;
  std::unordered_map<LatticePoint, std::uint32_t, NodeHash> nodes_;
  std::vector<double> values_;
  std::unordered_map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t, PairHash> edges_;
  std::vector<Node> here_;
  double deviation_ = 0;
};

}  // namespace

TriangleMesh mesh_tetraquad(const TetraQuadField& field, const TetraQuadMeshOptions& options, TetraQuadMeshNotes* notes,
                            const Context& context) {
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    throw UsageError("the tolerance must be 0 or more", {}, "--tolerance");
  if (options.divisions < 0 || options.divisions > 16)
    throw UsageError("divisions of a tetrahedron's edge: 1 to 16, or 0", {}, "--divisions");
  TetraQuadMeshNotes found;
  TriangleMesh mesh;
  const auto march = [&](int divisions) {
    Marcher marcher(field, divisions);
    mesh = marcher.run(context);
    found.divisions = divisions;
    found.deviation = marcher.deviation();
  };
  if (options.divisions > 0 || options.tolerance == 0) {
    march(options.divisions > 0 ? options.divisions : 3);
  } else {
    for (const int divisions : {1, 2, 3, 4, 6, 8, 12, 16}) {
      march(divisions);
      if (found.deviation <= options.tolerance) break;
    }
  }
  if (notes != nullptr) *notes = found;
  return mesh;
}

MeshTopology topology_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.positions.size()), loop(mesh.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  loop = parent;
  const auto root = [](std::vector<std::uint32_t>& tree, std::uint32_t v) {
    while (tree[v] != v) v = tree[v] = tree[tree[v]];
    return v;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  std::vector<char> used(mesh.positions.size(), 0), on_border(mesh.positions.size(), 0);
  for (const auto& t : mesh.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      edges.emplace_back(std::min(a, b), std::max(a, b));
      parent[root(parent, a)] = root(parent, b);
      used[a] = 1;
    }
  std::sort(edges.begin(), edges.end());
  MeshTopology topology;
  std::int64_t count = 0;
  for (std::size_t n = 0, end = 0; n < edges.size(); n = end) {
    while (end < edges.size() && edges[end] == edges[n]) ++end;
    ++count;
    if (end - n != 1) continue;
    ++topology.open_edges;
    loop[root(loop, edges[n].first)] = root(loop, edges[n].second);
    on_border[edges[n].first] = on_border[edges[n].second] = 1;
  }
  std::int64_t vertices = 0;
  for (std::uint32_t v = 0; v < parent.size(); ++v) {
    vertices += used[v];
    if (used[v] != 0 && root(parent, v) == v) ++topology.components;
    if (on_border[v] != 0 && root(loop, v) == v) ++topology.borders;
  }
  const std::int64_t euler = vertices - count + static_cast<std::int64_t>(mesh.triangles.size());
  topology.genus =
      (2 * static_cast<std::int64_t>(topology.components) - euler - static_cast<std::int64_t>(topology.borders)) / 2;
  return topology;
}

}  // namespace retalho
