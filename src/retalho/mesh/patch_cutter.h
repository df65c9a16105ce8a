// One triangle of a TIN as flat triangles: its patches are cut along edges only (edge_cuts.h), each piece by the edges
// of it that are cut, so that pieces always meet vertex to vertex. Internal to the room.
//
//   cut edges   pieces
//           0   1, or 3 around the centroid where the patch still bulges between its edges (cubics only)
//           1   2
//           2   3, the four-sided rest along its flatter diagonal
//           3   4
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/mesh/edge_cuts.h"
#include "retalho/tin/tin.h"

namespace retalho {

/// A vertex of the mesh while its triangle is being cut.
struct CutVertex {
  Vec2 point;
  double height = 0;
  Vec2 gradient;
  std::uint32_t id = 0;  ///< its number in the mesh
};

template <int Degree>
class PatchCutter {
 public:
  using Net = TriangleNet<Degree>;
  using Side = EdgeNet<Degree>;

  /// An edge as one of its triangles goes along it.
  struct EdgeUse {
    std::uint32_t edge = 0;
    bool reversed = false;
    EdgeUse turned() const { return {edge, !reversed}; }
  };

  explicit PatchCutter(CutRule<Degree> rule) : rule_(rule) {}

  std::vector<CutVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`

  /// Forgets everything; vertices made from here on are numbered from `first_id`.
  void start(std::uint32_t first_id) {
    vertices.clear();
    triangles.clear();
    edges_.clear();
    next_id_ = first_id;
  }
  std::uint32_t next_id() const { return next_id_; }

  std::uint32_t add_vertex(Vec2 point, double height, Vec2 gradient, std::uint32_t id) {
    vertices.push_back({point, height, gradient, id});
    return static_cast<std::uint32_t>(vertices.size()) - 1;
  }
  /// With the next number.
  std::uint32_t add_vertex(Vec2 point, double height, Vec2 gradient) {
    return add_vertex(point, height, gradient, next_id_++);
  }

  /// The patch that the edges made from here on belong to: where their cuts take their gradients from.
  void set_patch(const Net& net, Vec2 a, Vec2 b, Vec2 c) {
    patch_net_ = net;
    frame_ = TriangleFrame(a, b, c);
  }

  /// An edge of the current patch with all its cuts, numbered with the next numbers as they come along the edge.
  EdgeUse add_edge(std::uint32_t a, std::uint32_t b, const Side& net) {
    return {make_edge(a, b, net, 0, next_id_), false};
  }
  /// The same with numbers of its own, from `id` on, which is moved on.
  EdgeUse add_edge(std::uint32_t a, std::uint32_t b, const Side& net, std::uint32_t& id) {
    return {make_edge(a, b, net, 0, id), false};
  }

  /// Cuts a triangle of the current patch. `e[k]` goes from corner k to corner k + 1.
  void cut(const Net& net, std::array<std::uint32_t, 3> v, std::array<EdgeUse, 3> e, int depth = 0) {
    if (depth > kDeepestCut + 8)
      throw Error(Error::Kind::internal, "a patch was cut 38 times over without coming close to the surface");
    const std::array<bool, 3> is_cut{middle(e[0]) != kNone, middle(e[1]) != kNone, middle(e[2]) != kNone};
    switch (is_cut[0] + is_cut[1] + is_cut[2]) {
      case 0:
        return finish(net, v, e, depth);
      case 1:
        return cut_one(net, v, e, is_cut[0] ? 0 : is_cut[1] ? 1 : 2, depth);
      case 2:
        return cut_two(net, v, e, !is_cut[0] ? 0 : !is_cut[1] ? 1 : 2, depth);
      default:
        return cut_three(net, v, e, depth);
    }
  }

  /// Gradient of the current patch at `p`; the mean of `a` and `b` where the patch is too thin to have one.
  Vec2 gradient_at(Vec2 p, Vec2 a, Vec2 b) const {
    const Vec2 g = evaluate_jet<Degree>(patch_net_, frame_, frame_.barycentric(p)).gradient;
    return std::isfinite(g.x) && std::isfinite(g.y) ? g : 0.5 * (a + b);
  }

 private:
  struct Edge {
    std::uint32_t middle = kNone;         ///< kNone: not cut
    std::array<std::uint32_t, 2> half{};  ///< from the first end to the middle, from the middle to the last end
    double deviation = 0;
  };

  static constexpr Barycentric kHalf01{0.5, 0.5, 0}, kHalf12{0, 0.5, 0.5}, kHalf20{0.5, 0, 0.5};

  std::uint32_t middle(EdgeUse e) const { return edges_[e.edge].middle; }
  EdgeUse first_half(EdgeUse e) const { return {edges_[e.edge].half[e.reversed ? 1 : 0], e.reversed}; }
  EdgeUse second_half(EdgeUse e) const { return {edges_[e.edge].half[e.reversed ? 0 : 1], e.reversed}; }

  std::uint32_t make_edge(std::uint32_t a, std::uint32_t b, const Side& net, int depth, std::uint32_t& id) {
    const auto edge = static_cast<std::uint32_t>(edges_.size());
    edges_.push_back({});
    edges_[edge].deviation = chord_deviation(net);
    if (depth >= kDeepestCut || !rule_.cuts(net)) return edge;
    Side left, right;
    halve(net, left, right);
    const Vec2 point = 0.5 * (vertices[a].point + vertices[b].point);
    const Vec2 gradient = gradient_at(point, vertices[a].gradient, vertices[b].gradient);
    const std::uint32_t m = add_vertex(point, left.back(), gradient, 0);
    const std::uint32_t half0 = make_edge(a, m, left, depth + 1, id);
    vertices[m].id = id++;
    const std::uint32_t half1 = make_edge(m, b, right, depth + 1, id);
    edges_[edge].middle = m;
    edges_[edge].half = {half0, half1};
    return edge;
  }

  void finish(const Net& net, const std::array<std::uint32_t, 3>& v, const std::array<EdgeUse, 3>& e, int depth) {
    const double deviation =
        std::max({edges_[e[0].edge].deviation, edges_[e[1].edge].deviation, edges_[e[2].edge].deviation});
    if (rule_.proven(net, deviation)) {
      triangles.push_back(v);
      return;
    }
    const Barycentric third{1.0 / 3, 1.0 / 3, 1.0 / 3};
    const Vec2 point = (vertices[v[0]].point + vertices[v[1]].point + vertices[v[2]].point) / 3;
    const std::uint32_t m = add_vertex(point, evaluate<Degree>(net, third),
                                       gradient_at(point, vertices[v[0]].gradient, vertices[v[1]].gradient));
    const Net n0 = move_corner<Degree>(net, 0, third), n1 = move_corner<Degree>(net, 1, third),
              n2 = move_corner<Degree>(net, 2, third);
    const EdgeUse s0 = add_edge(v[0], m, edge_of<Degree>(n1, 0, 1)), s1 = add_edge(v[1], m, edge_of<Degree>(n2, 1, 2)),
                  s2 = add_edge(v[2], m, edge_of<Degree>(n0, 2, 0));
    cut(n2, {v[0], v[1], m}, {e[0], s1, s0.turned()}, depth + 1);
    cut(n0, {m, v[1], v[2]}, {s1.turned(), e[1], s2}, depth + 1);
    cut(n1, {v[0], m, v[2]}, {s0, s2.turned(), e[2]}, depth + 1);
  }

  template <typename T>
  static std::array<T, 3> rotated(const std::array<T, 3>& a, int by) {
    return {a[static_cast<std::size_t>(by)], a[static_cast<std::size_t>((by + 1) % 3)],
            a[static_cast<std::size_t>((by + 2) % 3)]};
  }

  /// Edge `k` is cut: turned to be edge 0.
  void cut_one(const Net& whole, const std::array<std::uint32_t, 3>& whole_v, const std::array<EdgeUse, 3>& whole_e,
               int k, int depth) {
    const Net net = rotated_net<Degree>(whole, k);
    const auto v = rotated(whole_v, k);
    const auto e = rotated(whole_e, k);
    const std::uint32_t m = middle(e[0]);
    const Net left = move_corner<Degree>(net, 1, kHalf01), right = move_corner<Degree>(net, 0, kHalf01);
    const EdgeUse across = add_edge(m, v[2], edge_of<Degree>(left, 1, 2));
    cut(left, {v[0], m, v[2]}, {first_half(e[0]), across, e[2]}, depth + 1);
    cut(right, {m, v[1], v[2]}, {second_half(e[0]), e[1], across.turned()}, depth + 1);
  }

  /// Edge `k` is not cut, the others are: turned to be edge 0.
  void cut_two(const Net& whole, const std::array<std::uint32_t, 3>& whole_v, const std::array<EdgeUse, 3>& whole_e,
               int k, int depth) {
    const Net net = rotated_net<Degree>(whole, k);
    const auto v = rotated(whole_v, k);
    const auto e = rotated(whole_e, k);
    const std::uint32_t m1 = middle(e[1]), m2 = middle(e[2]);
    const Net upper = move_corner<Degree>(net, 1, kHalf12);   // v0 m1 v2
    const Net tip = move_corner<Degree>(upper, 0, kHalf20);   // m2 m1 v2
    const Net below1 = move_corner<Degree>(net, 2, kHalf12);  // v0 v1 m1
    const Net below2 = move_corner<Degree>(net, 2, kHalf20);  // v0 v1 m2
    const EdgeUse top = add_edge(m2, m1, edge_of<Degree>(tip, 0, 1));
    cut(tip, {m2, m1, v[2]}, {top, second_half(e[1]), first_half(e[2])}, depth + 1);
    const Side from0 = edge_of<Degree>(below1, 0, 2), from1 = edge_of<Degree>(below2, 1, 2);
    if (chord_deviation(from0) <= chord_deviation(from1)) {
      const EdgeUse diagonal = add_edge(v[0], m1, from0);
      cut(below1, {v[0], v[1], m1}, {e[0], first_half(e[1]), diagonal.turned()}, depth + 1);
      cut(move_corner<Degree>(upper, 2, kHalf20), {v[0], m1, m2}, {diagonal, top.turned(), second_half(e[2])},
          depth + 1);
    } else {
      const EdgeUse diagonal = add_edge(v[1], m2, from1);
      cut(below2, {v[0], v[1], m2}, {e[0], diagonal, second_half(e[2])}, depth + 1);
      const Net right = move_corner<Degree>(move_corner<Degree>(net, 0, kHalf20), 2, kHalf12);  // m2 v1 m1
      cut(right, {m2, v[1], m1}, {diagonal.turned(), first_half(e[1]), top.turned()}, depth + 1);
    }
  }

  void cut_three(const Net& net, const std::array<std::uint32_t, 3>& v, const std::array<EdgeUse, 3>& e, int depth) {
    const std::uint32_t m0 = middle(e[0]), m1 = middle(e[1]), m2 = middle(e[2]);
    const Net corner0 = move_corner<Degree>(move_corner<Degree>(net, 1, kHalf01), 2, kHalf20);  // v0 m0 m2
    const Net corner1 = move_corner<Degree>(move_corner<Degree>(net, 2, kHalf12), 0, kHalf01);  // m0 v1 m1
    const Net upper = move_corner<Degree>(net, 1, kHalf12);                                     // v0 m1 v2
    const Net corner2 = move_corner<Degree>(upper, 0, kHalf20);                                 // m2 m1 v2
    // m0 m1 m2: of v0 m1 m2, corner 0 moved to m0 = v0 + m1 - m2.
    const Net inner = move_corner<Degree>(move_corner<Degree>(upper, 2, kHalf20), 0, {1, 1, -1});
    const EdgeUse c0 = add_edge(m0, m2, edge_of<Degree>(corner0, 1, 2)),
                  c1 = add_edge(m1, m0, edge_of<Degree>(corner1, 2, 0)),
                  c2 = add_edge(m2, m1, edge_of<Degree>(corner2, 0, 1));
    cut(corner0, {v[0], m0, m2}, {first_half(e[0]), c0, second_half(e[2])}, depth + 1);
    cut(corner1, {m0, v[1], m1}, {second_half(e[0]), first_half(e[1]), c1}, depth + 1);
    cut(corner2, {m2, m1, v[2]}, {c2, second_half(e[1]), first_half(e[2])}, depth + 1);
    cut(inner, {m0, m1, m2}, {c1.turned(), c2.turned(), c0.turned()}, depth + 1);
  }

  CutRule<Degree> rule_;
  std::vector<Edge> edges_;
  Net patch_net_{};
  TriangleFrame frame_;
  std::uint32_t next_id_ = 0;
};

}  // namespace retalho
