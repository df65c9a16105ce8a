// A surface on one triangle as a linear function of what its corners store: every ordinate is a row of the 9 (linear:
// 3) unknowns (z, dz/dx, dz/dy of each corner). The rows come from the surface's own element, asked for each unknown
// alone, so the fit and the evaluation can never mean different surfaces. Internal to terrain/.
#pragma once

#include <array>

#include "retalho/terrain/corners.h"
#include "retalho/terrain/evaluator_parts.h"
#include "retalho/terrain/row_fan.h"

namespace retalho {

/// A triangle of the mesh, ready for its element.
struct FitTriangle {
  std::array<std::uint32_t, 3> vertex{};
  Corners at;                                  ///< cell coordinates
  Corners corner;                              ///< units of the fit
  std::array<double, 3> split{0.5, 0.5, 0.5};  ///< Powell-Sabin: of edge k, from the end with the lower vertex number
  std::uint8_t folded = 0;                     ///< Clough-Tocher: bit k is corner k (folds.h)
};

/// The element of a kind on given corner data.
template <class Element>
Element make_element(const TriangleCorners& c, const FitTriangle& t);
template <>
inline LinearElement make_element<LinearElement>(const TriangleCorners& c, const FitTriangle&) {
  return {c.height};
}
template <>
inline PowellSabinElement make_element<PowellSabinElement>(const TriangleCorners& c, const FitTriangle& t) {
  return powell_sabin_element(c, t.split);
}
template <>
inline CloughTocherElement make_element<CloughTocherElement>(const TriangleCorners& c, const FitTriangle&) {
  return clough_tocher_element(c);
}

/// Share of the triangle's area that a piece has.
inline double piece_share(const LinearElement&, int) {
  return 1;
}
inline double piece_share(const CloughTocherElement&, int) {
  return 1.0 / 3;
}
inline double piece_share(const PowellSabinElement& e, int piece) {
  const auto k = static_cast<std::size_t>(piece / 2);
  return e.weight[k] * (piece % 2 == 0 ? e.split[k] : 1 - e.split[k]);
}

/// Bernstein polynomials at `u`, in the order of the ordinates.
template <int Degree>
inline TriangleNet<Degree> bernstein(Barycentric u) {
  if constexpr (Degree == 0) {
    return {1};
  } else if constexpr (Degree == 1) {
    return {u.r, u.s, u.t};
  } else if constexpr (Degree == 2) {
    return {u.r * u.r, 2 * u.r * u.s, 2 * u.r * u.t, u.s * u.s, 2 * u.s * u.t, u.t * u.t};
  } else {
    static_assert(Degree == 3);
    const double rr = u.r * u.r, ss = u.s * u.s, tt = u.t * u.t;
    return {u.r * rr,     3 * rr * u.s, 3 * rr * u.t, 3 * u.r * ss, 6 * u.r * u.s * u.t,
            3 * u.r * tt, u.s * ss,     3 * ss * u.t, 3 * u.s * tt, u.t * tt};
  }
}

/// `Unknowns` rows: 9 (all corners), or 3 (the heights of a flat triangle).
template <class Element>
struct FitBasis {
  static constexpr int kDegree = Element::kDegree;
  static constexpr std::size_t kPieces = Element::kPieces;
  static constexpr std::size_t kUnknowns = kDegree == 1 ? 3 : 9;
  static constexpr std::size_t kOrdinates = static_cast<std::size_t>(ordinate_count(kDegree));
  static constexpr std::size_t kSlopes = static_cast<std::size_t>(ordinate_count(kDegree - 1));
  using Row = std::array<double, kUnknowns>;
  using Net = std::array<Row, kOrdinates>;
  using SlopeNet = std::array<Row, kSlopes>;

  Element shape;  ///< of zero data: how the triangle is cut
  MacroTriangle macro;
  double area;
  std::array<Net, kPieces> value;
  std::array<std::array<SlopeNet, 2>, kPieces> slope;  ///< d/dx and d/dy

  explicit FitBasis(const FitTriangle& t)
      : macro(t.corner), area(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]) / 2) {
    TriangleCorners c;
    c.vertex = t.vertex;
    c.point = t.corner;
    shape = make_element<Element>(c, t);
    for (std::size_t u = 0; u < kUnknowns; ++u) {
      TriangleCorners one = c;
      const std::size_t corner = kUnknowns == 3 ? u : u / 3, what = kUnknowns == 3 ? 0 : u % 3;
      (what == 0 ? one.height[corner] : what == 1 ? one.gradient[corner].x : one.gradient[corner].y) = 1;
      const Element e = make_element<Element>(one, t);
      for (std::size_t p = 0; p < kPieces; ++p) {
        const auto net = e.net(static_cast<int>(p));
        for (std::size_t o = 0; o < kOrdinates; ++o) value[p][o][u] = net[o];
      }
    }
    for (std::size_t p = 0; p < kPieces; ++p) {
      const typename Element::Map map(shape, static_cast<int>(p));
      slope[p] = {derivative<kDegree>(value[p], map(macro.along_x(1))),
                  derivative<kDegree>(value[p], map(macro.along_y()))};
    }
  }

  /// The net of the derivative along `d`, of nets whose entries are rows.
  template <int Degree>
  static std::array<Row, static_cast<std::size_t>(ordinate_count(Degree - 1))> derivative(
      const std::array<Row, static_cast<std::size_t>(ordinate_count(Degree))>& b, Barycentric d) {
    std::array<Row, static_cast<std::size_t>(ordinate_count(Degree - 1))> c;
    for (int i = Degree - 1; i >= 0; --i)
      for (int j = Degree - 1 - i; j >= 0; --j) {
        const Row &r = b[static_cast<std::size_t>(ordinate_index(Degree, i + 1, j))],
                  &s = b[static_cast<std::size_t>(ordinate_index(Degree, i, j + 1))],
                  &t = b[static_cast<std::size_t>(ordinate_index(Degree, i, j))];
        Row& out = c[static_cast<std::size_t>(ordinate_index(Degree - 1, i, j))];
        for (std::size_t u = 0; u < kUnknowns; ++u) out[u] = Degree * (d.r * r[u] + d.s * s[u] + d.t * t[u]);
      }
    return c;
  }

  template <std::size_t N>
  static Row blend(const std::array<Row, N>& net, const std::array<double, N>& weights) {
    Row row{};
    for (std::size_t o = 0; o < N; ++o)
      for (std::size_t u = 0; u < kUnknowns; ++u) row[u] += weights[o] * net[o][u];
    return row;
  }
};

}  // namespace retalho
