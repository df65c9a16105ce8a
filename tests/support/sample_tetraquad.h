// A small TetraQuad surface for tests of files and pictures. Include as "support/sample_tetraquad.h".
#pragma once

#include "retalho/tetraquad/tetraquad.h"

namespace retalho::test {

/// A sphere of radius 0.8 about (0.1, 0, 0) in 2 x 2 x 2 cubes of edge 1 about it.
inline TetraQuad sample_tetraquad(TetSplit split = TetSplit::five, int half = 1) {
  std::vector<TetPlace> places;
  for (int i = -half; i < half; ++i)
    for (int j = -half; j < half; ++j)
      for (int k = -half; k < half; ++k)
        for (int t = 0; t < tets_of_cube(split); ++t) places.push_back({{i, j, k}, static_cast<std::uint8_t>(t)});
  return quasi_interpolant(make_tet_mesh({0, 0, 0}, 1.0 / half, split, places), [](Vec3 p) {
    const Vec3 d = p - Vec3{0.1, 0, 0};
    Jet3 jet;
    jet.value = (norm2(d) - 0.64) / 1.6;
    jet.gradient = d / 0.8;
    jet.hessian = {1.25, 1.25, 1.25, 0, 0, 0};
    return jet;
  });
}

}  // namespace retalho::test
