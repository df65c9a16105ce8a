// The slow, obvious evaluator: every triangle is tried, every piece is tried, and the Bernstein sum is written out with
// factorials in long double. It shares nothing with the code under test but triangle_patches.
#pragma once

#include <algorithm>
#include <optional>

#include "retalho/terrain/terrain.h"

namespace retalho::test {

inline long double bernstein_sum(const TerrainPatch& patch, long double r, long double s, long double t) {
  const auto factorial = [](int n) { return n < 2 ? 1 : n == 2 ? 2 : 6; };
  const auto power = [](long double x, int n) {
    long double result = 1;
    for (int k = 0; k < n; ++k) result *= x;
    return result;
  };
  long double sum = 0;
  std::size_t at = 0;
  for (int i = patch.degree; i >= 0; --i)
    for (int j = patch.degree - i; j >= 0; --j, ++at) {
      const int k = patch.degree - i - j;
      sum += static_cast<long double>(factorial(patch.degree)) / (factorial(i) * factorial(j) * factorial(k)) *
             power(r, i) * power(s, j) * power(t, k) * static_cast<long double>(patch.ordinates[at]);
    }
  return sum;
}

struct PieceAt {
  std::uint32_t triangle;
  TerrainPatch patch;
  long double r, s, t;
  long double value() const { return bernstein_sum(patch, r, s, t); }
};

inline void barycentric_long(const TerrainPatch& patch, Vec2 p, long double& r, long double& s, long double& t) {
  const auto [a, b, c] = patch.corners;
  const auto cross_long = [](Vec2 o, Vec2 u, Vec2 v) {
    return (static_cast<long double>(u.x) - o.x) * (static_cast<long double>(v.y) - o.y) -
           (static_cast<long double>(u.y) - o.y) * (static_cast<long double>(v.x) - o.x);
  };
  const long double area2 = cross_long(a, b, c);
  r = cross_long(p, b, c) / area2;
  s = cross_long(p, c, a) / area2;
  t = cross_long(p, a, b) / area2;
}

/// The piece whose smallest barycentric coordinate at `p` is largest; nullopt where that is below -1e-12.
inline std::optional<PieceAt> find_piece(const Terrain& terrain, const EdgeTable& edges, Vec2 p) {
  std::optional<PieceAt> best;
  long double most = -1e-12L;
  std::array<TerrainPatch, 6> patches;
  for (std::uint32_t t = 0; t < terrain.tin.triangle_count(); ++t) {
    const int n = triangle_patches(terrain, edges, t, patches);
    for (int k = 0; k < n; ++k) {
      PieceAt at{t, patches[static_cast<std::size_t>(k)], 0, 0, 0};
      barycentric_long(at.patch, p, at.r, at.s, at.t);
      const long double least = std::min({at.r, at.s, at.t});
      if (least < most || (best && least == most)) continue;
      most = least;
      best = at;
    }
  }
  return best;
}

}  // namespace retalho::test
