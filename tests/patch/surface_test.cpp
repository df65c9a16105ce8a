// The three recoveries: orders, exact sides and nodes, continuity, derivatives; point location.
#include <gtest/gtest.h>

#include <chrono>

#include "patch/comparison.h"
#include "patch/support.h"
#include "patch/surfaces.h"
#include "retalho/core/error.h"
#include "retalho/patch/surface.h"
#include "support/support.h"

namespace retalho::test {
namespace {

double largest_error(const Surface& truth, const PatchSurface& surface, int points = 6000) {
  std::mt19937_64 random(3);
  double worst = 0;
  for (int k = 0; k < points; ++k) {
    const Vec2 uv = random_parameters(random);
    worst = std::max(worst, norm(surface.point(uv) - truth(uv).point));
  }
  return worst;
}

TEST(Smooth, FourthOrderOnTheSheetsSurfaces) {
  for (const Surface& truth : {Surface(octant), Surface(sine)}) {
    const Patch coarse = natural_patch(truth, regular_domain(32), Recovery::smooth);
    const Patch fine = natural_patch(truth, regular_domain(64), Recovery::smooth);
    const double e32 = largest_error(truth, PatchSurface(coarse)), e64 = largest_error(truth, PatchSurface(fine));
    EXPECT_LE(e64, 3.5e-7);
    EXPECT_GE(std::log2(e32 / e64), 3.8);
  }
  const Patch irregular = natural_patch(octant, irregular_domain(64, 1), Recovery::smooth);
  EXPECT_LE(largest_error(octant, PatchSurface(irregular)), 2e-6);
}

TEST(Smooth, CubicSurfacesAreReproduced) {
  for (const bool regular : {true, false}) {
    const Patch patch = natural_patch(monkey, regular ? regular_domain(32) : irregular_domain(32, 2), Recovery::smooth);
    EXPECT_LE(largest_error(monkey, PatchSurface(patch)), 1e-11) << regular;
  }
}

TEST(Smooth, MeetsItsNodesAndSidesExactly) {
  for (const bool regular : {true, false}) {
    const Patch patch = natural_patch(sine, regular ? regular_domain(64) : irregular_domain(64, 5), Recovery::smooth);
    const PatchSurface surface(patch);
    EXPECT_LE(side_gap(patch, surface), 1e-14 * control_size(patch.positions)) << regular;
    for (std::size_t i = 0; i < patch.positions.size(); ++i)
      EXPECT_LE(norm(surface.point(patch.domain.parameters[i]) - patch.positions[i]), 2e-14);
  }
}

TEST(Smooth, IsC1AcrossEdges) {
  for (const bool regular : {true, false}) {
    const Patch patch = natural_patch(octant, regular ? regular_domain(32) : irregular_domain(32, 5), Recovery::smooth);
    EXPECT_LE(gradient_jump(patch, PatchSurface(patch)), 1e-11) << regular;
  }
}

TEST(Smooth, IsC1AtSideNodes) {
  const Patch patch = natural_patch(octant, irregular_domain(16, 5), Recovery::smooth);
  const PatchSurface surface(patch);
  for (const std::uint32_t v : patch.domain.sides[0]) {
    const Vec2 at = patch.domain.parameters[v];
    if (at.x < 0.05 || at.y < 0.05) continue;
    double spread[2] = {0, 0};
    for (int level = 0; level < 2; ++level) {
      const double r = level == 0 ? 1e-4 : 1e-5;
      const SurfaceJet first = surface.jet(at + r * Vec2{-1, 0});
      for (const Vec2 d : {Vec2{0, -1}, Vec2{-0.7, -0.7}, Vec2{-0.9, 0.5}, Vec2{0.5, -0.9}}) {
        const SurfaceJet other = surface.jet(at + r * d);
        spread[level] = std::max({spread[level], norm(first.du - other.du), norm(first.dv - other.dv)});
      }
    }
    EXPECT_LE(spread[1], 0.2 * spread[0] + 1e-10);  // shrinks with the circle
  }
}

TEST(Recoveries, DerivativesAreThoseOfThePoint) {
  for (const Recovery recovery : {Recovery::barycentric, Recovery::spr, Recovery::smooth}) {
    const Patch patch = natural_patch(sine, irregular_domain(12, 4), recovery);
    const PatchSurface surface(patch);
    std::mt19937_64 random(test_seed());
    for (int k = 0; k < 400; ++k) {
      const Vec2 uv = random_parameters(random);
      const double h = 1e-6;
      if (uv.x < 1e-4 || uv.y < 1e-4 || uv.x + uv.y > 1 - 1e-4) continue;
      const std::uint32_t t = surface.locator().locate(uv).triangle;
      bool same = true;  // differences within one micro-triangle
      const auto micro = [&](Vec2 p) {
        const DomainPlace q = surface.locator().locate(p);
        return std::pair(q.triangle, q.l1 < q.l2 ? (q.l1 < q.l3 ? 0 : 2) : (q.l2 < q.l3 ? 1 : 2));
      };
      for (const Vec2 d : {Vec2{h, 0}, Vec2{-h, 0}, Vec2{0, h}, Vec2{0, -h}})
        same = same && micro(uv + 10 * d) == micro(uv) && micro(uv).first == t;
      if (!same) continue;
      const PatchJet jet = surface.full_jet(uv);
      const auto difference = [&](auto&& f, Vec2 d) { return (f(uv + d) - f(uv - d)) / (2 * h); };
      const auto point = [&](Vec2 p) { return surface.point(p); };
      const auto du = [&](Vec2 p) { return surface.jet(p).du; };
      const auto dv = [&](Vec2 p) { return surface.jet(p).dv; };
      EXPECT_LE(norm(jet.du - difference(point, {h, 0})), 1e-7);
      EXPECT_LE(norm(jet.dv - difference(point, {0, h})), 1e-7);
      EXPECT_LE(norm(jet.duu - difference(du, {h, 0})), 1e-5);
      EXPECT_LE(norm(jet.duv - difference(du, {0, h})), 1e-5);
      EXPECT_LE(norm(jet.dvv - difference(dv, {0, h})), 1e-5);
      EXPECT_NEAR(norm(jet.normal), 1, 1e-14);
    }
  }
}

TEST(Recoveries, CurvatureOfTheSphere) {
  const PatchSurface surface(natural_patch(octant, regular_domain(48), Recovery::smooth));
  for (const Vec2 uv : {Vec2{0.3, 0.3}, Vec2{0.2, 0.5}, Vec2{0.61, 0.17}}) {
    const PatchCurvature c = surface.curvature(uv);
    EXPECT_NEAR(c.gaussian, 1, 0.02);
    EXPECT_NEAR(std::abs(c.mean), 1, 0.01);
  }
}

TEST(Spr, IsContinuousAndThirdOrderButNotC1) {
  const Patch coarse = natural_patch(octant, regular_domain(32), Recovery::spr),
              fine = natural_patch(octant, regular_domain(64), Recovery::spr);
  const PatchSurface c(coarse), f(fine);
  EXPECT_LE(largest_error(octant, f), 4e-5);
  EXPECT_GE(std::log2(largest_error(octant, c) / largest_error(octant, f)), 2.5);
  EXPECT_GT(gradient_jump(fine, f), 1e-4);
  EXPECT_GT(side_gap(fine, f), 1e-7);
  // Patches are disjoint, and there is one for about seven triangles.
  const double smooth_error = norm(f.shading_normal({0.31, 0.33}) - normalized(octant({0.31, 0.33}).point));
  EXPECT_LE(smooth_error, 5e-3);
}

TEST(Recoveries, WorkOnTheSmallestMeshes) {
  std::mt19937_64 random(test_seed());
  const PatchSides sides = CubicTriangle(random).sides();
  for (const Recovery recovery : {Recovery::barycentric, Recovery::spr, Recovery::smooth})
    for (const std::array<std::size_t, 3>& n :
         {std::array<std::size_t, 3>{1, 1, 1}, {2, 2, 2}, {1, 1, 2}, {3, 3, 3}, {1, 2, 5}}) {
      const Patch patch = make_patch(sides, {.divisions = n, .recovery = recovery});
      const PatchSurface surface(patch);
      for (int k = 0; k < 50; ++k) {
        const PatchJet jet = surface.full_jet(random_parameters(random));
        EXPECT_TRUE(std::isfinite(norm(jet.point)) && std::isfinite(norm(jet.du)) && std::isfinite(norm(jet.dvv)));
        EXPECT_LE(norm(jet.point), 5);
      }
      if (recovery == Recovery::smooth) {
        EXPECT_LE(side_gap(patch, surface), 2e-14);
      }
    }
}

TEST(Recoveries, ADraggedSideIsTheSameAsANewSurface) {
  std::mt19937_64 random(test_seed());
  const PatchSides before = CubicTriangle(random).sides(), after = CubicTriangle(random).sides();
  for (const Recovery recovery : {Recovery::barycentric, Recovery::spr, Recovery::smooth}) {
    Patch patch = make_patch(before, {.divisions = {24, 24, 24}, .recovery = recovery});
    PatchSurface surface(patch);
    move_sides(patch, after);
    surface.move(patch);
    const PatchSurface fresh(make_patch(after, {.divisions = {24, 24, 24}, .recovery = recovery}));
    for (int k = 0; k < 200; ++k) {
      const Vec2 uv = random_parameters(random);
      EXPECT_EQ(surface.point(uv), fresh.point(uv));
    }
    EXPECT_THROW(surface.move(make_patch(after, {.divisions = {25, 25, 25}, .recovery = recovery})), UsageError);
  }
}

TEST(Locator, FindsTheTriangleThatHoldsThePoint) {
  std::mt19937_64 random(test_seed());
  for (const Domain& domain :
       {regular_domain(1), regular_domain(50), irregular_domain(40, 9), make_domain({3, 60, 7})}) {
    const DomainLocator locator(domain);
    for (int k = 0; k < 20000; ++k) {
      const Vec2 p = random_parameters(random);
      const DomainPlace place = locator.locate(p);
      EXPECT_GE(std::min({place.l1, place.l2, place.l3}), -1e-12);
      const auto& t = domain.triangles[place.triangle];
      const Vec2 q =
          place.l1 * domain.parameters[t[0]] + place.l2 * domain.parameters[t[1]] + place.l3 * domain.parameters[t[2]];
      EXPECT_LE(norm(p - q), 1e-12);
      EXPECT_TRUE(place.inside);
    }
    for (const Vec2& p : domain.parameters) {
      const DomainPlace place = locator.locate(p);
      EXPECT_GE(std::min({place.l1, place.l2, place.l3}), -1e-12);
    }
  }
}

TEST(Locator, OutsideTheNearestPointAnswers) {
  const DomainLocator locator(regular_domain(7));
  EXPECT_FALSE(locator.locate({0.7, 0.7}).inside);
  EXPECT_EQ(clamp_to_domain({0.7, 0.7}), (Vec2{0.5, 0.5}));
  EXPECT_EQ(clamp_to_domain({-1, 0.5}), (Vec2{0, 0.5}));
  EXPECT_EQ(clamp_to_domain({3, -1}), (Vec2{1, 0}));
  EXPECT_EQ(clamp_to_domain({-0.5, 9}), (Vec2{0, 1}));
}

}  // namespace
}  // namespace retalho::test
