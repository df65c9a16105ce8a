// A split triangle made ready for rows of cells. Its pieces stand around its centre like a fan, so a row passes them in
// their order around it, changing from one to the next where it crosses a line from the centre to the outline. On a
// piece the height is a polynomial in (column, y) about the centre; nothing is carried from row to row or from cell to
// cell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "retalho/terrain/clough_tocher.h"
#include "retalho/terrain/evaluator_parts.h"
#include "retalho/terrain/powell_sabin.h"
#include "retalho/terrain/row_spans.h"

namespace retalho {

/// The net of the blossom with one argument set to direction `d` (whose coordinates sum to 0): the derivative along `d`
/// without the factor Degree.
template <int Degree>
[[gnu::always_inline]] inline TriangleNet<Degree - 1> contract(const TriangleNet<Degree>& b, Barycentric d) {
  TriangleNet<Degree - 1> c{};
  for (int i = Degree - 1; i >= 0; --i)
    for (int j = Degree - 1 - i; j >= 0; --j) {
      const double last = b[static_cast<std::size_t>(ordinate_index(Degree, i, j))];
      c[static_cast<std::size_t>(ordinate_index(Degree - 1, i, j))] =
          d.r * (b[static_cast<std::size_t>(ordinate_index(Degree, i + 1, j))] - last) +
          d.s * (b[static_cast<std::size_t>(ordinate_index(Degree, i, j + 1))] - last);
    }
  return c;
}

/// A quadratic in (x, y) about the centre, of a net whose first corner is the centre.
struct QuadraticAboutCentre {
  double one, x, y, xx, xy, yy;

  QuadraticAboutCentre() = default;
  QuadraticAboutCentre(const TriangleNet<2>& b, Barycentric dx, Barycentric dy) {
    const TriangleNet<1> bx = contract<2>(b, dx), by = contract<2>(b, dy);
    one = b[0];
    x = 2 * bx[0];
    y = 2 * by[0];
    xx = contract<1>(bx, dx)[0];
    xy = 2 * contract<1>(bx, dy)[0];
    yy = contract<1>(by, dy)[0];
  }
  /// The polynomial in x on the line at height v.
  struct Row {
    double c0, c1, c2;
    double operator()(double at) const { return c0 + at * (c1 + at * c2); }
  };
  Row row(double v) const { return {one + v * (y + v * yy), x + v * xy, xx}; }
};

/// A cubic in (x, y) about the centre, of a net whose third corner is the centre.
struct CubicAboutCentre {
  double one, x, y, xx, xy, yy, xxx, xxy, xyy, yyy;

  CubicAboutCentre() = default;
  CubicAboutCentre(const TriangleNet<3>& b, Barycentric dx, Barycentric dy) {
    const TriangleNet<2> bx = contract<3>(b, dx), by = contract<3>(b, dy);
    const TriangleNet<1> bxx = contract<2>(bx, dx), bxy = contract<2>(bx, dy), byy = contract<2>(by, dy);
    one = b[9];
    x = 3 * bx[5];
    y = 3 * by[5];
    xx = 3 * bxx[2];
    xy = 6 * bxy[2];
    yy = 3 * byy[2];
    xxx = contract<1>(bxx, dx)[0];
    xxy = 3 * contract<1>(bxx, dy)[0];
    xyy = 3 * contract<1>(byy, dx)[0];
    yyy = contract<1>(byy, dy)[0];
  }
  struct Row {
    double c0, c1, c2, c3;
    double operator()(double at) const { return c0 + at * (c1 + at * (c2 + at * c3)); }
  };
  Row row(double v) const { return {one + v * (y + v * (yy + v * yyy)), x + v * (xy + v * xyy), xx + v * xxy, xxx}; }
};

/// What the two split elements look like from their centre: the spokes' ends counter-clockwise, and for each spoke the
/// piece that follows it counter-clockwise.
inline Barycentric fan_centre(const PowellSabinElement& e) {
  return {e.weight[0], e.weight[1], e.weight[2]};
}
inline Barycentric fan_centre(const CloughTocherElement&) {
  return {1.0 / 3, 1.0 / 3, 1.0 / 3};
}

template <class Element>
struct FanShape;

template <>
struct FanShape<CloughTocherElement> {
  using Polynomial = CubicAboutCentre;
  static constexpr std::size_t kSpokes = 3;
  /// Spoke m ends at corner m; behind it lies the piece of corners m and m + 1.
  static int piece(std::size_t spoke) { return static_cast<int>((spoke + 2) % 3); }
  static std::array<Vec2, 3> ends(const CloughTocherElement&, const Corners& c) { return c; }
};

template <>
struct FanShape<PowellSabinElement> {
  using Polynomial = QuadraticAboutCentre;
  static constexpr std::size_t kSpokes = 6;
  /// Spoke 2k ends at corner k + 1, spoke 2k + 1 at the split of edge k: the pieces' own order.
  static int piece(std::size_t spoke) { return static_cast<int>(spoke); }
  static std::array<Vec2, 6> ends(const PowellSabinElement& e, const Corners& c) {
    std::array<Vec2, 6> ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2 from = c[(k + 1) % 3], to = c[(k + 2) % 3];
      ends[2 * k] = from;
      ends[2 * k + 1] = from + e.split[k] * (to - from);
    }
    return ends;
  }
};

template <class Element>
class RowFan {
  using Shape = FanShape<Element>;
  using Polynomial = typename Shape::Polynomial;
  static constexpr std::size_t kSpokes = Shape::kSpokes;
  /// Beyond this stretch (how much a coordinate changes over the triangle's box) a polynomial about the centre would
  /// lose more than four digits; such pieces are evaluated cell by cell in barycentric coordinates.
  static constexpr double kStretch = 100;
  /// Triangles flatter than this are treated so altogether.
  static constexpr double kFlat = 1e5;

 public:
  /// Starts on a triangle.
  void begin(const Element& element, const MacroTriangle& triangle, const Corners& corners, const RowGrid& grid,
             double columns_a_unit) {
    element_ = &element;
    triangle_ = &triangle;
    grid_ = &grid;
    ready_ = 0;
    flat_ = !(triangle.flatness() < kFlat);
    if (flat_) return;
    const Barycentric w = fan_centre(element);
    const Vec2 centre = corners[0] + (w.s * (corners[1] - corners[0]) + w.t * (corners[2] - corners[0]));
    centre_y_ = centre.y;
    centre_column_ = (centre.x - grid.origin.x) * columns_a_unit;
    along_x_ = triangle.along_x(grid.step.x);
    along_y_ = triangle.along_y();
    const auto [x0, x1] = std::minmax({corners[0].x, corners[1].x, corners[2].x});
    const auto [y0, y1] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
    most_x_ = kStretch / ((x1 - x0) * columns_a_unit);
    most_y_ = kStretch / (y1 - y0);
    spread(Shape::ends(element, corners), columns_a_unit);
  }

  /// Heights of the cells first..last of a row at height y.
  void fill(int row, double y, int first, int last, double* out) {
    if (flat_) {
      for (int c = first; c <= last; ++c)
        out[c - first] = element_value(*element_, triangle_->barycentric(grid_->at(c, row)));
      return;
    }
    const double v = y - centre_y_;
    const Side& side = v >= 0 ? upper_ : lower_;
    int from = first;
    for (std::size_t m = 0; m < side.count && from <= last; ++m) {
      const double crossing = centre_column_ + side.slope[m] * v;
      const int next = clamped_floor(crossing, last) + 1;  // the first cell beyond the line
      if (next <= from) continue;
      const int end = std::min(next, last + 1);
      write(side.sector[m], row, v, from, end, out + (from - first));
      from = end;
    }
    if (from <= last) write(side.sector[side.count], row, v, from, last + 1, out + (from - first));
  }

 private:
  /// The spokes above (or below) the centre from left to right, and the sectors between them.
  struct Side {
    std::size_t count = 0;
    std::array<double, kSpokes> slope;  // columns a unit of y
    std::array<std::size_t, kSpokes + 1> sector;
  };
  struct Sector {
    Polynomial polynomial;
    bool tame;
  };

  void spread(const std::array<Vec2, kSpokes>& ends, double columns_a_unit) {
    std::array<double, kSpokes> rise, slope;
    std::size_t rising = kSpokes, falling = kSpokes;  // the first spoke, counter-clockwise, of each half
    for (std::size_t m = 0; m < kSpokes; ++m) {
      rise[m] = ends[m].y - centre_y_;
      slope[m] = ((ends[m].x - grid_->origin.x) * columns_a_unit - centre_column_) / rise[m];
    }
    for (std::size_t m = 0; m < kSpokes; ++m) {
      const double before = rise[(m + kSpokes - 1) % kSpokes];
      if (rise[m] > 0 && !(before > 0)) rising = m;
      if (rise[m] < 0 && !(before < 0)) falling = m;
    }
    upper_.count = lower_.count = 0;
    if (rising == kSpokes || falling == kSpokes) {  // not to be expected of a triangle with an area
      flat_ = true;
      return;
    }
    // Below, left to right is counter-clockwise; above, it is clockwise.
    lower_.sector[0] = (falling + kSpokes - 1) % kSpokes;
    for (std::size_t m = falling; rise[m] < 0; m = (m + 1) % kSpokes) {
      lower_.slope[lower_.count] = slope[m];
      lower_.sector[++lower_.count] = m;
    }
    std::size_t count = 0;
    for (std::size_t m = rising; rise[m] > 0; m = (m + 1) % kSpokes) ++count;
    upper_.count = count;
    upper_.sector[count] = (rising + kSpokes - 1) % kSpokes;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t m = (rising + k) % kSpokes;
      upper_.slope[count - 1 - k] = slope[m];
      upper_.sector[count - 1 - k] = m;
    }
  }

  const Sector& prepared(std::size_t number) {
    Sector& sector = sectors_[number];
    if (ready_ >> number & 1U) return sector;
    ready_ |= 1U << number;
    const int piece = Shape::piece(number);
    const typename Element::Map map(*element_, piece);
    const Barycentric dx = map(along_x_), dy = map(along_y_);
    const double stretch_x = std::max(std::abs(dx.r), std::max(std::abs(dx.s), std::abs(dx.t)));
    const double stretch_y = std::max(std::abs(dy.r), std::max(std::abs(dy.s), std::abs(dy.t)));
    sector.tame = stretch_x < most_x_ && stretch_y < most_y_;
    sector.polynomial = Polynomial(element_->net(piece), dx, dy);
    return sector;
  }

  void write(std::size_t number, int row, double v, int from, int end, double* out) {
    const Sector& sector = prepared(number);
    const int count = end - from;
    if (!sector.tame) {
      for (int n = 0; n < count; ++n)
        out[n] = element_value(*element_, triangle_->barycentric(grid_->at(from + n, row)));
      return;
    }
    const auto polynomial = sector.polynomial.row(v);
    const double start = from - centre_column_;
    if (count >= 12) {
      for (int n = 0; n < count; ++n) out[n] = polynomial(start + n);
      return;
    }
    double at = start;  // short runs are the rule: they do not pay for the preparations of a vector loop
    int n = 0;
    for (; n + 1 < count; n += 2, at += 2) {
      out[n] = polynomial(at);
      out[n + 1] = polynomial(at + 1);
    }
    if (n < count) out[n] = polynomial(at);
  }

  const Element* element_ = nullptr;
  const MacroTriangle* triangle_ = nullptr;
  const RowGrid* grid_ = nullptr;
  bool flat_ = false;
  unsigned ready_ = 0;
  double centre_y_ = 0, centre_column_ = 0, most_x_ = 0, most_y_ = 0;
  Barycentric along_x_, along_y_;
  Side upper_, lower_;
  std::array<Sector, kSpokes> sectors_;
};

/// The flat triangle needs no fan.
template <>
class RowFan<LinearElement> {
 public:
  void begin(const LinearElement& element, const MacroTriangle& triangle, const Corners&, const RowGrid& grid, double) {
    element_ = &element;
    triangle_ = &triangle;
    grid_ = &grid;
    change_ = contract<1>(element.corner, triangle.along_x(grid.step.x))[0];
  }
  void fill(int row, double, int first, int last, double* out) {
    const double start = element_value(*element_, triangle_->barycentric(grid_->at(first, row)));
    for (int n = 0; n <= last - first; ++n) out[n] = start + n * change_;
  }

 private:
  const LinearElement* element_ = nullptr;
  const MacroTriangle* triangle_ = nullptr;
  const RowGrid* grid_ = nullptr;
  double change_ = 0;
};

}  // namespace retalho
