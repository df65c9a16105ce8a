// What the subdivision asks of f on a cell and on a side, answered by Bernstein coefficients or by intervals.
// Internal to level/implicit_curve.cpp.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "retalho/bernstein/segment.h"
#include "retalho/level/implicit_tensor.h"

namespace retalho {

struct EdgeRoots {
  std::vector<double> inner;  ///< in (0, 1), ascending
  bool at_start = false, at_end = false;
  bool zero = false;  ///< f vanishes all along the side
};

class PolynomialField {
 public:
  struct Cell {
    std::vector<double> c;
    double error = 0;
  };
  using Edge = Bernstein;

  explicit PolynomialField(TensorBernstein p) : nx_(p.degree_x), ny_(p.degree_y), root_{std::move(p.c), p.error} {}

  Cell root() const { return root_; }
  /// SW, SE, NW, NE.
  std::array<Cell, 4> split(const Cell& cell, const PlaneBox& box) const;
  bool absent(const Cell& cell) const;
  bool continuous(const Cell&) const { return true; }
  /// Signs of f_x and f_y where they are proved on the whole cell, else 0.
  std::pair<int, int> gradient_signs(const Cell& cell) const;
  /// Side 0..3: bottom, right, top, left.
  Edge edge(const Cell& cell, int side, double from, double to, double fixed) const;
  EdgeRoots roots(const Edge& edge) const;
  /// Halves of a side; true when f is zero at the middle, to rounding.
  bool cut(const Edge& edge, Edge& first, Edge& second) const;
  double value(const Edge& edge, double t) const { return evaluate(edge, t); }
  /// In a cell where the curve is a graph over x (or over y): its height at `along`, kept inside of the cell.
  double height(const Cell& cell, const PlaneBox& box, bool over_x, double along) const;

 private:
  int nx_, ny_;
  Cell root_;
};

class IntervalField {
 public:
  struct Cell {
    IntervalJet jet;
  };
  struct Edge {
    double from = 0, to = 1, fixed = 0;
    bool vertical = false;
  };

  IntervalField(const Expression& f, const PlaneBox& box) : f_(f), box_(box) {}

  Cell root() const { return cell(box_); }
  std::array<Cell, 4> split(const Cell& cell, const PlaneBox& box) const;
  bool absent(const Cell& cell) const { return !cell.jet.possible || !cell.jet.value.contains_zero(); }
  bool continuous(const Cell& cell) const { return cell.jet.defined; }
  std::pair<int, int> gradient_signs(const Cell& cell) const;
  Edge edge(const Cell& cell, int side, double from, double to, double fixed) const;
  EdgeRoots roots(const Edge& edge) const;
  bool cut(const Edge& edge, Edge& first, Edge& second) const;
  double value(const Edge& edge, double t) const { return at(edge, edge.from + t * (edge.to - edge.from)); }
  double height(const Cell& cell, const PlaneBox& box, bool over_x, double along) const;

 private:
  Cell cell(const PlaneBox& b) const { return {f_.enclose({b.x0, b.x1}, {b.y0, b.y1})}; }
  double at(const Edge& e, double along) const { return e.vertical ? f_(e.fixed, along) : f_(along, e.fixed); }
  void search(const Edge& e, double a, double b, int level, std::vector<double>& out) const;

  const Expression& f_;
  PlaneBox box_;
};

}  // namespace retalho
