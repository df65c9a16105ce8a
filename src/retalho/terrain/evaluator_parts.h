// What a TerrainEvaluator keeps; shared by evaluate.cpp (points) and grid_values.cpp (rasters).
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "retalho/terrain/clough_tocher.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/locate.h"
#include "retalho/terrain/powell_sabin.h"

namespace retalho {

/// The flat triangle in the form of the split elements: one piece.
struct LinearElement {
  static constexpr int kDegree = 1;
  static constexpr int kPieces = 1;

  std::array<double, 3> corner;

  struct Map {
    Map() = default;
    Map(const LinearElement&, int) {}
    Barycentric operator()(Barycentric macro) const { return macro; }
  };

  int piece(Barycentric) const { return 0; }
  PiecePoint find(Barycentric macro) const { return {0, macro}; }
  TriangleNet<1> net(int) const { return corner; }
  TriangleFrame frame(int, const TriangleFrame& macro) const { return macro; }
};

/// From a point to the triangle's barycentric coordinates. A triangle whose area rounds to nothing counts as its first
/// corner, so that no division by zero reaches a height.
class MacroTriangle {
 public:
  MacroTriangle() = default;
  MacroTriangle(const Tin& tin, std::uint32_t triangle) {
    const auto& v = tin.triangles[triangle];
    origin_ = tin.points[v[0]];
    const Vec2 ab = tin.points[v[1]] - origin_, ac = tin.points[v[2]] - origin_;
    const double area2 = cross(ab, ac);
    if (!(area2 > 0)) return;
    grad_s_ = Vec2{ac.y, -ac.x} / area2;
    grad_t_ = Vec2{-ab.y, ab.x} / area2;
    margin_ = kRounding * (std::abs(ab.x * ac.y) + std::abs(ab.y * ac.x)) / area2;
  }

  Barycentric barycentric(Vec2 p) const {
    const Vec2 d = p - origin_;
    const double s = dot(grad_s_, d), t = dot(grad_t_, d);
    return {1 - s - t, s, t};
  }
  /// Are these coordinates, computed by `barycentric`, those of a point strictly inside, beyond all rounding?
  bool surely_inside(Barycentric u) const { return u.r > margin_ && u.s > margin_ && u.t > margin_; }
  /// Only the gradients are filled.
  TriangleFrame frame() const {
    TriangleFrame f;
    f.grad_r = -(grad_s_ + grad_t_);
    f.grad_s = grad_s_;
    f.grad_t = grad_t_;
    return f;
  }
  /// How the coordinates change with a step along x.
  Barycentric along_x(double step) const {
    const double s = step * grad_s_.x, t = step * grad_t_.x;
    return {-(s + t), s, t};
  }
  /// How the coordinates change with one unit of y.
  Barycentric along_y() const { return {-(grad_s_.y + grad_t_.y), grad_s_.y, grad_t_.y}; }
  /// About the ratio of the longest side to the smallest height; 1 or more.
  double flatness() const { return margin_ / kRounding; }

 private:
  static constexpr double kRounding = 64 * 1.1102230246251565e-16;

  Vec2 origin_, grad_s_, grad_t_;
  double margin_ = 1;
};

/// All that a query in one triangle touches, in one place.
template <class Element>
struct TriangleRecord {
  MacroTriangle triangle;
  Element element;
};

struct TerrainEvaluator::Parts {
  Parts(const Terrain& model, const Context& context);

  const Terrain& terrain;
  EdgeTable edges;
  PointLocator locator;
  bool has_voids = false;  ///< the grid has cells without data
  // One of these is filled, by the terrain's kind.
  std::vector<TriangleRecord<LinearElement>> linear;
  std::vector<TriangleRecord<PowellSabinElement>> powell_sabin;
  std::vector<TriangleRecord<CloughTocherElement>> clough_tocher;

  /// Calls `use` with the records of the terrain's kind.
  template <class Use>
  decltype(auto) with_records(const Use& use) const {
    switch (terrain.kind) {
      case SurfaceKind::powell_sabin:
        return use(powell_sabin);
      case SurfaceKind::clough_tocher:
        return use(clough_tocher);
      default:
        return use(linear);
    }
  }

  bool cell_valid(Vec2 p) const { return !has_voids || terrain.grid.has_data(p); }
};

template <class Element>
double element_value(const Element& element, Barycentric macro) {
  const PiecePoint place = element.find(macro);
  return evaluate<Element::kDegree>(element.net(place.piece), place.at);
}

template <class Element>
Jet element_jet(const TriangleRecord<Element>& record, Vec2 p) {
  const PiecePoint place = record.element.find(record.triangle.barycentric(p));
  return evaluate_jet<Element::kDegree>(record.element.net(place.piece),
                                        record.element.frame(place.piece, record.triangle.frame()), place.at);
}

}  // namespace retalho
