// The three-sided map: exact sides, the Bézier triangle, derivatives, meshes with any counts, folds.
#include <gtest/gtest.h>

#include <algorithm>

#include "patch/support.h"
#include "retalho/core/error.h"
#include "retalho/mesh/patch_mesh.h"
#include "retalho/patch/patch.h"
#include "support/support.h"

namespace retalho::test {
namespace {

TEST(Transfinite, CubicSidesGiveTheCubicBezierTriangle) {
  std::mt19937_64 random(test_seed());
  for (int round = 0; round < 200; ++round) {
    const CubicTriangle cubic(random);
    const PatchSides sides = cubic.sides();
    for (int k = 0; k < 50; ++k) {
      const Vec2 uv = random_parameters(random);
      EXPECT_LE(norm(transfinite_point(sides, uv) - cubic.at(uv)), 1e-14);
    }
  }
}

TEST(Transfinite, RunsThroughItsSidesAndCorners) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> unit(0, 1);
  const PatchSides sides = CubicTriangle(random).sides();
  for (int side = 0; side < 3; ++side) {
    const SideCurve& curve = sides[static_cast<std::size_t>(side)];
    for (int k = 0; k < 100; ++k) {
      const double s = unit(random);
      EXPECT_LE(norm(transfinite_point(sides, side_parameters(side, s)) - curve.point(s)), 1e-14);
    }
    EXPECT_EQ(transfinite_point(sides, side_parameters(side, 0)), curve.start());
  }
}

TEST(Transfinite, DerivativesAreThoseOfThePoint) {
  std::mt19937_64 random(test_seed());
  const PatchSides sides = CubicTriangle(random).sides();
  const double h = 1e-5;
  for (int k = 0; k < 200; ++k) {
    Vec2 uv = random_parameters(random);
    uv = {0.01 + 0.97 * uv.x, 0.01 + 0.97 * uv.y};
    const SurfaceJet jet = transfinite_jet(sides, uv);
    const Vec3 du = (transfinite_point(sides, uv + Vec2{h, 0}) - transfinite_point(sides, uv - Vec2{h, 0})) / (2 * h);
    const Vec3 dv = (transfinite_point(sides, uv + Vec2{0, h}) - transfinite_point(sides, uv - Vec2{0, h})) / (2 * h);
    EXPECT_LE(norm(jet.du - du), 1e-8);
    EXPECT_LE(norm(jet.dv - dv), 1e-8);
  }
  // The gradient at a corner is that of its two side tangents, which is the limit.
  for (const auto& [corner, inwards] :
       {std::pair{Vec2{1, 0}, Vec2{-2, 1}}, std::pair{Vec2{0, 1}, Vec2{1, -2}}, std::pair{Vec2{0, 0}, Vec2{1, 1}}}) {
    const SurfaceJet at = transfinite_jet(sides, corner), near = transfinite_jet(sides, corner + 1e-7 * inwards);
    EXPECT_LE(norm(at.du - near.du), 1e-5);
    EXPECT_LE(norm(at.dv - near.dv), 1e-5);
  }
}

TEST(Transfinite, SidesByArcLengthHaveTheirSpeedsEverywhere) {
  const SideCurve side(make_bezier(std::vector<Vec3>{{0, 0, 0}, {1, 2, 0}, {3, 2, 1}, {4, 0, 0}}, 3, 3), false,
                       SidePlacement::arc_length);
  const double length = arc_length(side.curve());
  for (const double s : {0.1, 0.35, 0.8}) {
    const SideJet jet = side.jet(s);
    EXPECT_NEAR(norm(jet.first), length, 1e-9);
    const double h = 1e-5;
    EXPECT_LE(norm((side.jet(s + h).first - side.jet(s - h).first) / (2 * h) - jet.second), 1e-4);
  }
}

TEST(Domain, CountsOfTheRegularOne) {
  for (const std::size_t n : {1U, 2U, 7U, 40U}) {
    const Domain domain = regular_domain(n);
    EXPECT_EQ(domain.parameters.size(), (n + 1) * (n + 2) / 2);
    EXPECT_EQ(domain.triangles.size(), n * n);
  }
}

/// Covers the parameter triangle once, sides in order and exactly on their lines, no edge across a side.
void expect_good(const Domain& domain, const std::array<std::size_t, 3>& counts) {
  double area = 0;
  for (const auto& t : domain.triangles) {
    const Vec2 a = domain.parameters[t[0]], b = domain.parameters[t[1]], c = domain.parameters[t[2]];
    EXPECT_GT(cross(b - a, c - a), 0);
    area += cross(b - a, c - a);
  }
  EXPECT_NEAR(area, 1, 1e-12);
  std::size_t border = 0;
  for (int side = 0; side < 3; ++side) {
    const auto& nodes = domain.sides[static_cast<std::size_t>(side)];
    ASSERT_EQ(nodes.size(), counts[static_cast<std::size_t>(side)] + 1);
    border += nodes.size() - 1;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Vec2 p = domain.parameters[nodes[k]];
      EXPECT_TRUE(side == 0 ? p.x + p.y == 1 : side == 1 ? p.x == 0 : p.y == 0);
      EXPECT_NEAR(side_argument(side, p), static_cast<double>(k) / static_cast<double>(nodes.size() - 1), 1e-11);
    }
  }
  EXPECT_EQ(domain.triangles.size(), 2 * domain.parameters.size() - 2 - border);
}

TEST(Domain, AnyCountsByDelaunay) {
  for (const std::array<std::size_t, 3>& counts :
       {std::array<std::size_t, 3>{7, 12, 20}, {1, 1, 2}, {3, 50, 4}, {30, 31, 29}, {5, 5, 5}, {1, 9, 9}})
    expect_good(make_domain(counts), counts);
}

TEST(Domain, MidpointSplit) {
  for (const std::array<std::size_t, 3>& counts : {std::array<std::size_t, 3>{7, 12, 9}, {4, 4, 2}, {30, 31, 29}})
    expect_good(make_domain(counts, DomainLayout::midpoint), counts);
  EXPECT_THROW(make_domain({7, 12, 20}, DomainLayout::midpoint), UsageError);
  EXPECT_THROW(make_domain({7, 12, 10}, DomainLayout::midpoint), UsageError);
}

TEST(Patch, SideNodesAreTheCurvesPoints) {
  std::mt19937_64 random(test_seed());
  const PatchSides sides = CubicTriangle(random).sides();
  for (const std::array<std::size_t, 3>& counts : {std::array<std::size_t, 3>{8, 8, 8}, {7, 12, 20}}) {
    const Patch patch = make_patch(sides, {.divisions = counts});
    for (std::size_t side = 0; side < 3; ++side)
      for (std::size_t k = 0; k <= counts[side]; ++k)
        EXPECT_EQ(patch.positions[patch.domain.sides[side][k]], sides[side].node(k, counts[side]));
    for (std::size_t i = 0; i < patch.positions.size(); ++i)
      EXPECT_LE(norm(patch.positions[i] - transfinite_point(sides, patch.domain.parameters[i])), 1e-11);
  }
}

TEST(Patch, ACurveRunBackwardsGivesTheSamePoints) {
  const std::vector<Vec3> points = {{0, 0, 0}, {0.3, 1.1, 0.7}, {1.9, 1.3, -0.2}, {3.1, 0.1, 0.37}};
  const SideCurve a(make_bezier(points, 3, 3)), b(make_bezier(points, 3, 3), true),
      c(make_bezier(std::vector<Vec3>(points.rbegin(), points.rend()), 3, 3));
  for (std::size_t k = 0; k <= 37; ++k) {
    EXPECT_EQ(a.node(k, 37), b.node(37 - k, 37));
    EXPECT_EQ(a.node(k, 37), c.node(37 - k, 37));
  }
  EXPECT_LE(norm(a.jet(0.3).first + b.jet(0.7).first), 1e-13);
}

TEST(Patch, FoldsAreFoundWhereThereAreSome) {
  EXPECT_EQ(find_folds(make_patch(bent_triangle(0.40))).folds, 0U);
  const FoldReport report = find_folds(make_patch(bent_triangle(0.52), {.divisions = {64, 64, 64}}));
  EXPECT_GT(report.folds, 0U);
  EXPECT_LT(1 - report.parameters.x - report.parameters.y, 0.6);
  // The same in space, bent out of its plane.
  Patch patch = make_patch(bent_triangle(0.6), {.divisions = {64, 64, 64}});
  for (Vec3& p : patch.positions) p.z = 0.05 * p.x * p.x;
  EXPECT_GT(find_folds(patch).folds, 0U);
}

std::string failure(const PatchSides& sides, double snap = 0) {
  try {
    join_sides(sides, {.snap = snap});
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}
bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST(Sides, ThatDoNotMeetNameTheCornerAndTheGap) {
  PatchSides sides = bent_triangle(0);
  sides[1] = bezier_side({{1, 0.25, 0}, {0.5, 0.9, 0}});
  const std::string words = failure(sides);
  EXPECT_TRUE(says(words, "corner V") && says(words, "0.25 apart") && says(words, "--snap")) << words;
  EXPECT_EQ(failure(sides, 0.25), "");
  EXPECT_TRUE(says(failure(sides, 0.24), "corner V"));
  const PatchSides joined = join_sides(sides, {.snap = 0.3});
  EXPECT_EQ(joined[0].end(), joined[1].start());
  EXPECT_EQ(joined[0].end(), (Vec3{1, 0.125, 0}));
  EXPECT_EQ(joined[0].start(), (Vec3{0, 0, 0}));
}

TEST(Sides, ThatAreReversedAreNamed) {
  PatchSides sides = bent_triangle(0.1);
  sides[1] = bezier_side({{0.5, 0.9, 0}, {1, 0, 0}});
  EXPECT_TRUE(says(failure(sides), "Side 2 looks reversed")) << failure(sides);
  std::swap(sides[1], sides[2]);
  EXPECT_FALSE(failure(sides).empty());
  EXPECT_TRUE(says(failure({bent_triangle(0)[1], bent_triangle(0)[0], bent_triangle(0)[2]}), "another order"));
}

TEST(Sides, ThatCrossAreToldWhere) {
  PatchSides sides = bent_triangle(0);
  sides[0] = bezier_side({{0, 0, 0}, {1.5, 1, 0}, {1, 0, 0}});
  EXPECT_TRUE(says(failure(sides), "cross at")) << failure(sides);
  sides[0] = bezier_side({{0, 0, 0}, {3, -1, 0}, {-2, -1, 0}, {1, 0, 0}});
  EXPECT_TRUE(says(failure(sides), "side 1 crosses itself")) << failure(sides);
  sides[0] = bezier_side({{0, 0, 0}, {0, 0, 0}});
  EXPECT_TRUE(says(failure(sides), "has no length")) << failure(sides);
}

}  // namespace
}  // namespace retalho::test
