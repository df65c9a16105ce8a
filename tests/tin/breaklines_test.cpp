// Constrained triangulations: every breakline is there, everything else is as Delaunay as the breaklines allow.
#include "retalho/tin/breaklines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "retalho/core/error.h"
#include "support/errors.h"
#include "tin/scattered_support.h"

namespace retalho {
namespace {

using test::Random;
using Line = std::vector<Vec3>;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Points on a small lattice: three on a line, four on a circle and vertices on segments are common.
std::vector<Vec3> lattice_points(Random& random, std::size_t count, std::size_t side) {
  std::vector<Vec3> points{{0, 0, 1}, {static_cast<double>(side), 0, 2}, {0, static_cast<double>(side), 3}};
  while (points.size() < count)
    points.push_back({static_cast<double>(random.index(side + 1)), static_cast<double>(random.index(side + 1)),
                      random.uniform(0, 9)});
  return points;
}

std::vector<Line> random_lines(Random& random, std::size_t count, std::size_t side, bool whole) {
  std::vector<Line> lines(count);
  for (Line& line : lines)
    for (std::size_t k = 0, n = 2 + random.index(4); k < n; ++k) {
      const double x = random.uniform(0, static_cast<double>(side)), y = random.uniform(0, static_cast<double>(side));
      line.push_back({whole ? std::round(x) : x, whole ? std::round(y) : y, random.uniform(0, 9)});
    }
  return lines;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> fixed_pairs(const ConstrainedTin& made) {
  const EdgeTable edges = build_edges(made.tin);
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const std::uint32_t e : made.edges) pairs.insert({edges.vertices[e][0], edges.vertices[e][1]});
  return pairs;
}

/// Every edge that is not fixed is locally Delaunay: then the whole is the constrained Delaunay triangulation.
void expect_constrained_delaunay(const ConstrainedTin& made) {
  const EdgeTable edges = build_edges(made.tin);
  const std::set<std::uint32_t> fixed(made.edges.begin(), made.edges.end());
  for (std::uint32_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [t, o] = edges.triangles[e];
    if (o == kNone || fixed.contains(e)) continue;
    const auto& a = made.tin.triangles[t];
    for (const std::uint32_t v : made.tin.triangles[o])
      if (std::find(a.begin(), a.end(), v) == a.end()) {
        ASSERT_LE(test::exact_in_circle(made.tin.points[a[0]], made.tin.points[a[1]], made.tin.points[a[2]],
                                        made.tin.points[v]),
                  0);
      }
  }
}

/// Fixed edges that lie on segment a-b, by exact signs: together they are as long as it.
double covered(const ConstrainedTin& made, Vec2 a, Vec2 b) {
  double length = 0;
  for (const auto& [u, v] : fixed_pairs(made)) {
    const Vec2 p = made.tin.points[u], q = made.tin.points[v];
    if (test::exact_orientation(a, b, p) != 0 || test::exact_orientation(a, b, q) != 0) continue;
    const double n = norm2(b - a), s = dot(p - a, b - a) / n, t = dot(q - a, b - a) / n;
    if (std::min(s, t) > -1e-12 && std::max(s, t) < 1 + 1e-12) length += norm(q - p);
  }
  return length;
}

TEST(Breaklines, EverySegmentIsAChainOfEdgesAndTheRestIsDelaunay) {
  Random random;
  int crossed = 0;
  for (int round = 0; round < 300 * test::soak(); ++round) {
    const bool whole = round % 2 == 0;
    const std::size_t side = 4 + random.index(9);
    const std::vector<Vec3> points = lattice_points(random, 5 + random.index(60), side);
    const std::vector<Line> lines = random_lines(random, 1 + random.index(3), side, whole);
    BreaklineNotes notes;
    const ConstrainedTin made = triangulate_points(points, lines, nullptr, &notes);
    test::expect_sound(made.tin);
    expect_constrained_delaunay(made);
    crossed += notes.crossings > 0;
    if (notes.crossings > 0) continue;  // a rounded crossing moves a segment by an ulp
    for (const Line& line : lines)
      for (std::size_t k = 0; k + 1 < line.size(); ++k) {
        const Vec2 a{line[k].x, line[k].y}, b{line[k + 1].x, line[k + 1].y};
        ASSERT_NEAR(covered(made, a, b), norm(b - a), 1e-9) << round;
      }
  }
  EXPECT_GT(crossed, 10);
}

TEST(Breaklines, TheOrderOfPointsAndLinesDoesNotMatter) {
  Random random;
  for (int round = 0; round < 30; ++round) {
    std::vector<Vec3> points = lattice_points(random, 80, 1000);
    std::vector<Line> lines = random_lines(random, 4, 1000, false);
    const ConstrainedTin one = triangulate_points(points, lines);
    std::reverse(points.begin(), points.end());
    std::reverse(lines.begin(), lines.end());
    const ConstrainedTin other = triangulate_points(points, lines);
    // Points in general position: one constrained Delaunay triangulation only. Crossings are rounded from either line.
    ASSERT_EQ(one.tin.points.size(), other.tin.points.size());
    EXPECT_EQ(one.tin.triangles, other.tin.triangles) << round;
    EXPECT_EQ(one.edges, other.edges) << round;
  }
}

TEST(Breaklines, CrossingsGetAVertexWithTheMeanHeight) {
  const std::vector<Vec3> points{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}};
  const std::vector<Line> lines{{{1, 5, 4}, {9, 5, 4}}, {{5, 1, 8}, {5, 9, 8}}};
  BreaklineNotes notes;
  const ConstrainedTin made = triangulate_points(points, lines, nullptr, &notes);
  EXPECT_EQ(notes.crossings, 1U);
  EXPECT_EQ(notes.largest_disagreement, 4);
  EXPECT_EQ(notes.lines, 2U);
  ASSERT_EQ(made.tin.vertex_count(), 9U);
  EXPECT_EQ(made.edges.size(), 4U);
  const auto at = std::find(made.tin.points.begin(), made.tin.points.end(), Vec2{5, 5});
  ASSERT_NE(at, made.tin.points.end());
  EXPECT_EQ(made.tin.heights[static_cast<std::size_t>(at - made.tin.points.begin())], 6);
}

TEST(Breaklines, WithoutHeightsTheyLieOnTheFlatSurfaceOfThePoints) {
  const std::vector<Vec3> points{{0, 0, 0}, {10, 0, 20}, {10, 10, 50}, {0, 10, 30}};
  const std::vector<Line> lines{{{1, 2, kNaN}, {7, 4, kNaN}}};
  BreaklineNotes notes;
  const ConstrainedTin made = triangulate_points(points, lines, nullptr, &notes);
  EXPECT_EQ(notes.draped, 2U);
  for (std::size_t v = 0; v < made.tin.vertex_count(); ++v)
    EXPECT_NEAR(made.tin.heights[v], 2 * made.tin.points[v].x + 3 * made.tin.points[v].y, 1e-12);
}

TEST(Breaklines, StepsAreNoLongerThanAsked) {
  const Line line{{0, 0, 0}, {10, 0, 5}, {10, 1, 5}};
  const std::vector<Vec3> dense = with_steps(line, 3);
  ASSERT_EQ(dense.size(), 6U);
  EXPECT_TRUE(dense.front() == line.front() && dense[4] == line[1] && dense.back() == line.back());
  for (std::size_t k = 0; k + 1 < dense.size(); ++k) EXPECT_LE(norm(dense[k + 1] - dense[k]), 3 * std::sqrt(1.25));
  EXPECT_NEAR(dense[2].z, 2.5, 1e-15);
}

TEST(Breaklines, RefusesInWords) {
  const std::vector<Vec3> points{{0, 0, 0}, {10, 0, 20}, {10, 10, 50}};
  const auto words = [&](const Line& line) {
    return test::words_of<BadInput>([&] { triangulate_points(points, std::vector<Line>{line}); });
  };
  EXPECT_TRUE(test::holds(words({{1, 1, 0}, {std::numeric_limits<double>::infinity(), 0, 0}}), "not finite"));
  EXPECT_TRUE(test::holds(words({{1, 1, 0}, {2, kNaN, 0}}), "vertex 1 of breakline 0"));
  EXPECT_TRUE(test::holds(words({{9, 1, kNaN}, {0, 10, kNaN}}), "outside the points"));
}

TEST(Breaklines, ManyLinesAcrossManyTriangles) {
  Random random;
  std::vector<Vec3> points;
  for (int k = 0; k < 20000; ++k) points.push_back({random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)});
  std::vector<Line> lines;
  for (int k = 1; k < 40; ++k) lines.push_back({{0.02, k / 40.0, 0}, {0.98, k / 40.0 + 0.01, 0}});
  const ConstrainedTin made = triangulate_points(points, lines);
  test::expect_sound(made.tin);
  expect_constrained_delaunay(made);
  EXPECT_GE(made.edges.size(), 39U);
}

// So far from the origin there are few doubles between two lines, and every rounded crossing moves what it lies on: the
// crossings settle within the eight rounds all the same.
TEST(Breaklines, CrossingsSettleWhereDoublesAreFew) {
  test::Random random;
  for (const double base : {0x1p52, 0x1p20})
    for (const std::size_t doubles : {40U, 4000U}) {
      const double step = base * 0x1p-52, end = base + step * static_cast<double>(doubles);
      const auto place = [&] {
        const auto at = [&] { return base + step * static_cast<double>(random.index(doubles)); };
        return Vec3{at(), at(), 0};
      };
      std::vector<std::vector<Vec3>> lines(60);
      for (auto& line : lines) line = {place(), place()};
      const std::vector<Vec3> corners{{base, base, 0}, {end, base, 0}, {base, end, 0}};
      EXPECT_NO_THROW(triangulate_points(corners, lines)) << base << " " << doubles;
    }
}

}  // namespace
}  // namespace retalho
