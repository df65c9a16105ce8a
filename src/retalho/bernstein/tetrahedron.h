// Bernstein-Bézier cubics on a tetrahedron: the form that every tetrahedral surface of the house has.
//
// The 20 ordinates stand in the order of the multisets {a <= b <= c} of the corners 0..3: 000 001 002 003 011 012 013
// 022 023 033 111 ..., which is descending (i, j, k, l) as on the triangle. No allocation, no I/O; pure functions.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "retalho/core/vec.h"

namespace retalho {

/// Barycentric coordinates (sum 1, inside and outside of the tetrahedron) or a barycentric direction (sum 0).
using TetBarycentric = std::array<double, 4>;
using TetLinear = std::array<double, 4>;
using TetQuadratic = std::array<double, 10>;  ///< 00 01 02 03 11 12 13 22 23 33
using TetCubic = std::array<double, 20>;

/// The tables of the orders above, worked out by the compiler.
struct TetIndex {
  std::array<std::array<int, 3>, 20> cubic{};      ///< corners of each cubic ordinate
  std::array<std::array<int, 2>, 10> quadratic{};  ///< corners of each quadratic ordinate
  int of3[4][4][4] = {};                           ///< place of a cubic ordinate, corners in any order
  int of2[4][4] = {};                              ///< place of a quadratic ordinate

  constexpr TetIndex() {
    std::size_t n = 0;
    for (int a = 0; a < 4; ++a)
      for (int b = a; b < 4; ++b) {
        quadratic[n] = {a, b};
        of2[a][b] = of2[b][a] = static_cast<int>(n++);
      }
    n = 0;
    for (int a = 0; a < 4; ++a)
      for (int b = a; b < 4; ++b)
        for (int c = b; c < 4; ++c) {
          cubic[n] = {a, b, c};
          of3[a][b][c] = of3[a][c][b] = of3[b][a][c] = of3[b][c][a] = of3[c][a][b] = of3[c][b][a] =
              static_cast<int>(n++);
        }
  }
};
inline constexpr TetIndex kTet{};

/// The cubic's polar form with one argument set to `u`: a quadratic. Three of them make a value, a derivative (set
/// directions), or an ordinate of a segment or a sub-tetrahedron.
constexpr TetQuadratic contract(const TetCubic& c, const TetBarycentric& u) {
  TetQuadratic q{};
  for (std::size_t n = 0; n < 10; ++n) {
    const auto [a, b] = kTet.quadratic[n];
    const int* at = kTet.of3[a][b];
    q[n] = u[0] * c[static_cast<std::size_t>(at[0])] + u[1] * c[static_cast<std::size_t>(at[1])] +
           u[2] * c[static_cast<std::size_t>(at[2])] + u[3] * c[static_cast<std::size_t>(at[3])];
  }
  return q;
}
constexpr TetLinear contract(const TetQuadratic& q, const TetBarycentric& u) {
  TetLinear l{};
  for (std::size_t a = 0; a < 4; ++a) {
    const int* at = kTet.of2[a];
    l[a] = u[0] * q[static_cast<std::size_t>(at[0])] + u[1] * q[static_cast<std::size_t>(at[1])] +
           u[2] * q[static_cast<std::size_t>(at[2])] + u[3] * q[static_cast<std::size_t>(at[3])];
  }
  return l;
}
constexpr double contract(const TetLinear& l, const TetBarycentric& u) {
  return u[0] * l[0] + u[1] * l[1] + u[2] * l[2] + u[3] * l[3];
}

/// The polar form (blossom): symmetric, linear in each argument, c(u, u, u) is the value.
constexpr double blossom(const TetCubic& c, const TetBarycentric& u, const TetBarycentric& v, const TetBarycentric& w) {
  return contract(contract(contract(c, u), v), w);
}

constexpr double evaluate(const TetCubic& c, const TetBarycentric& u) {
  return blossom(c, u, u, u);
}

/// Smallest and largest ordinate: they enclose the cubic's range on the tetrahedron.
constexpr std::pair<double, double> bounds(const TetCubic& c) {
  const auto [low, high] = std::minmax_element(c.begin(), c.end());
  return {*low, *high};
}

/// A tetrahedron's geometry as evaluation needs it.
struct TetFrame {
  Vec3 corner;                    ///< corner 0
  std::array<Vec3, 4> gradients;  ///< of the barycentric coordinates
  double volume6 = 0;             ///< six times the signed volume

  TetFrame() = default;
  TetFrame(Vec3 a, Vec3 b, Vec3 c, Vec3 d) : corner(a) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    volume6 = dot(u, cross(v, w));
    gradients[1] = cross(v, w) / volume6;
    gradients[2] = cross(w, u) / volume6;
    gradients[3] = cross(u, v) / volume6;
    gradients[0] = -(gradients[1] + gradients[2] + gradients[3]);
  }

  TetBarycentric barycentric(Vec3 p) const {
    TetBarycentric b = direction(p - corner);
    b[0] = 1 - b[1] - b[2] - b[3];
    return b;
  }
  /// How the barycentric coordinates change along `d`.
  TetBarycentric direction(Vec3 d) const {
    return {dot(gradients[0], d), dot(gradients[1], d), dot(gradients[2], d), dot(gradients[3], d)};
  }
};

/// Value, gradient and second derivatives (xx, yy, zz, xy, xz, yz) of a function of space.
struct Jet3 {
  double value = 0;
  Vec3 gradient;
  std::array<double, 6> hessian{};
};

/// Value and gradient only.
inline Jet3 evaluate_gradient(const TetCubic& c, const TetFrame& frame, const TetBarycentric& u) {
  const TetLinear l = contract(contract(c, u), u);
  Jet3 jet;
  jet.value = contract(l, u);
  jet.gradient = 3 * (l[0] * frame.gradients[0] + l[1] * frame.gradients[1] + l[2] * frame.gradients[2] +
                      l[3] * frame.gradients[3]);
  return jet;
}

inline Jet3 evaluate_jet(const TetCubic& c, const TetFrame& frame, const TetBarycentric& u) {
  Jet3 jet = evaluate_gradient(c, frame, u);
  const TetQuadratic q = contract(c, u);
  const std::array<TetBarycentric, 3> axes = {frame.direction({1, 0, 0}), frame.direction({0, 1, 0}),
                                              frame.direction({0, 0, 1})};
  constexpr std::array<std::pair<std::size_t, std::size_t>, 6> pairs = {
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  for (std::size_t n = 0; n < 6; ++n)
    jet.hessian[n] = 6 * contract(contract(q, axes[pairs[n].first]), axes[pairs[n].second]);
  return jet;
}

}  // namespace retalho
