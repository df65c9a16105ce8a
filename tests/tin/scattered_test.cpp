// Delaunay triangulation of scattered points against rational arithmetic, brute force and CGAL.
#include "retalho/tin/scattered.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "retalho/cloud/cloud.h"
#include "retalho/core/error.h"
#include "retalho/tin/predicates.h"
#include "support/errors.h"
#include "tin/scattered_support.h"

namespace retalho {
namespace {

using test::Random;
using test::Sort;

/// The mean height of each place, summed in another order than the library's.
std::map<std::pair<double, double>, std::pair<double, int>> means(const std::vector<Vec3>& points) {
  std::map<std::pair<double, double>, std::pair<double, int>> result;
  for (const Vec3& p : points) {
    auto& [sum, count] = result[{p.x, p.y}];
    sum += p.z;
    ++count;
  }
  return result;
}

bool on_one_line(const std::vector<Vec3>& points) {
  for (const Vec3& a : points)
    for (const Vec3& b : points) {
      if (a.x == b.x && a.y == b.y) continue;
      return std::all_of(points.begin(), points.end(), [&](const Vec3& c) {
        return test::exact_orientation({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == 0;
      });
    }
  return true;
}

TEST(Predicates, HaveTheSignsOfRationalArithmetic) {
  Random random;
  int zeros = 0, cases = 20000 * test::soak();
  for (int k = 0; k < cases; ++k) {
    const double scale = std::pow(10.0, random.uniform(-170, 90)),
                 step = random.chance(0.5) ? scale * 0.25 : scale * 1e-14;
    const double far = random.chance(0.3) ? scale : 0;
    std::array<Vec2, 4> p;
    for (Vec2& q : p)
      q = {far + step * static_cast<double>(random.index(6)), far + step * static_cast<double>(random.index(6))};
    if (random.chance(0.5)) p[3] = {p[3].x * (1 + 0x1p-52), p[3].y};
    ASSERT_EQ(orientation(p[0], p[1], p[2]), test::exact_orientation(p[0], p[1], p[2]));
    const int circle = test::exact_in_circle(p[0], p[1], p[2], p[3]);
    ASSERT_EQ(in_circle(p[0], p[1], p[2], p[3]), circle) << scale;
    zeros += circle == 0;
  }
  EXPECT_GT(zeros, cases / 20);
  EXPECT_LT(zeros, cases / 2);
}

TEST(TriangulatePoints, IsDelaunayOnHardSets) {
  Random random;
  std::array<int, static_cast<std::size_t>(Sort::kSorts)> done{};
  for (int round = 0; round < 450 * test::soak(); ++round) {
    const auto sort = static_cast<Sort>(round % static_cast<int>(Sort::kSorts));
    const std::vector<Vec3> points = test::hard_points(sort, 3 + random.index(60), random);
    if (on_one_line(points)) {
      EXPECT_THROW(triangulate_points(points), BadInput);
      continue;
    }
    ++done[static_cast<std::size_t>(sort)];
    ScatteredNotes notes;
    const Tin tin = triangulate_points(points, &notes);
    SCOPED_TRACE(testing::Message() << "sort " << static_cast<int>(sort) << ", round " << round);
    test::expect_sound(tin);
    test::expect_delaunay(tin);
    test::expect_empty_circles(tin);
    if (testing::Test::HasFatalFailure()) return;

    const auto places = means(points);
    ASSERT_EQ(tin.points.size(), places.size());
    ASSERT_EQ(notes.points, points.size());
    ASSERT_EQ(notes.places, places.size());
    ASSERT_EQ(notes.repeated, points.size() - places.size());
    for (std::size_t v = 0; v < tin.points.size(); ++v) {
      const auto found = places.find({tin.points[v].x, tin.points[v].y});
      ASSERT_NE(found, places.end());
      ASSERT_NEAR(tin.heights[v], found->second.first / found->second.second, 1e-10);
    }
    ASSERT_EQ(tin.triangles.size() + test::border_points(tin.points) + 2, 2 * tin.points.size())
        << "the hull is covered";
  }
  for (std::size_t k = 0; k < done.size(); ++k) EXPECT_GE(done[k], 20 * test::soak()) << "sort " << k;
}

TEST(TriangulatePoints, DoesNotDependOnTheOrderOfThePoints) {
  Random random;
  for (int round = 0; round < 90; ++round) {
    std::vector<Vec3> points =
        test::hard_points(static_cast<Sort>(round % static_cast<int>(Sort::kSorts)), 200, random);
    const Tin tin = triangulate_points(points);
    std::shuffle(points.begin(), points.end(), random.engine());
    const Tin again = triangulate_points(points);
    ASSERT_EQ(tin.points, again.points);
    ASSERT_EQ(tin.heights, again.heights);
    ASSERT_EQ(tin.triangles, again.triangles);
    ASSERT_EQ(tin.neighbors, again.neighbors);
  }
}

TEST(TriangulatePoints, LargeSetsAreSoundAndDelaunay) {
  Random random;
  for (const Sort sort : {Sort::uniform, Sort::lattice, Sort::tracks, Sort::clusters}) {
    const std::vector<Vec3> points = test::hard_points(sort, 20000, random);
    const Tin tin = triangulate_points(points);
    test::expect_sound(tin);
    test::expect_delaunay(tin);
  }
}

TEST(TriangulatePoints, RepeatedPlacesGetTheMeanHeight) {
  const std::vector<Vec3> points{{0, 0, 1}, {1, 0, 2}, {0, 1, 3}, {0, 0, 4}, {0, 0, 10}, {1, 0, 2}};
  ScatteredNotes notes;
  const Tin tin = triangulate_points(points, &notes);
  EXPECT_EQ(notes.repeated, 3U);
  EXPECT_EQ(notes.places, 3U);
  EXPECT_EQ(notes.largest_spread, 9);
  ASSERT_EQ(tin.triangles.size(), 1U);
  for (std::size_t v = 0; v < 3; ++v) {
    const Vec2 p = tin.points[v];
    EXPECT_EQ(tin.heights[v], p.x == 1 ? 2 : p.y == 1 ? 3 : 5);
  }
}

TEST(TriangulatePoints, SaysWhyThereIsNone) {
  using test::words_of;
  const auto run = [](std::vector<Vec3> points) { return words_of<BadInput>([&] { triangulate_points(points); }); };
  EXPECT_TRUE(test::holds(run({}), "0 points"));
  EXPECT_TRUE(test::holds(run({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}}), "2 different places"));
  EXPECT_TRUE(test::holds(run({{0, 0, 0}, {1, 1, 1}, {2, 2, 0}, {-7, -7, 0}}), "on one line"));
  EXPECT_TRUE(test::holds(run({{0, 0, 0}, {1, 0, std::nan("")}, {2, 2, 0}}), "point 1"));
  EXPECT_TRUE(test::holds(run({{0, 0, 0}, {1e200, 0, 0}, {2, 2, 0}}), "point 1"));
}

TEST(TriangulatePoints, StopsWhenAsked) {
  Random random;
  const std::vector<Vec3> points = test::hard_points(Sort::uniform, 20000, random);
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  EXPECT_THROW(triangulate_points(points, nullptr, context), Interrupted);
}

TEST(TriangulatePoints, ShipSoundings) {
  RETALHO_DATA_FILE(file, "dem/tut_ship.xyz");
  const PointCloud cloud = read_points(file);
  ASSERT_EQ(cloud.positions.size(), 82970U);
  ScatteredNotes notes;
  const Tin tin = triangulate_points(cloud.positions, &notes);
  EXPECT_EQ(notes.repeated, 1987U);
  EXPECT_EQ(tin.points.size(), 82970U - 1987U);
  test::expect_sound(tin);
  test::expect_delaunay(tin);
}

}  // namespace
}  // namespace retalho
