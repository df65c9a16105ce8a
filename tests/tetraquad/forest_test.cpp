// Bisected meshes: conforming, of three shapes, found again by location.
#include "retalho/tetraquad/forest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "retalho/core/error.h"
#include "support/support.h"

namespace retalho {
namespace {

Vec3 place(const TetForest& forest, std::uint32_t v) {
  const auto& p = forest.vertices()[v];
  return {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
}

TetFrame frame(const TetForest& forest, std::uint32_t n) {
  const TetCorners& c = forest.nodes()[n].corners;
  return {place(forest, c[0]), place(forest, c[1]), place(forest, c[2]), place(forest, c[3])};
}

/// Random leaves, most of them near a corner, bisected some times.
TetForest random_forest(test::Random& random, int rounds) {
  TetForest forest({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}});
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::uint32_t> chosen;
    for (const std::uint32_t n : forest.leaves()) {
      Vec3 p{};
      for (const std::uint32_t v : forest.nodes()[n].corners) p = p + 0.25 * place(forest, v);
      if (random.chance(norm(p - Vec3{300, 1500, 500}) < 600 ? 0.4 : 0.03)) chosen.push_back(n);
    }
    forest.bisect(chosen);
  }
  return forest;
}

TEST(Forest, RandomBisectionsConformAndFillTheCubes) {
  test::Random random(61);
  const TetForest forest = random_forest(random, 9);
  double volume = 0;
  int deepest = 0;
  std::vector<TetCorners> tets;
  for (const std::uint32_t n : forest.leaves()) {
    tets.push_back(forest.nodes()[n].corners);
    volume += std::abs(frame(forest, n).volume6) / 6;
    deepest = std::max<int>(deepest, forest.nodes()[n].level);
    // Its volume says its level.
    EXPECT_EQ(std::abs(frame(forest, n).volume6), std::ldexp(1.0, 30 - forest.nodes()[n].level));
  }
  EXPECT_NEAR(volume / (4.0 * (1 << 30)), 1, 1e-12);
  EXPECT_GE(deepest, 7);
  // Every face has another side or lies on the cubes' border: half-faces throw where three tetrahedra share a face.
  const HalfFaces faces(tets, forest.vertices().size());
  for (const std::uint32_t f : faces.border()) {
    std::array<int, 3> on{};  // how many corners on a plane of the border, by axis
    for (std::size_t d = 0; d < 3; ++d)
      for (const std::int32_t side : {0, d == 2 ? 1024 : 2048}) {
        int count = 0;
        for (std::size_t i = 0; i < 4; ++i)
          if (i != f % 4) count += forest.vertices()[tets[f / 4][i]][d] == side ? 1 : 0;
        on[d] = std::max(on[d], count);
      }
    EXPECT_TRUE(on[0] == 3 || on[1] == 3 || on[2] == 3);
  }
}

TEST(Forest, HasThreeShapes) {
  test::Random random(62);
  const TetForest forest = random_forest(random, 8);
  std::set<std::vector<long>> shapes;
  for (const std::uint32_t n : forest.leaves()) {
    // Squared lengths of the edges, scaled by the volume, sorted.
    std::vector<long> lengths;
    const TetCorners& c = forest.nodes()[n].corners;
    const double scale = std::pow(std::abs(frame(forest, n).volume6), 2.0 / 3);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        lengths.push_back(std::lround(1e6 * norm2(place(forest, c[i]) - place(forest, c[j])) / scale));
    std::sort(lengths.begin(), lengths.end());
    shapes.insert(lengths);
  }
  EXPECT_LE(shapes.size(), 3U);
}

TEST(Forest, LocationAgreesWithASearchOfAllLeaves) {
  test::Random random(63);
  const TetForest forest = random_forest(random, 6);
  const std::vector<std::uint32_t> leaves = forest.leaves();
  for (int n = 0; n < 2000 * test::soak(); ++n) {
    const Vec3 p = {random.uniform(0, 2048), random.uniform(0, 2048), random.uniform(0, 1024)};
    TetBarycentric b;
    const std::int64_t found = forest.locate(p, &b);
    ASSERT_GE(found, 0);
    const TetBarycentric own = frame(forest, static_cast<std::uint32_t>(found)).barycentric(p);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(b[i], own[i], 1e-12);
    double depth = -1;
    std::uint32_t best = 0;
    for (const std::uint32_t leaf : leaves) {
      const TetBarycentric c = frame(forest, leaf).barycentric(p);
      if (const double least = *std::min_element(c.begin(), c.end()); least > depth) {
        depth = least;
        best = leaf;
      }
    }
    if (depth > 1e-9) {
      EXPECT_EQ(found, best);
    }
  }
  EXPECT_EQ(forest.locate({-1, 5, 5}), -1);
  EXPECT_EQ(forest.locate({NAN, 5, 5}), -1);
}

TEST(Forest, ComesBackFromItsMarks) {
  test::Random random(64);
  const TetForest forest = random_forest(random, 7);
  const std::vector<std::uint8_t> marks = forest.halved();
  const TetForest again(forest.cubes(), marks);
  EXPECT_EQ(again.cubes(), forest.cubes());
  EXPECT_EQ(again.halved(), marks);
  const auto a = forest.leaves(), b = again.leaves();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n)
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_EQ(forest.vertices()[forest.nodes()[a[n]].corners[i]], again.vertices()[again.nodes()[b[n]].corners[i]]);
}

TEST(Forest, MarksThatAreNoForestAreRefused) {
  test::Random random(65);
  const TetForest forest = random_forest(random, 3);
  std::vector<std::uint8_t> marks = forest.halved();
  marks.push_back(0);
  EXPECT_THROW(TetForest(forest.cubes(), marks), BadInput);
  marks.resize(marks.size() - 2);
  EXPECT_THROW(TetForest(forest.cubes(), marks), BadInput);
  EXPECT_THROW(TetForest({{0, 0, 0}}, std::vector<std::uint8_t>(5, 0)), BadInput);
  EXPECT_THROW(TetForest({{1, 0, 0}, {0, 0, 0}}, std::vector<std::uint8_t>(12, 0)), BadInput);
  // One root cut, its neighbours not: a vertex in the middle of their edge.
  EXPECT_THROW(TetForest({{0, 0, 0}}, std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0, 0, 0}), BadInput);
  EXPECT_NO_THROW(TetForest({{0, 0, 0}}, std::vector<std::uint8_t>(6, 0)));
  // Deeper than there is room for.
  EXPECT_THROW(TetForest({{0, 0, 0}}, std::vector<std::uint8_t>(100, 1)), BadInput);
}

}  // namespace
}  // namespace retalho
