// Where an edge of a polynomial patch is cut so that chords stand for it: halved until its ordinates lie close enough
// to the chord. The decision needs nothing but the edge's own ordinates, so both sides of a shared edge come to the
// same cuts. Internal to the room.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "retalho/bernstein/triangle.h"

namespace retalho {

/// Ordinates of one edge, from its first end to its last.
template <int Degree>
using EdgeNet = std::array<double, static_cast<std::size_t>(Degree) + 1>;

/// How far an ordinate lies from the chord's at most. The edge itself is within 1/2 (degree 2), 3/4 (3) of that.
inline double chord_deviation(const EdgeNet<2>& b) {
  return std::abs(b[1] - (b[0] + b[2]) / 2);
}
inline double chord_deviation(const EdgeNet<3>& b) {
  return std::max(std::abs(b[1] - (2 * b[0] + b[3]) / 3), std::abs(b[2] - (b[0] + 2 * b[3]) / 3));
}

/// The two halves (de Casteljau at 1/2). Only means of two numbers, so a reversed edge gives the same bits reversed.
inline void halve(const EdgeNet<2>& b, EdgeNet<2>& left, EdgeNet<2>& right) {
  const double l = (b[0] + b[1]) / 2, r = (b[1] + b[2]) / 2, m = (l + r) / 2;
  left = {b[0], l, m};
  right = {m, r, b[2]};
}
inline void halve(const EdgeNet<3>& b, EdgeNet<3>& left, EdgeNet<3>& right) {
  const double l = (b[0] + b[1]) / 2, c = (b[1] + b[2]) / 2, r = (b[2] + b[3]) / 2;
  const double lc = (l + c) / 2, cr = (c + r) / 2, m = (lc + cr) / 2;
  left = {b[0], l, lc, m};
  right = {m, cr, r, b[3]};
}

/// What a patch asks of its pieces for a vertical tolerance.
template <int Degree>
struct CutRule {
  double tolerance;

  /// An edge over this is halved. Degree 2: the linear interpolant of a triangle whose edges deviate by at most c is
  /// within 2 (rs + st + tr) c <= 2/3 c of the surface: c = 3/2 tolerance proves it. Degree 3: see proven().
  double largest_deviation() const { return (Degree == 2 ? 1.5 : 0.92) * tolerance; }
  bool cuts(const EdgeNet<Degree>& b) const { return chord_deviation(b) > largest_deviation(); }

  /// Is the flat triangle proven to be within the tolerance, its edges being uncut? Degree 3: the basis functions of
  /// the edges' ordinates add up to 3 (rs + st + tr) - 9 rst <= 3/4, the inner one's are 6 rst <= 2/9.
  bool proven(const TriangleNet<Degree>& net, double edge_deviation) const {
    if constexpr (Degree == 2) {
      return true;
    } else {
      const double inner = std::abs(net[static_cast<std::size_t>(ordinate_index(3, 1, 1))] -
                                    (net[static_cast<std::size_t>(ordinate_index(3, 3, 0))] +
                                     net[static_cast<std::size_t>(ordinate_index(3, 0, 3))] +
                                     net[static_cast<std::size_t>(ordinate_index(3, 0, 0))]) /
                                        3);
      return 0.75 * edge_deviation + 2.0 / 9 * inner <= tolerance;
    }
  }
};

/// Halving more often than this would tell points apart that doubles do not.
inline constexpr int kDeepestCut = 30;

/// How many vertices the cuts put inside the edge.
template <int Degree>
std::uint64_t count_cuts(const CutRule<Degree>& rule, const EdgeNet<Degree>& net, int depth = 0) {
  if (depth >= kDeepestCut || !rule.cuts(net)) return 0;
  EdgeNet<Degree> left, right;
  halve(net, left, right);
  return 1 + count_cuts(rule, left, depth + 1) + count_cuts(rule, right, depth + 1);
}

/// The triangle whose corner `corner` moves to `u` (barycentric in the old one): the ordinates of the same polynomial
/// on it, from the steps of de Casteljau's scheme.
template <int Degree>
TriangleNet<Degree> move_corner(const TriangleNet<Degree>& net, int corner, Barycentric u) {
  TriangleNet<Degree> out{};
  const auto take = [&](const auto& level, int remaining) {
    // Ordinates of the level that no longer lean on the moved corner: the new ones with Degree - remaining of it.
    for (int a = 0; a <= remaining; ++a) {
      const int b = remaining - a;
      std::array<int, 3> from{}, to{};
      from[static_cast<std::size_t>((corner + 1) % 3)] = to[static_cast<std::size_t>((corner + 1) % 3)] = a;
      from[static_cast<std::size_t>((corner + 2) % 3)] = to[static_cast<std::size_t>((corner + 2) % 3)] = b;
      to[static_cast<std::size_t>(corner)] = Degree - remaining;
      out[static_cast<std::size_t>(ordinate_index(Degree, to[0], to[1]))] =
          level[static_cast<std::size_t>(ordinate_index(remaining, from[0], from[1]))];
    }
  };
  take(net, Degree);
  const TriangleNet<Degree - 1> one = casteljau_step<Degree>(net, u);
  take(one, Degree - 1);
  if constexpr (Degree == 2) {
    take(casteljau_step<1>(one, u), 0);
  } else if constexpr (Degree == 3) {
    const TriangleNet<1> two = casteljau_step<2>(one, u);
    take(two, 1);
    take(casteljau_step<1>(two, u), 0);
  }
  return out;
}

/// The same polynomial with the triangle's corners in another order: the new corner k is the old one k + by (modulo 3).
template <int Degree>
TriangleNet<Degree> rotated_net(const TriangleNet<Degree>& net, int by) {
  if (by == 0) return net;
  TriangleNet<Degree> out{};
  for (int i = 0; i <= Degree; ++i)
    for (int j = 0; i + j <= Degree; ++j) {
      const std::array<int, 3> at{i, j, Degree - i - j};
      std::array<int, 3> from{};
      for (int k = 0; k < 3; ++k) from[static_cast<std::size_t>((k + by) % 3)] = at[static_cast<std::size_t>(k)];
      out[static_cast<std::size_t>(ordinate_index(Degree, i, j))] =
          net[static_cast<std::size_t>(ordinate_index(Degree, from[0], from[1]))];
    }
  return out;
}

/// Ordinates along the edge from corner `from` to corner `to`.
template <int Degree>
EdgeNet<Degree> edge_of(const TriangleNet<Degree>& net, int from, int to) {
  EdgeNet<Degree> edge{};
  for (int m = 0; m <= Degree; ++m) {
    std::array<int, 3> at{};
    at[static_cast<std::size_t>(from)] = Degree - m;
    at[static_cast<std::size_t>(to)] = m;
    edge[static_cast<std::size_t>(m)] = net[static_cast<std::size_t>(ordinate_index(Degree, at[0], at[1]))];
  }
  return edge;
}

}  // namespace retalho
