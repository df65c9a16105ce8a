// Greedy refinement over scattered points: the tolerance at every point, by other means than the refinement's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retalho/cloud/cloud.h"
#include "retalho/core/error.h"
#include "retalho/tin/scattered.h"
#include "support/errors.h"
#include "tin/scattered_support.h"

namespace retalho {
namespace {

using test::Random;
using test::Sort;

/// Error of the flat TIN at p by looking at every triangle, in long double by the plane's equation; -1: outside.
double error_at(const Tin& tin, const Vec3& p) {
  for (const auto& v : tin.triangles) {
    const Vec2 q{p.x, p.y}, a = tin.points[v[0]], b = tin.points[v[1]], c = tin.points[v[2]];
    if (q.x < std::min({a.x, b.x, c.x}) || q.x > std::max({a.x, b.x, c.x}) || q.y < std::min({a.y, b.y, c.y}) ||
        q.y > std::max({a.y, b.y, c.y}))
      continue;
    if (test::exact_orientation(a, b, q) < 0 || test::exact_orientation(b, c, q) < 0 ||
        test::exact_orientation(c, a, q) < 0)
      continue;
    const long double bx = static_cast<long double>(b.x) - a.x, by = static_cast<long double>(b.y) - a.y,
                      cx = static_cast<long double>(c.x) - a.x, cy = static_cast<long double>(c.y) - a.y,
                      x = static_cast<long double>(p.x) - a.x, y = static_cast<long double>(p.y) - a.y;
    const long double area = bx * cy - cx * by, u = (x * cy - cx * y) / area, w = (bx * y - x * by) / area;
    const long double z = tin.heights[v[0]] + u * (static_cast<long double>(tin.heights[v[1]]) - tin.heights[v[0]]) +
                          w * (static_cast<long double>(tin.heights[v[2]]) - tin.heights[v[0]]);
    return static_cast<double>(std::abs(z - p.z));
  }
  return -1;
}

std::vector<Vec3> hills(std::size_t count, Random& random, double scale = 1) {
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    const double x = random.uniform(0, 10), y = random.uniform(0, 10);
    p = {x * scale, y * scale, 20 * std::sin(x) * std::cos(0.7 * y) + random.uniform(-0.2, 0.2)};
  }
  return points;
}

std::vector<Vec3> unique_places(const std::vector<Vec3>& points) {
  ScatteredNotes notes;
  const Tin all = triangulate_points(points, &notes);
  std::vector<Vec3> places;
  for (std::size_t k = 0; k < all.points.size(); ++k)
    places.push_back({all.points[k].x, all.points[k].y, all.heights[k]});
  return places;
}

TEST(RefinePoints, EveryPlaceIsWithinTheTolerance) {
  Random random;
  int refined = 0;
  for (int round = 0; round < 120 * test::soak(); ++round) {
    const auto sort = static_cast<Sort>(round % static_cast<int>(Sort::kSorts));
    const std::vector<Vec3> points =
        round % 3 == 0 ? hills(30 + random.index(150), random) : test::hard_points(sort, 30 + random.index(60), random);
    const double tolerance = random.chance(0.2) ? 0 : std::pow(10.0, random.uniform(-2, 1.8));
    ScatteredNotes notes;
    Tin tin;
    try {
      tin = refine_points(points, {.max_error = tolerance}, &notes);
    } catch (const BadInput& error) {
      ASSERT_TRUE(test::holds(error.what(), "line"));
      continue;
    }
    SCOPED_TRACE(testing::Message() << "round " << round);
    test::expect_sound(tin);
    test::expect_delaunay(tin);
    if (testing::Test::HasFatalFailure()) return;
    double largest = 0;
    for (const Vec3& p : unique_places(points)) {
      const double error = error_at(tin, p);
      ASSERT_GE(error, 0) << "outside";
      ASSERT_LE(error, tolerance + 1e-9);
      largest = std::max(largest, error);
    }
    ASSERT_NEAR(notes.max_error, largest, 1e-9);
    refined += tin.points.size() < notes.places && tin.points.size() > 4;
  }
  EXPECT_GT(refined, 40 * test::soak());
}

TEST(RefinePoints, IsTheGreedyOrder) {
  // The slow twin: triangulate what is chosen so far from the start, find the worst place, add it.
  Random random;
  for (int round = 0; round < 12; ++round) {
    std::vector<Vec3> points = hills(70, random, round % 2 ? 1.0 : 1e4);
    points = unique_places(points);
    const std::size_t budget = 12 + random.index(30);
    const Tin tin = refine_points(points, {.vertices = budget});
    Tin twin = refine_points(points, {.max_error = 1e9});  // the hull alone
    while (twin.points.size() < budget) {
      std::size_t worst = 0;
      double largest = 0;
      for (std::size_t k = 0; k < points.size(); ++k)
        if (const double error = error_at(twin, points[k]); error > largest) largest = error, worst = k;
      std::vector<Vec3> chosen{points[worst]};
      for (std::size_t k = 0; k < twin.points.size(); ++k)
        chosen.push_back({twin.points[k].x, twin.points[k].y, twin.heights[k]});
      twin = triangulate_points(chosen);
    }
    // The numbering follows each set's own bounding box, which is the same: the hull is in both.
    ASSERT_EQ(tin.points, twin.points);
    ASSERT_EQ(tin.heights, twin.heights);
    ASSERT_EQ(tin.triangles, twin.triangles);
  }
}

TEST(RefinePoints, ZeroToleranceIsTheWholeSetUnlessItIsFlat) {
  Random random;
  std::vector<Vec3> points = hills(500, random);
  const Tin all = triangulate_points(points);
  const Tin refined = refine_points(points);
  EXPECT_EQ(refined.points, all.points);
  EXPECT_EQ(refined.triangles, all.triangles);
  for (Vec3& p : points) p.z = 7;
  ScatteredNotes notes;
  const Tin flat = refine_points(points, {}, &notes);
  EXPECT_LT(flat.points.size(), 40U);
  EXPECT_EQ(notes.max_error, 0);
}

TEST(RefinePoints, DoesNotDependOnTheOrderOfThePoints) {
  Random random;
  for (int round = 0; round < 30; ++round) {
    std::vector<Vec3> points =
        test::hard_points(static_cast<Sort>(round % static_cast<int>(Sort::kSorts)), 300, random);
    const Tin tin = refine_points(points, {.max_error = 20});
    std::shuffle(points.begin(), points.end(), random.engine());
    const Tin again = refine_points(points, {.max_error = 20});
    ASSERT_EQ(tin.points, again.points);
    ASSERT_EQ(tin.triangles, again.triangles);
  }
}

TEST(RefinePoints, TheBudgetIsKeptOrTheToleranceReachedFirst) {
  Random random;
  const std::vector<Vec3> points = hills(3000, random);
  ScatteredNotes notes;
  EXPECT_EQ(refine_points(points, {.vertices = 200}, &notes).points.size(), 200U);
  EXPECT_GT(notes.max_error, 0.3);
  const double reached = notes.max_error;
  EXPECT_LT(refine_points(points, {.max_error = 2 * reached, .vertices = 200}).points.size(), 200U);
  EXPECT_EQ(refine_points(points, {.max_error = reached / 100, .vertices = 200}).points.size(), 200U);
  const std::size_t hull = refine_points(points, {.max_error = 1e9}).points.size();
  EXPECT_EQ(refine_points(points, {.vertices = 3}).points.size(), hull);
}

TEST(RefinePoints, ShipSoundings) {
  RETALHO_DATA_FILE(file, "dem/tut_ship.xyz");
  const PointCloud cloud = read_points(file);
  ScatteredNotes notes;
  const Tin tin = refine_points(cloud.positions, {.max_error = 50}, &notes);
  EXPECT_LE(notes.max_error, 50);
  EXPECT_LT(tin.points.size(), 30000U);
  test::expect_sound(tin);
  test::expect_delaunay(tin);
  Random random;
  const std::vector<Vec3> places = unique_places(cloud.positions);
  for (int k = 0; k < 200; ++k) {
    const double error = error_at(tin, places[random.index(places.size())]);
    ASSERT_GE(error, 0);
    ASSERT_LE(error, 50 + 1e-9);
  }
}

}  // namespace
}  // namespace retalho
