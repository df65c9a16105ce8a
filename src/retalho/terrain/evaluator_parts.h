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
  explicit MacroTriangle(const Corners& c) : origin_(c[0]) {
    const Vec2 ab = c[1] - c[0], ac = c[2] - c[0];
    const double area2 = cross(ab, ac);
    if (!(area2 > 0)) return;
    const double per_area2 = 1 / area2;
    grad_s_ = Vec2{ac.y, -ac.x} * per_area2;
    grad_t_ = Vec2{-ab.y, ab.x} * per_area2;
    flatness_ = (std::abs(ab.x * ac.y) + std::abs(ab.y * ac.x)) * per_area2;
  }

  Barycentric barycentric(Vec2 p) const {
    const Vec2 d = p - origin_;
    const double s = dot(grad_s_, d), t = dot(grad_t_, d);
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
  /// How the coordinates change with a step along x.
  Barycentric along_x(double step) const {
    const double s = step * grad_s_.x, t = step * grad_t_.x;
    return {-(s + t), s, t};
  }
  /// How the coordinates change with one unit of y.
  Barycentric along_y() const { return {-(grad_s_.y + grad_t_.y), grad_s_.y, grad_t_.y}; }
  /// About the ratio of the longest side to the smallest height; at least 1, huge where the area rounds to nothing.
  double flatness() const { return flatness_; }

 private:
  Vec2 origin_, grad_s_, grad_t_;
  double flatness_ = 1e300;
};

/// Asks for a whole element at once: a query would otherwise wait for one line of memory after the other.
template <class Element>
void prefetch(const Element& element) {
  const char* bytes = reinterpret_cast<const char*>(&element);
  for (std::size_t line = 0; line < sizeof(Element); line += 64) __builtin_prefetch(bytes + line);
}

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
