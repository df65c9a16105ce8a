// Triangular patches in model files.
#include <gtest/gtest.h>

#include <cmath>

#include "retalho/core/error.h"
#include "retalho/model/check.h"
#include "retalho/model/model.h"
#include "retalho/patch/surface.h"
#include "support/sample_patches.h"
#include "support/support.h"

namespace retalho {
namespace {

TEST(PatchModel, ComesBackToTheBit) {
  const PatchSet set = test::sample_patches(9);
  const test::ScratchFolder folder;
  save_model(set, folder / "s.retalho");
  const auto again = std::get<PatchSet>(load_model(folder / "s.retalho"));
  ASSERT_EQ(again.patches.size(), set.patches.size());
  for (std::size_t i = 0; i < set.patches.size(); ++i) {
    const Patch &a = set.patches[i], &b = again.patches[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.recovery, b.recovery);
    EXPECT_EQ(a.domain.parameters, b.domain.parameters);
    EXPECT_EQ(a.domain.triangles, b.domain.triangles);
    EXPECT_EQ(a.domain.sides, b.domain.sides);
    EXPECT_EQ(a.positions, b.positions);
    for (std::size_t s = 0; s < 3; ++s) {
      EXPECT_EQ(a.sides[s].curve().points, b.sides[s].curve().points);
      EXPECT_EQ(a.sides[s].curve().weights, b.sides[s].curve().weights);
      EXPECT_EQ(a.sides[s].curve().breaks, b.sides[s].curve().breaks);
      EXPECT_EQ(a.sides[s].reversed(), b.sides[s].reversed());
      EXPECT_EQ(a.sides[s].placement(), b.sides[s].placement());
    }
    const PatchSurface x(a), y(b);  // and so the surfaces are the same
    for (const Vec2 uv : {Vec2{0.3, 0.3}, Vec2{0.01, 0.5}, Vec2{0.7, 0.1}}) EXPECT_EQ(x.point(uv), y.point(uv));
  }
  EXPECT_EQ(encode_model(again), encode_model(set));
}

TEST(PatchModel, OnesWithFaultsAreNotSaved) {
  const auto refused = [](auto&& damage) {
    PatchSet set = test::sample_patches(4);
    damage(set.patches[1]);
    EXPECT_NE(find_fault(set), "");
    EXPECT_THROW(encode_model(set), BadInput);
  };
  refused([](Patch& p) { p.positions[3].y = NAN; });
  refused([](Patch& p) { p.positions.pop_back(); });
  refused([](Patch& p) { std::swap(p.domain.triangles[2][0], p.domain.triangles[2][1]); });
  refused([](Patch& p) { p.domain.triangles.pop_back(); });
  refused([](Patch& p) { std::swap(p.domain.sides[0][1], p.domain.sides[0][2]); });
  refused([](Patch& p) { p.domain.parameters[0].x += 0.5; });
  refused([](Patch& p) { p.sides[1] = p.sides[0]; });
  refused([](Patch& p) { p.sides[0] = SideCurve([](double) { return SideJet{}; }); });
  EXPECT_THROW(encode_model(PatchSet{}), BadInput);
}

}  // namespace
}  // namespace retalho
