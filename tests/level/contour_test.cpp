// The promises of level/contour.h on bicubic grids.
#include "retalho/level/contour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "level/contour_support.h"
#include "retalho/core/error.h"
#include "retalho/raster/io.h"
#include "support/errors.h"

namespace retalho {
namespace {

using test::contour_raster;

Raster noise(test::Random& random, int columns, int rows) {
  return contour_raster(
      columns, rows, [&](int, int) { return random.uniform(0, 10); }, 2, 3);
}

/// Smooth hills: a few waves of random direction.
Raster hills(test::Random& random, int columns, int rows) {
  double kx[5], ky[5], phase[5], size[5];
  for (int i = 0; i < 5; ++i) {
    kx[i] = random.uniform(-0.6, 0.6);
    ky[i] = random.uniform(-0.6, 0.6);
    phase[i] = random.uniform(0, 6.28);
    size[i] = random.uniform(1, 10);
  }
  return contour_raster(columns, rows, [&](int c, int r) {
    double z = 0;
    for (int i = 0; i < 5; ++i) z += size[i] * std::sin(kx[i] * c + ky[i] * r + phase[i]);
    return z;
  });
}

double right_of(const Raster& r) {
  return (r.columns - 1) * r.cell_width;
}
double bottom_of(const Raster& r) {
  return -(r.rows - 1) * r.cell_height;
}

bool on_border(const Raster& r, Vec2 p) {
  return p.x == 0 || p.y == 0 || p.x == right_of(r) || p.y == bottom_of(r);
}

void expect_sound(const Raster& raster, const ContourSet& set) {
  for (const ContourLine& line : set.lines) {
    ASSERT_LT(line.begin, line.end);
    if (line.closed) continue;
    EXPECT_TRUE(on_border(raster, set.points[line.begin]));
    EXPECT_TRUE(on_border(raster, set.points[line.end - 1]));
  }
  EXPECT_EQ(test::count_meetings(set, raster.cell_width), 0U);
}

TEST(Contours, LinesAreClosedOrEndOnTheBorder) {
  test::Random random;
  for (int round = 0; round < 40 * test::soak(); ++round) {
    const Raster raster = noise(random, 9, 90);
    const BicubicGrid grid = make_bicubic(raster);
    const ContourSet set =
        trace_contours(grid, contour_levels(0, 10, 0.73), {.tolerance = 0.1, .simplify = round % 2 == 0});
    EXPECT_EQ(set.singular.size(), 0U);
    expect_sound(raster, set);
  }
}

TEST(Contours, AnUndecidedStretchIsReportedOnceWithItsBox) {
  // Along row 64, where two of the tracer's strips meet, the surface touches the level at u = 1/6, which no halving
  // reaches: in half quanta above the level its ordinates are s (1, -3, 5, 25), which is s (6u - 1)^2.
  constexpr double kQuantum = 1.0 / 4, kS = 1001;
  constexpr int kRow = 64;
  BicubicGrid grid;
  grid.columns = 2;
  grid.rows = 2 * kRow + 1;
  grid.cell_width = 10;
  grid.cell_height = 10;
  const auto n = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  const double base = 1'500'000;  // the largest number: 4 quanta a unit
  grid.z.assign(n, base + 12 * kS * kQuantum);
  grid.zu.assign(n, 0);
  grid.zv.assign(n, 0);
  grid.zuv.assign(n, 0);
  grid.z[2 * kRow] = base;
  grid.zu[2 * kRow] = 3 * -2 * kS * kQuantum;
  grid.zu[2 * kRow + 1] = 3 * 10 * kS * kQuantum;
  const ContourSet set = trace_contours(grid, {base - 0.5 * kS * kQuantum}, {.tolerance = 0.1});
  std::vector<SingularPlace> flat;
  for (const SingularPlace& place : set.singular)
    if (place.low.y == place.high.y) flat.push_back(place);
  ASSERT_EQ(flat.size(), 1U);
  EXPECT_LE(flat[0].low.x, 10.0 / 6);
  EXPECT_GE(flat[0].high.x, 10.0 / 6);
  EXPECT_LE(flat[0].high.x - flat[0].low.x, 10 * std::ldexp(1.0, -17));
}

TEST(Contours, StreamedAndCollectedLinesAreThoseOfTheWholeSurface) {
  test::Random random;
  for (int round = 0; round < 12 * test::soak(); ++round) {
    // Three strips of rows, with voids in every other round.
    Raster raster = round % 3 == 0 ? noise(random, 9, 140) : hills(random, 24, 150);
    if (round % 2 == 0)
      std::visit(
          [&](auto& heights) {
            for (int i = 0; i < 12; ++i)
              heights[static_cast<std::size_t>(random.uniform(0, static_cast<double>(heights.size() - 1)))] = NAN;
          },
          raster.heights);
    BicubicOptions surface;
    surface.twist = round % 4 == 3 ? Twist::adini : round % 4 == 1 ? Twist::zero : Twist::spline;
    const std::vector<double> levels = contour_levels(-30, 30, 1.37);
    const ContourOptions options{.tolerance = 0.1, .simplify = round % 4 < 2};
    const ContourSet whole = trace_contours(make_bicubic(raster, surface), levels, options);
    const ContourSet collected = trace_contours(raster, surface, levels, options, {.threads = 3});
    EXPECT_EQ(whole.points, collected.points);
    ASSERT_EQ(whole.lines.size(), collected.lines.size());
    EXPECT_EQ(whole.height_quantum, collected.height_quantum);
    std::size_t lines = 0, points = 0;
    const ContourSet rest = stream_contours(raster, surface, levels, options,
                                            [&](const ContourSet& part) {
                                              EXPECT_EQ(part.levels, levels);
                                              lines += part.lines.size();
                                              for (const ContourLine& line : part.lines)
                                                points += line.end - line.begin;
                                            },
                                            {.threads = 2});
    EXPECT_EQ(lines, whole.lines.size());
    EXPECT_EQ(points, whole.points.size());
    EXPECT_EQ(rest.singular.size(), whole.singular.size());
  }
}

TEST(Contours, ComponentsEqualABruteForceCount) {
  test::Random random;
  for (int round = 0; round < 1000 * test::soak(); ++round) {
    const Raster raster = round % 20 == 0   ? noise(random, 6, 7)
                          : round % 50 == 1 ? hills(random, 20, 20)
                          : round % 2 == 0  ? noise(random, 3, 3)
                                            : hills(random, 4, 5);
    const BicubicGrid grid = make_bicubic(raster);
    const std::vector<double> levels{1.2345, 3.3321, 5.0171, 7.7177};
    const ContourSet set = trace_contours(grid, levels, {.tolerance = 0.05, .simplify = false});
    const int k = raster.columns < 20 ? 96 : 40;
    const auto columns = static_cast<std::size_t>((raster.columns - 1) * k + 1),
               rows = static_cast<std::size_t>((raster.rows - 1) * k + 1);
    std::vector<double> z(columns * rows);
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        const Vec2 p{std::min(right_of(raster), static_cast<double>(c) / k * raster.cell_width),
                     std::max(bottom_of(raster), -static_cast<double>(r) / k * raster.cell_height)};
        z[r * columns + c] = grid.at(p)->value;
      }
    for (std::size_t l = 0; l < levels.size(); ++l) {
      std::vector<char> above(z.size());
      for (std::size_t i = 0; i < z.size(); ++i) above[i] = z[i] >= levels[l];
      std::size_t lines = 0;
      for (const ContourLine& line : set.lines) lines += line.level == static_cast<int>(l);
      EXPECT_EQ(lines + 1, test::count_regions(above, columns, rows)) << "round " << round << " level " << levels[l];
    }
  }
}

TEST(Contours, ChordsStayWithinTheToleranceAndTheTube) {
  test::Random random;
  for (int round = 0; round < 20; ++round) {
    const Raster raster = round % 2 == 0 ? noise(random, 12, 12) : hills(random, 25, 25);
    const BicubicGrid grid = make_bicubic(raster);
    const double step = 0.5, tolerance = 0.05;
    const ContourSet set =
        trace_contours(grid, contour_levels(-40, 40, step), {.tolerance = tolerance, .simplify = round % 3 != 0});
    for (const test::Segment& s : test::segments(set)) {
      for (int i = 0; i <= 4; ++i) {
        Vec2 p = s.a + (i / 4.0) * (s.b - s.a);
        p = {std::clamp(p.x, 0.0, right_of(raster)), std::clamp(p.y, bottom_of(raster), 0.0)};
        const Jet jet = *grid.at(p);
        const double off = jet.value - set.levels[static_cast<std::size_t>(s.level)];
        EXPECT_LE(std::abs(off), step / 2);
      }
    }
  }
}

double distance(Vec2 p, const test::Segment& s) {
  const Vec2 d = s.b - s.a;
  const double t = norm2(d) > 0 ? std::clamp(dot(p - s.a, d) / norm2(d), 0.0, 1.0) : 0;
  return norm(p - s.a - t * d);
}

/// Largest distance from points of `from`'s lines to the nearest line of the same level of `to`.
double one_way(const ContourSet& from, const ContourSet& to) {
  const std::vector<test::Segment> a = test::segments(from), b = test::segments(to);
  double worst = 0;
  for (const test::Segment& s : a)
    for (const double t : {0.0, 0.5}) {
      const Vec2 p = s.a + t * (s.b - s.a);
      double nearest = 1e300;
      for (const test::Segment& other : b)
        if (other.level == s.level) nearest = std::min(nearest, distance(p, other));
      worst = std::max(worst, nearest);
    }
  return worst;
}

TEST(Contours, LinesAndLevelSetsAreWithinTheToleranceBothWays) {
  test::Random random;
  for (int round = 0; round < 16; ++round) {
    const Raster raster = round % 2 == 0 ? noise(random, 7, 7) : hills(random, 14, 14);
    const BicubicGrid grid = make_bicubic(raster);
    const std::vector<double> levels{1.2345, 4.3321, 7.0171};
    // The reference is a hundred times as close to the level set.
    const double tolerance = 0.2;
    const ContourSet truth = trace_contours(grid, levels, {.tolerance = tolerance / 100, .simplify = false});
    for (const bool simplify : {false, true}) {
      const ContourSet set = trace_contours(grid, levels, {.tolerance = tolerance, .simplify = simplify});
      EXPECT_EQ(set.lines.size(), truth.lines.size());
      EXPECT_LE(one_way(set, truth), 1.01 * tolerance);
      EXPECT_LE(one_way(truth, set), 1.01 * tolerance);
      if (simplify) {
        EXPECT_LT(set.points.size(), truth.points.size() / 2);
      }
    }
  }
}

TEST(Contours, PlateausGiveTheirOutlineOnce) {
  // A lake at 10 in a rising plain, and an island in it; the level is the lake's own height.
  const Raster raster = contour_raster(30, 30, [](int c, int r) {
    const double d = std::hypot(c - 14.5, r - 14.5);
    return d < 4 ? 12.0 : d < 10 ? 10.0 : std::floor(d);
  });
  const ContourSet set = trace_contours(make_bicubic(raster), {10}, {.tolerance = 0.05});
  for (const ContourLine& line : set.lines) EXPECT_TRUE(line.closed);
  EXPECT_LE(set.lines.size(), 2U);
  // Far from any flat the level 11 is an ordinary line: one ring around the lake, one around the island.
  EXPECT_EQ(trace_contours(make_bicubic(raster), {11.5}, {.tolerance = 0.05}).lines.size(), 2U);
}

TEST(Contours, AHeightOnTheGridLineOrAConstantGridIsNoTrouble) {
  const Raster plane = contour_raster(9, 9, [](int c, int) { return c; });
  EXPECT_EQ(trace_contours(make_bicubic(plane, {.keep_flats = false}), {1, 2, 3, 4, 5, 6, 7, 8}, {.tolerance = 0.1})
                .lines.size(),
            8U);
  const Raster constant = contour_raster(9, 9, [](int, int) { return 10.0; });
  EXPECT_EQ(trace_contours(make_bicubic(constant), {10}, {.tolerance = 0.1}).lines.size(), 0U);
  const Raster saddle = contour_raster(9, 9, [](int c, int r) { return (c - 4.0) * (r - 4.0); });
  const ContourSet set = trace_contours(make_bicubic(saddle, {.keep_flats = false}), {0}, {.tolerance = 0.1});
  EXPECT_EQ(set.lines.size(), 2U);  // the high ground is joined through the saddle
  EXPECT_EQ(test::count_meetings(set, 1), 0U);
}

TEST(Contours, TheSeaAtALevelComesOutClean) {
  RETALHO_DATA_FILE(path, "dem/N48W125.hgt.zip");
  const Raster raster = read_raster(path);
  const ContourSet set = trace_contours(make_bicubic(raster), {0}, {.tolerance = 2});
  EXPECT_LT(set.lines.size(), 600U);
  EXPECT_EQ(test::count_meetings(set, 200), 0U);
}

TEST(Contours, HighGroundLiesToTheLeft) {
  const Raster raster = contour_raster(12, 9, [](int c, int r) { return -std::hypot(c - 5.3, r - 4.1); });
  const ContourSet set = trace_contours(make_bicubic(raster), {-2.5}, {.tolerance = 0.01, .simplify = false});
  ASSERT_EQ(set.lines.size(), 1U);
  EXPECT_TRUE(set.lines[0].closed);
  double area = 0;
  const std::size_t n = set.points.size();
  for (std::size_t i = 0; i < n; ++i) area += cross(set.points[i], set.points[(i + 1) % n]) / 2;
  EXPECT_NEAR(area, 3.14159265 * 2.5 * 2.5, 0.2);  // a hill's line runs counter-clockwise
}

TEST(Contours, TheSameBytesFromAnyNumberOfThreads) {
  test::Random random;
  const Raster raster = noise(random, 40, 300);
  const BicubicGrid grid = make_bicubic(raster);
  const std::vector<double> levels = contour_levels(0, 10, 0.9);
  const ContourSet one = trace_contours(grid, levels, {.tolerance = 0.1}, {.threads = 1});
  const ContourSet many = trace_contours(grid, levels, {.tolerance = 0.1}, {.threads = 3});
  EXPECT_TRUE(one.points == many.points);
  EXPECT_EQ(one.lines.size(), many.lines.size());
}

TEST(Contours, RefusesWhatMakesNoSense) {
  const Raster raster = contour_raster(4, 4, [](int c, int) { return c; });
  const BicubicGrid grid = make_bicubic(raster);
  EXPECT_THROW(trace_contours(grid, {1}, {.tolerance = 0}), BadInput);
  EXPECT_THROW(trace_contours(grid, {2, 1}, {.tolerance = 1}), BadInput);
  EXPECT_THROW(trace_contours(grid, {1, 1 + 1e-12}, {.tolerance = 1}), BadInput);
  EXPECT_THROW(contour_levels(0, 1, 0), BadInput);
  EXPECT_THROW(contour_levels(0, 1, 1e-9), BadInput);
}

}  // namespace
}  // namespace retalho
