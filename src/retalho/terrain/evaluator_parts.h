// What a TerrainEvaluator keeps; shared by evaluate.cpp (points) and grid_values.cpp (rasters).
#pragma once

#include <array>
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

  PiecePoint find(Barycentric macro) const { return {0, macro}; }
  TriangleNet<1> net(int) const { return corner; }
  TriangleFrame frame(int, const TriangleFrame& macro) const { return macro; }
};

struct TerrainEvaluator::Parts {
  Parts(const Terrain& model, const Context& context);

  const Terrain& terrain;
  EdgeTable edges;
  PointLocator locator;
  bool has_voids = false;  ///< the grid has cells without data
  // One of these is filled, by the terrain's kind.
  std::vector<LinearElement> linear;
  std::vector<PowellSabinElement> powell_sabin;
  std::vector<CloughTocherElement> clough_tocher;

  /// Calls `use` with the elements of the terrain's kind.
  template <class Use>
  decltype(auto) with_elements(const Use& use) const {
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

/// Gradients and corner of a triangle's barycentric coordinates. A triangle whose area rounds to nothing counts as its
/// own centroid, so that no division by zero reaches a height.
class MacroTriangle {
 public:
  MacroTriangle(const Tin& tin, std::uint32_t triangle) {
    const auto& v = tin.triangles[triangle];
    const Vec2 a = tin.points[v[0]], b = tin.points[v[1]], c = tin.points[v[2]];
    origin_ = a;
    const Vec2 ab = b - a, ac = c - a;
    const double area2 = cross(ab, ac);
    if (area2 > 0) {
      grad_s_ = Vec2{ac.y, -ac.x} / area2;
      grad_t_ = Vec2{-ab.y, ab.x} / area2;
    } else {
      s_at_origin_ = t_at_origin_ = 1.0 / 3;
    }
  }

  Barycentric barycentric(Vec2 p) const {
    const Vec2 d = p - origin_;
    const double s = s_at_origin_ + dot(grad_s_, d), t = t_at_origin_ + dot(grad_t_, d);
    return {1 - s - t, s, t};
  }
  /// Only the gradients are filled.
  TriangleFrame frame() const {
    TriangleFrame f;
    f.grad_r = -(grad_s_ + grad_t_);
    f.grad_s = grad_s_;
    f.grad_t = grad_t_;
    return f;
  }
  /// How the coordinates change with one unit of x.
  Barycentric along_x() const { return {-(grad_s_.x + grad_t_.x), grad_s_.x, grad_t_.x}; }

 private:
  Vec2 origin_, grad_s_, grad_t_;
  double s_at_origin_ = 0, t_at_origin_ = 0;
};

template <class Element>
double element_value(const Element& element, Barycentric macro) {
  const PiecePoint place = element.find(macro);
  return evaluate<Element::kDegree>(element.net(place.piece), place.at);
}

template <class Element>
Jet element_jet(const Element& element, const MacroTriangle& triangle, Vec2 p) {
  const PiecePoint place = element.find(triangle.barycentric(p));
  return evaluate_jet<Element::kDegree>(element.net(place.piece), element.frame(place.piece, triangle.frame()),
                                        place.at);
}

}  // namespace retalho
