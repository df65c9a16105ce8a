// Two small patches that share a side, for tests of files and pictures. Include as "support/sample_patches.h".
#pragma once

#include "retalho/patch/patch.h"

namespace retalho::test {

inline PatchSet sample_patches(std::size_t divisions) {
  const auto bezier = [](std::vector<Vec3> points, std::vector<double> weights = {}) {
    return make_bezier(points, static_cast<int>(points.size()) - 1, 3, weights);
  };
  const Curve shared = bezier({{1, 0, 0}, {0.8, 0.7, 0.3}, {0, 1, 0}}, {1, 0.8, 1});
  PatchSet set;
  set.patches.push_back(make_patch({SideCurve(shared), SideCurve(bezier({{0, 1, 0}, {0, 0, 0}})),
                                    SideCurve(bezier({{0, 0, 0}, {0.5, 0, 0.2}, {1, 0, 0}}))},
                                   {.divisions = {divisions, divisions, divisions}}));
  set.patches[0].name = "left";
  set.patches.push_back(
      make_patch({SideCurve(shared, true),
                  SideCurve(bezier({{1, 0, 0}, {1.2, 0.5, 0.4}, {1, 1, 0}}), false, SidePlacement::arc_length),
                  SideCurve(bezier({{1, 1, 0}, {0, 1, 0}}))},
                 {.divisions = {divisions, divisions + 1, divisions + 2}, .recovery = Recovery::spr}));
  return set;
}

}  // namespace retalho::test
