// Bernstein-Bézier polynomials on a triangle, any degree fixed at compile time: the form that every triangular
// surface of the house has (docs/mathematics.md, section 1; van Kaick et al., eq. 2).
//
// Ordinates stand in descending (i, j, k): degree 2 is 200 110 101 020 011 002; degree 3 is
// 300 210 201 120 111 102 030 021 012 003. No allocation, no I/O; everything here is a pure function.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "retalho/core/vec.h"

namespace retalho {

/// Barycentric coordinates; r + s + t = 1 inside and outside of the triangle.
struct Barycentric {
  double r = 0, s = 0, t = 0;
};

/// How many ordinates a polynomial of this degree has.
constexpr int ordinate_count(int degree) {
  return (degree + 1) * (degree + 2) / 2;
}

/// Where ordinate (i, j, k), i + j + k = degree, stands.
constexpr int ordinate_index(int degree, int i, int j) {
  const int below = degree - i;  // rows with a larger i come first and have 1, 2, ... entries
  return below * (below + 1) / 2 + (below - j);
}

template <int Degree>
using TriangleNet = std::array<double, static_cast<std::size_t>(ordinate_count(Degree))>;

/// One step of de Casteljau: the ordinates of degree N - 1 of the blend at `u`.
template <int Degree>
constexpr TriangleNet<Degree - 1> casteljau_step(const TriangleNet<Degree>& b, Barycentric u) {
  TriangleNet<Degree - 1> c{};
  for (int i = Degree - 1; i >= 0; --i)
    for (int j = Degree - 1 - i; j >= 0; --j)
      c[static_cast<std::size_t>(ordinate_index(Degree - 1, i, j))] =
          u.r * b[static_cast<std::size_t>(ordinate_index(Degree, i + 1, j))] +
          u.s * b[static_cast<std::size_t>(ordinate_index(Degree, i, j + 1))] +
          u.t * b[static_cast<std::size_t>(ordinate_index(Degree, i, j))];
  return c;
}

/// Value at `u`.
template <int Degree>
constexpr double evaluate(const TriangleNet<Degree>& b, Barycentric u) {
  if constexpr (Degree == 0)
    return b[0];
  else
    return evaluate<Degree - 1>(casteljau_step<Degree>(b, u), u);
}

/// A triangle's geometry as evaluation needs it: constant gradients of the barycentric coordinates.
struct TriangleFrame {
  Vec2 a, b, c;
  Vec2 grad_r, grad_s, grad_t;
  double area2 = 0;  ///< twice the signed area, > 0 for counter-clockwise

  TriangleFrame() = default;
  TriangleFrame(Vec2 a_, Vec2 b_, Vec2 c_) : a(a_), b(b_), c(c_), area2(cross(b_ - a_, c_ - a_)) {
    const auto rot = [](Vec2 v) { return Vec2{-v.y, v.x}; };
    grad_r = rot(c - b) / area2;
    grad_s = rot(a - c) / area2;
    grad_t = rot(b - a) / area2;
  }

  Barycentric barycentric(Vec2 p) const {
    const double r = cross(b - p, c - p) / area2;
    const double s = cross(c - p, a - p) / area2;
    return {r, s, 1 - r - s};
  }
};

/// Value, gradient and second derivatives of a height function at a point.
struct Jet {
  double value = 0;
  Vec2 gradient;
  double xx = 0, xy = 0, yy = 0;
};

/// Value, gradient and second derivatives at `u`, in the coordinates of `frame`.
template <int Degree>
Jet evaluate_jet(const TriangleNet<Degree>& b, const TriangleFrame& frame, Barycentric u) {
  static_assert(Degree >= 1);
  Jet jet;
  const auto reduce_to = [&]<int From, int To>(const auto& self, const TriangleNet<From>& net) -> TriangleNet<To> {
    if constexpr (From == To)
      return net;
    else
      return self.template operator()<From - 1, To>(self, casteljau_step<From>(net, u));
  };
  const TriangleNet<1> first = reduce_to.template operator()<Degree, 1>(reduce_to, b);
  jet.value = u.r * first[0] + u.s * first[1] + u.t * first[2];
  jet.gradient = Degree * (first[0] * frame.grad_r + first[1] * frame.grad_s + first[2] * frame.grad_t);
  if constexpr (Degree >= 2) {
    const TriangleNet<2> second = reduce_to.template operator()<Degree, 2>(reduce_to, b);
    const auto quadratic_form = [&](double ra, double sa, double ta, double rb, double sb, double tb) {
      return ra * rb * second[0] + sa * sb * second[3] + ta * tb * second[5] + (ra * sb + sa * rb) * second[1] +
             (ra * tb + ta * rb) * second[2] + (sa * tb + ta * sb) * second[4];
    };
    const double scale = Degree * (Degree - 1);
    const Vec2 r = frame.grad_r, s = frame.grad_s, t = frame.grad_t;
    jet.xx = scale * quadratic_form(r.x, s.x, t.x, r.x, s.x, t.x);
    jet.xy = scale * quadratic_form(r.x, s.x, t.x, r.y, s.y, t.y);
    jet.yy = scale * quadratic_form(r.y, s.y, t.y, r.y, s.y, t.y);
  }
  return jet;
}

/// Smallest and largest ordinate: they enclose the polynomial's range on the triangle.
template <int Degree>
constexpr std::pair<double, double> bounds(const TriangleNet<Degree>& b) {
  const auto [low, high] = std::minmax_element(b.begin(), b.end());
  return {*low, *high};
}

}  // namespace retalho
