// The promises of level/contour.h on triangulated surfaces: linear, Powell-Sabin, Clough-Tocher.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "level/contour_support.h"
#include "retalho/core/error.h"
#include "retalho/level/cell_walk.h"
#include "retalho/level/conics.h"
#include "retalho/level/contour.h"
#include "retalho/terrain/creases.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/powell_sabin.h"
#include "terrain/synthetic.h"

namespace retalho {
namespace {

constexpr SurfaceKind kKinds[] = {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher};

/// Random heights, and random gradients of a size that makes every piece hilly.
Terrain wild(SurfaceKind kind, int side, test::Random& random) {
  Terrain t;
  t.kind = kind;
  t.tin = test::delaunay(test::jittered_points(side, random.seed() + random.index(1000000)),
                         [&](Vec2) { return random.uniform(0, 10); });
  if (kind != SurfaceKind::linear)
    for (std::size_t i = 0; i < t.tin.points.size(); ++i)
      t.gradients.push_back({random.uniform(-300, 300), random.uniform(-300, 300)});
  if (kind == SurfaceKind::powell_sabin) t.edge_split = powell_sabin_splits(t.tin, build_edges(t.tin));
  return t;
}

/// The same, folded along every third edge: steep on one side, steep the other way on the other.
Terrain folded(SurfaceKind kind, int side, test::Random& random) {
  Terrain t = wild(kind, side, random);
  const EdgeTable edges = build_edges(t.tin);
  for (std::uint32_t e = 0; e < edges.vertices.size(); ++e)
    if (edges.triangles[e][1] != kNone && random.chance(1.0 / 3)) t.creases.push_back(e);
  std::size_t nodes = 0;
  t.corner_gradients = crease_sectors(t.tin, edges, t.creases, &nodes);
  while (t.gradients.size() < nodes) t.gradients.push_back({random.uniform(-300, 300), random.uniform(-300, 300)});
  return t;
}

TEST(TerrainContours, LinesAreClosedOrEndOnTheBorderAndNeverMeet) {
  test::Random random;
  for (const SurfaceKind kind : kKinds)
    for (int round = 0; round < 24; ++round) {
      const Terrain t = round % 3 == 2 && kind != SurfaceKind::linear ? folded(kind, 8, random) : wild(kind, 8, random);
      const ContourSet set =
          trace_contours(t, contour_levels(-20, 30, 0.77), {.tolerance = 0.002, .simplify = round % 2 == 0});
      EXPECT_EQ(set.singular.size(), 0U);
      EXPECT_GT(set.lines.size(), 0U);
      for (const ContourLine& line : set.lines) {
        if (line.closed) continue;
        for (const Vec2 p : {set.points[line.begin], set.points[line.end - 1]})
          EXPECT_TRUE(p.x == 0 || p.y == 0 || p.x == 1 || p.y == 1) << p.x << ' ' << p.y;
      }
      EXPECT_EQ(test::count_meetings(set, 0.01), 0U);
    }
}

TEST(TerrainContours, ComponentsEqualABruteForceCount) {
  test::Random random;
  for (const SurfaceKind kind : {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher})
    for (int round = 0; round < 10; ++round) {
      const Terrain t = wild(kind, 5, random);
      const TerrainEvaluator evaluator(t);
      const std::vector<double> levels{2.123, 5.321, 8.777};
      const ContourSet set = trace_contours(t, levels, {.tolerance = 0.002, .simplify = false});
      constexpr std::size_t kSide = 801;
      std::vector<double> z(kSide * kSide);
      for (std::size_t r = 0; r < kSide; ++r)
        for (std::size_t c = 0; c < kSide; ++c)
          z[r * kSide + c] =
              evaluator.value({static_cast<double>(c) / (kSide - 1), static_cast<double>(r) / (kSide - 1)});
      for (std::size_t l = 0; l < levels.size(); ++l) {
        std::vector<char> above(z.size());
        for (std::size_t i = 0; i < z.size(); ++i) above[i] = z[i] >= levels[l];
        std::size_t lines = 0;
        for (const ContourLine& line : set.lines) lines += line.level == static_cast<int>(l);
        EXPECT_EQ(lines + 1, test::count_regions(above, kSide, kSide)) << surface_name(kind) << ' ' << round;
      }
    }
}

/// Every region of a linear surface holds a vertex, and vertices of one region are joined by edges.
TEST(TerrainContours, ComponentsOfALinearSurfaceEqualTheGraphsCount) {
  test::Random random;
  for (int round = 0; round < 200; ++round) {
    const Terrain t = wild(SurfaceKind::linear, 7, random);
    const ContourSet set = trace_contours(t, {2.123, 5.321, 8.777}, {.tolerance = 0.002, .simplify = false});
    for (std::size_t l = 0; l < set.levels.size(); ++l) {
      std::vector<std::size_t> region(t.tin.points.size());
      for (std::size_t i = 0; i < region.size(); ++i) region[i] = i;
      const auto above = [&](std::size_t v) { return t.tin.heights[v] >= set.levels[l]; };
      for (bool changed = true; changed;) {
        changed = false;
        for (const auto& triangle : t.tin.triangles)
          for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t a = triangle[k], b = triangle[(k + 1) % 3];
            if (above(a) != above(b) || region[a] == region[b]) continue;
            region[a] = region[b] = std::min(region[a], region[b]);
            changed = true;
          }
      }
      std::size_t regions = 0, lines = 0;
      for (std::size_t i = 0; i < region.size(); ++i) regions += region[i] == i;
      for (const ContourLine& line : set.lines) lines += line.level == static_cast<int>(l);
      EXPECT_EQ(lines + 1, regions);
    }
  }
}

TEST(TerrainContours, EveryPointIsOnTheLevelWithinTheTube) {
  test::Random random;
  for (const SurfaceKind kind : kKinds) {
    const Terrain t = wild(kind, 8, random);
    const TerrainEvaluator evaluator(t);
    const double step = 0.5;
    const ContourSet set = trace_contours(t, contour_levels(-20, 30, step), {.tolerance = 0.01, .simplify = true});
    for (const test::Segment& s : test::segments(set))
      for (int i = 0; i <= 3; ++i) {
        Vec2 p = s.a + (i / 3.0) * (s.b - s.a);
        p = {std::clamp(p.x, 0.0, 1.0), std::clamp(p.y, 0.0, 1.0)};
        EXPECT_LE(std::abs(evaluator.value(p) - set.levels[static_cast<std::size_t>(s.level)]), step / 2);
      }
  }
}

TEST(TerrainContours, TheSameBytesFromAnyNumberOfThreads) {
  test::Random random;
  const Terrain t = wild(SurfaceKind::clough_tocher, 60, random);
  const std::vector<double> levels = contour_levels(0, 10, 1.3);
  const ContourSet one = trace_contours(t, levels, {.tolerance = 0.001}, {.threads = 1});
  const ContourSet many = trace_contours(t, levels, {.tolerance = 0.001}, {.threads = 3});
  EXPECT_TRUE(one.points == many.points);
  EXPECT_EQ(one.lines.size(), many.lines.size());
}

/// What conics and polylines of the same levels must agree about.
struct Measured {
  std::vector<double> length;  ///< by level
  std::size_t closed = 0;
};

/// Measures the conics by 64 chords a segment; segments of a line share their ends. visit(line, k, place) sees chord
/// k's end.
template <class Visit>
Measured measure(const ConicSet& set, const Visit& visit) {
  Measured m{std::vector<double>(set.levels.size(), 0)};
  for (const ConicLine& line : set.lines) {
    m.closed += line.curve.closed ? 1 : 0;
    for (std::size_t i = 0; i < line.curve.segment_count(); ++i) {
      const CurveSegment s = line.curve.segment(i);
      if (i > 0) {
        EXPECT_EQ(s.points[0], line.curve.segment(i - 1).points[2]);
      }
      Vec3 last = s.points[0];
      for (int k = 1; k <= 64; ++k) {
        const Vec3 p = evaluate(s, k / 64.0);
        visit(line, k, Vec2{p.x, p.y});
        m.length[static_cast<std::size_t>(line.level)] += norm(p - last);
        last = p;
      }
    }
  }
  return m;
}

void expect_alike(const Measured& conics, const ContourSet& lines, double slack) {
  Measured traced{std::vector<double>(conics.length.size(), 0)};
  for (const ContourLine& line : lines.lines) traced.closed += line.closed ? 1 : 0;
  for (const test::Segment& s : test::segments(lines))
    traced.length[static_cast<std::size_t>(s.level)] += norm(s.b - s.a);
  EXPECT_EQ(conics.closed, traced.closed);
  for (std::size_t k = 0; k < traced.length.size(); ++k)
    EXPECT_NEAR(conics.length[k], traced.length[k], 0.002 * traced.length[k] + slack);
}

TEST(Conics, LieOnTheSurfaceAndAreTheSameLines) {
  test::Random random;
  for (int round = 0; round < 20; ++round) {
    const Terrain t =
        round % 3 == 2 ? folded(SurfaceKind::powell_sabin, 7, random) : wild(SurfaceKind::powell_sabin, 7, random);
    const std::vector<double> levels = contour_levels(-20, 30, 1.3);
    const ConicSet set = trace_conics(t, levels);
    const ContourSet lines = trace_contours(t, levels, {.tolerance = 1e-4, .simplify = false});
    ASSERT_EQ(set.lines.size(), lines.lines.size());
    const TerrainEvaluator surface(t);
    const auto on_the_surface = [&](const ConicLine& line, int k, Vec2 p) {
      if (k % 16 != 8) return;
      // A gradient here is 1e3, and so is what one quantum of an ordinate may weigh.
      EXPECT_NEAR(surface.value(p), levels[static_cast<std::size_t>(line.level)], 40 * set.height_quantum);
    };
    expect_alike(measure(set, on_the_surface), lines, 1e-3);
  }
}

TEST(Conics, OfAParaboloidAreCircles) {
  // Powell-Sabin surfaces reproduce quadratic polynomials.
  Terrain t;
  t.kind = SurfaceKind::powell_sabin;
  t.tin = test::delaunay(test::jittered_points(9, 5), [](Vec2 p) { return norm2(p - Vec2{0.5, 0.5}); });
  for (const Vec2 p : t.tin.points) t.gradients.push_back(2 * (p - Vec2{0.5, 0.5}));
  t.edge_split = powell_sabin_splits(t.tin, build_edges(t.tin));
  const ConicSet set = trace_conics(t, {0.01, 0.04, 0.16});
  ASSERT_EQ(set.lines.size(), 3U);
  for (const ConicLine& line : set.lines) {
    EXPECT_TRUE(line.curve.closed);
    for (std::size_t i = 0; i < line.curve.segment_count(); ++i)
      for (int k = 0; k <= 8; ++k) {
        const Vec3 p = evaluate(line.curve.segment(i), k / 8.0);
        EXPECT_NEAR(norm(Vec2{p.x, p.y} - Vec2{0.5, 0.5}), std::sqrt(set.levels[static_cast<std::size_t>(line.level)]),
                    50 * set.height_quantum);
      }
  }
}

/// A Powell-Sabin surface on the unit square whose grid of 12 x 9 cells has a fifth of them void.
Terrain with_voids(test::Random& random) {
  Terrain t = wild(SurfaceKind::powell_sabin, 7, random);
  t.grid = {12, 9, 1.0 / 11, 1.0 / 8, Mask(12, 9, true)};
  for (Vec2& p : t.tin.points) p.y -= 1;  // a grid's rows go down from 0
  for (int row = 0; row < 9; ++row)
    for (int column = 0; column < 12; ++column)
      if (random.chance(0.2)) t.grid.valid.set(column, row, false);
  t.edge_split = powell_sabin_splits(t.tin, build_edges(t.tin));
  return t;
}

// The polylines of the same levels are cut by another rule's arithmetic, segment by segment: they are the twin.
TEST(Conics, EndWhereThereIsNoData) {
  test::Random random;
  for (int round = 0; round < 20; ++round) {
    const Terrain t = with_voids(random);
    const std::vector<double> levels = contour_levels(-20, 30, 1.3);
    const ConicSet set = trace_conics(t, levels);
    const ContourSet lines = trace_contours(t, levels, {.tolerance = 1e-4, .simplify = false});
    const double near = 1e-9;
    const auto data = [&](double x, double y) {
      for (const double dx : {-near, near})
        for (const double dy : {-near, near})
          if (holds_data(cell_of({x + dx, y + dy}, t.grid), t.grid)) return true;
      return false;
    };
    const auto on_side = [&](Vec3 p) {  // between data and none, or on the outline of the triangles
      const auto half = [&](double v, double size) { return std::abs(v / size - std::floor(v / size) - 0.5) < 1e-9; };
      return half(p.x, t.grid.cell_width) || half(-p.y, t.grid.cell_height) || std::abs(p.x) < near ||
             std::abs(p.x - 1) < near || std::abs(p.y) < near || std::abs(p.y + 1) < near;
    };
    const auto where_data_is = [&](const ConicLine&, int, Vec2 p) { EXPECT_TRUE(data(p.x, p.y)) << p.x << ' ' << p.y; };
    const Measured conics = measure(set, where_data_is);
    for (const ConicLine& line : set.lines) {
      if (line.curve.closed) continue;
      EXPECT_TRUE(on_side(line.curve.points.front()));
      EXPECT_TRUE(on_side(line.curve.points.back()));
    }
    EXPECT_GT(conics.closed, 0U);
    EXPECT_NEAR(static_cast<double>(set.lines.size()), static_cast<double>(lines.lines.size()),
                0.01 * static_cast<double>(lines.lines.size()));  // a polyline may cut a corner that its conic misses
    expect_alike(conics, lines, 2e-3);
  }
}

TEST(Conics, RefuseOtherSurfaces) {
  test::Random random;
  EXPECT_THROW(trace_conics(wild(SurfaceKind::clough_tocher, 4, random), {5}), BadInput);
  Terrain t = wild(SurfaceKind::powell_sabin, 4, random);
  EXPECT_THROW(trace_conics(t, {5, 5}), BadInput);
}

}  // namespace
}  // namespace retalho
