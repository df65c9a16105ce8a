// Bands cover the valid area exactly once, and their borders are the lines.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "level/contour_support.h"
#include "retalho/level/contour.h"
#include "retalho/terrain/locate.h"
#include "retalho/terrain/powell_sabin.h"
#include "terrain/synthetic.h"

namespace retalho {
namespace {

double area(const std::vector<Vec2>& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) sum += cross(ring[i], ring[(i + 1) % ring.size()]) / 2;
  return sum;
}

int winding(const std::vector<Vec2>& ring, Vec2 p) {
  int n = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2 a = ring[i], b = ring[(i + 1) % ring.size()];
    if (a.y <= p.y && b.y > p.y && cross(b - a, p - a) > 0) ++n;
    if (a.y > p.y && b.y <= p.y && cross(b - a, p - a) < 0) --n;
  }
  return n;
}

/// Checks areas, windings at random points, nesting and shared coordinates.
void expect_cover(const ContourSet& set, const BandSet& bands, double valid_area, Vec2 low, Vec2 high,
                  const std::function<bool(Vec2)>& valid, test::Random& random) {
  double total = 0;
  std::set<std::pair<double, double>> on_rings;
  const auto expect_simple = [](const std::vector<Vec2>& ring) {
    std::set<std::pair<double, double>> places;
    for (const Vec2 p : ring) places.insert({p.x, p.y});
    EXPECT_EQ(places.size(), ring.size()) << "a ring touches itself";
  };
  for (const BandPolygon& polygon : bands.polygons) {
    EXPECT_GT(area(polygon.outer.points), 0);
    total += area(polygon.outer.points);
    expect_simple(polygon.outer.points);
    for (const Vec2 p : polygon.outer.points) on_rings.insert({p.x, p.y});
    for (const BandRing& hole : polygon.holes) {
      EXPECT_LT(area(hole.points), 0);
      total += area(hole.points);
      expect_simple(hole.points);
      for (const Vec2 p : hole.points) on_rings.insert({p.x, p.y});
      // A hole lies inside of its own outer ring: a point beside its first edge does.
      const Vec2 middle = 0.5 * (hole.points[0] + hole.points[1]);
      EXPECT_NE(winding(polygon.outer.points, middle), 0);
    }
  }
  EXPECT_NEAR(total, valid_area, 1e-9 * valid_area);
  for (const Vec2 p : set.points) EXPECT_TRUE(on_rings.contains({p.x, p.y}));
  for (int i = 0; i < 300; ++i) {
    const Vec2 p{random.uniform(low.x, high.x), random.uniform(low.y, high.y)};
    int covered = 0;
    for (const BandPolygon& polygon : bands.polygons) {
      int n = winding(polygon.outer.points, p);
      for (const BandRing& hole : polygon.holes) n += winding(hole.points, p);
      EXPECT_TRUE(n == 0 || n == 1);
      covered += n;
    }
    EXPECT_EQ(covered, valid(p) ? 1 : 0);
  }
}

TEST(Bands, CoverTheValidAreaExactlyOnce) {
  test::Random random;
  for (int round = 0; round < 60; ++round) {
    const int columns = 13, rows = 11;
    const double void_share = round % 3 == 0 ? 0.08 : 0;
    const Raster raster = test::contour_raster(
        columns, rows,
        [&](int, int) {
          return random.chance(void_share) ? std::numeric_limits<double>::quiet_NaN() : random.uniform(0, 10);
        },
        2, 3);
    const BicubicGrid grid = make_bicubic(raster);
    ContourExtras extras;
    extras.want_bands = true;
    const ContourSet set =
        trace_contours(grid, contour_levels(0, 10, 1.7), {.tolerance = 0.1, .simplify = round % 2 == 0}, {}, &extras);
    double valid_area = 0;
    for (int r = 0; r + 1 < rows; ++r)
      for (int c = 0; c + 1 < columns; ++c) valid_area += grid.has_patch(c, r) ? 6 : 0;
    expect_cover(
        set, extras.bands, valid_area, {0, -30}, {24, 0},
        [&](Vec2 p) { return grid.has_patch(static_cast<int>(p.x / 2), static_cast<int>(-p.y / 3)); }, random);
  }
}

TEST(Bands, OfTriangulatedSurfacesToo) {
  test::Random random;
  for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher})
    for (int round = 0; round < 6; ++round) {
      Terrain t;
      t.kind = kind;
      t.tin = test::delaunay(test::jittered_points(7, random.seed() + random.index(1000000)),
                             [&](Vec2) { return random.uniform(0, 10); });
      if (kind != SurfaceKind::linear)
        for (std::size_t i = 0; i < t.tin.points.size(); ++i)
          t.gradients.push_back({random.uniform(-100, 100), random.uniform(-100, 100)});
      if (kind == SurfaceKind::powell_sabin) t.edge_split = powell_sabin_splits(t.tin, build_edges(t.tin));
      ContourExtras extras;
      extras.want_bands = true;
      const ContourSet set = trace_contours(t, contour_levels(-20, 30, 1.9),
                                            {.tolerance = 0.002, .simplify = round % 2 == 0}, {}, &extras);
      expect_cover(
          set, extras.bands, 1, {0, 0}, {1, 1}, [](Vec2) { return true; }, random);
    }
}

TEST(Bands, WithoutLinesThereIsOneBand) {
  const Raster raster = test::contour_raster(5, 4, [](int c, int) { return 3.0 + 0.1 * c; });
  ContourExtras extras;
  extras.want_bands = true;
  const ContourSet set = trace_contours(make_bicubic(raster), {1, 10}, {.tolerance = 0.1}, {}, &extras);
  EXPECT_TRUE(set.lines.empty());
  ASSERT_EQ(extras.bands.polygons.size(), 1U);
  EXPECT_EQ(extras.bands.polygons[0].band, 1);
}

TEST(VoidCells, LinesOfAModelEndOnTheirBorder) {
  Terrain t;
  t.kind = SurfaceKind::linear;
  t.tin.points = {{0, 0}, {0, -8}, {8, -8}, {8, 0}};
  t.tin.heights = {0, 0, 8, 8};
  t.tin.triangles = {{0, 1, 2}, {0, 2, 3}};
  build_neighbors(t.tin);
  t.grid = {9, 9, 1, 1, Mask(9, 9, true)};
  t.grid.valid.set(3, 4, false);
  const ContourSet set = trace_contours(t, {3.2}, {.tolerance = 0.1});
  ASSERT_EQ(set.lines.size(), 2U);
  double length = 0;
  for (const test::Segment& s : test::segments(set)) {
    length += norm(s.b - s.a);
    EXPECT_TRUE(t.grid.has_data(0.5 * (s.a + s.b)));
  }
  EXPECT_NEAR(length, 7, 1e-9);
  ContourExtras extras;
  extras.want_bands = true;
  trace_contours(t, {3.2}, {.tolerance = 0.1}, {}, &extras);
  double total = 0;
  for (const BandPolygon& polygon : extras.bands.polygons) {
    total += area(polygon.outer.points);
    EXPECT_TRUE(polygon.holes.empty());  // the line runs through the cell without data: both bands stop at it
  }
  EXPECT_NEAR(total, 63, 1e-9);
  EXPECT_EQ(extras.bands.polygons.size(), 2U);
}

/// Random surfaces over grids with many holes, the outline through cells' corners and through cells without data.
TEST(VoidCells, BandsOfAModelCoverItsCellsWithData) {
  test::Random random;
  for (const SurfaceKind kind : {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher})
    for (int round = 0; round < 40; ++round) {
      SCOPED_TRACE(testing::Message() << "kind " << static_cast<int>(kind) << ", round " << round);
      constexpr int kSide = 12;
      constexpr double kWidth = 2, kHeight = 3;
      Terrain t;
      t.kind = kind;
      // Vertices at cells' centres, as fits make them, now and then at any place; the hull has slanting sides.
      std::set<std::pair<double, double>> places;
      const bool anywhere = round % 4 == 3;
      for (int i = 0; i < 30; ++i) {
        const auto place = [&] {
          return anywhere ? random.uniform(0, kSide - 1) : static_cast<double>(random.index(kSide));
        };
        places.insert({kWidth * place(), -kHeight * place()});
      }
      std::vector<Vec2> points;
      for (const auto& [x, y] : places) points.push_back({x, y});
      t.tin = test::delaunay(points, [&](Vec2) { return random.uniform(0, 10); });
      if (kind != SurfaceKind::linear)
        for (std::size_t i = 0; i < t.tin.points.size(); ++i)
          t.gradients.push_back({random.uniform(-5, 5), random.uniform(-5, 5)});
      if (kind == SurfaceKind::powell_sabin) t.edge_split = powell_sabin_splits(t.tin, build_edges(t.tin));
      t.grid = {kSide, kSide, kWidth, kHeight, Mask(kSide, kSide, true)};
      const double share = 0.05 + 0.1 * (round % 5);
      for (int r = 0; r < kSide; ++r)
        for (int c = 0; c < kSide; ++c)
          if (random.chance(share)) t.grid.valid.set(c, r, false);
      // The valid area, cell by cell: the outline's polygon clipped to each.
      const PointLocator locator(t.tin);
      double valid_area = 0;
      for (std::size_t k = 0; k < t.tin.triangle_count(); ++k)
        for (int r = 0; r < kSide; ++r)
          for (int c = 0; c < kSide; ++c)
            if (t.grid.valid.get(c, r))
              valid_area += test::clipped_area(
                  {t.tin.points[t.tin.triangles[k][0]], t.tin.points[t.tin.triangles[k][1]],
                   t.tin.points[t.tin.triangles[k][2]]},
                  {(c - 0.5) * kWidth, -(r + 0.5) * kHeight}, {(c + 0.5) * kWidth, -(r - 0.5) * kHeight});
      ContourExtras extras;
      extras.want_bands = true;
      const ContourSet set = trace_contours(t, contour_levels(-20, 30, round % 7 == 0 ? 60 : 1.9),
                                            {.tolerance = 0.05, .simplify = round % 2 == 0}, {}, &extras);
      expect_cover(
          set, extras.bands, valid_area, {0, -kHeight * kSide}, {kWidth * kSide, 0},
          [&](Vec2 p) { return t.grid.has_data(p) && locator.locate(p) != kNone; }, random);
      // Lines meet nowhere, but a line through a cell's corner may end there and start again on the other side.
      std::map<std::pair<double, double>, std::size_t> ends;
      std::size_t twice = 0;
      for (std::size_t l = 0; l < set.lines.size(); ++l)
        for (const std::size_t end : {set.lines[l].begin, set.lines[l].end - 1}) {
          const Vec2 p = set.points[end];
          const auto [other, first] = ends.emplace(std::pair{p.x, p.y}, l);
          if (set.lines[l].closed || first || other->second == l) continue;
          ++twice;
          EXPECT_EQ(std::abs(std::remainder(p.x, kWidth)), 0.5 * kWidth);
          EXPECT_EQ(std::abs(std::remainder(p.y, kHeight)), 0.5 * kHeight);
        }
      EXPECT_EQ(test::count_meetings(set, 1), twice);
    }
}

}  // namespace
}  // namespace retalho
