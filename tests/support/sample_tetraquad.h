// A small TetraQuad surface for tests of files and pictures. Include as "support/sample_tetraquad.h".
#pragma once

#include "retalho/tetraquad/tetraquad.h"

namespace retalho::test {

/// The distance's quadric of a sphere of radius 0.8 about (0.1, 0, 0).
inline Jet3 sample_sphere(Vec3 p) {
  const Vec3 d = p - Vec3{0.1, 0, 0};
  Jet3 jet;
  jet.value = (norm2(d) - 0.64) / 1.6;
  jet.gradient = d / 0.8;
  jet.hessian = {1.25, 1.25, 1.25, 0, 0, 0};
  return jet;
}

/// A sphere of radius 0.8 about (0.1, 0, 0) in 2 x 2 x 2 cubes of edge 1 about it.
inline TetraQuad sample_tetraquad(TetSplit split = TetSplit::five, int half = 1) {
  std::vector<TetPlace> places;
  for (int i = -half; i < half; ++i)
    for (int j = -half; j < half; ++j)
      for (int k = -half; k < half; ++k)
        for (int t = 0; t < tets_of_cube(split); ++t) places.push_back({{i, j, k}, static_cast<std::uint8_t>(t)});
  return quasi_interpolant(make_tet_mesh({0, 0, 0}, 1.0 / half, split, places), sample_sphere);
}

/// The same sphere in cubes of edge 1, the tetrahedra that it crosses bisected `rounds` times on one side; those that
/// it does not cross are left out.
inline TetraQuad sample_adaptive_tetraquad(int rounds = 2) {
  std::vector<LatticePoint> cubes;
  cubes.reserve(8);
  for (int n = 0; n < 8; ++n) cubes.push_back({n % 2 - 1, n / 2 % 2 - 1, n / 4 - 1});
  auto forest = std::make_shared<TetForest>(cubes);
  const auto crossed = [&](std::vector<std::uint32_t> leaves) {
    const TetraQuad all =
        quasi_interpolant(make_tet_mesh({0, 0, 0}, 1.0 / TetForest::kUnit, forest, leaves), sample_sphere);
    const TetraQuadField field(all);
    std::size_t t = 0;
    std::erase_if(leaves, [&](std::uint32_t) { return !field.may_cross(t++); });
    return leaves;
  };
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint32_t> chosen = crossed(forest->leaves());
    std::erase_if(chosen, [&](std::uint32_t n) { return forest->vertices()[forest->nodes()[n].corners[0]][0] < 0; });
    forest->bisect(chosen);
  }
  return quasi_interpolant(make_tet_mesh({0, 0, 0}, 1.0 / TetForest::kUnit, forest, crossed(forest->leaves())),
                           sample_sphere);
}

}  // namespace retalho::test
