// The promises of level/line_curves.h and level/cubic.h.
#include "retalho/level/line_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>

#include "level/contour_support.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/raster/io.h"
#include "retalho/tin/refine.h"
#include "support/paths.h"

namespace retalho {
namespace {

Vec2 at(const Cubic& c, double t) {
  const double s = 1 - t;
  return s * s * s * c[0] + 3 * s * s * t * c[1] + 3 * s * t * t * c[2] + t * t * t * c[3];
}

double distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double t = norm2(d) > 0 ? std::clamp(dot(p - a, d) / norm2(d), 0.0, 1.0) : 0;
  return norm(p - a - t * d);
}

/// The curves as polylines of many points, in the form that the crossing counter takes.
ContourSet dense(const CurveSet& set, int parts) {
  ContourSet out;
  for (const CurveLine& line : set.lines) {
    ContourLine l{line.level, line.closed, out.points.size(), 0};
    for (std::size_t k = line.begin; k < line.end; ++k)
      for (int i = 0; i < parts; ++i) out.points.push_back(at(set.pieces[k].points, static_cast<double>(i) / parts));
    if (!line.closed) out.points.push_back(set.pieces[line.end - 1].points[3]);
    l.end = out.points.size();
    out.lines.push_back(l);
  }
  return out;
}

/// How many points of `from` are farther than `limit` from their own line in `to`; both have the same lines.
std::size_t count_beyond(const ContourSet& from, const ContourSet& to, double limit) {
  std::size_t beyond = 0;
  const double bin = std::max(8 * limit, 0.25);
  const auto cell = [&](double x) { return static_cast<std::int64_t>(std::floor(x / bin)); };
  for (std::size_t l = 0; l < from.lines.size(); ++l) {
    const ContourLine &a = from.lines[l], &b = to.lines[l];
    const std::size_t n = b.end - b.begin, sides = b.closed ? n : n - 1;
    const auto side = [&](std::size_t k) {
      return std::pair{to.points[b.begin + k], to.points[b.begin + (k + 1) % n]};
    };
    std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> bins;
    for (std::size_t k = 0; k < sides; ++k) {
      const auto [p, q] = side(k);
      for (std::int64_t x = cell(std::min(p.x, q.x) - limit); x <= cell(std::max(p.x, q.x) + limit); ++x)
        for (std::int64_t y = cell(std::min(p.y, q.y) - limit); y <= cell(std::max(p.y, q.y) + limit); ++y)
          bins[{x, y}].push_back(k);
    }
    for (std::size_t i = a.begin; i < a.end; ++i) {
      const Vec2 p = from.points[i];
      const std::vector<std::size_t>& near = bins[{cell(p.x), cell(p.y)}];
      if (std::none_of(near.begin(), near.end(),
                       [&](std::size_t k) { return distance_to_segment(p, side(k).first, side(k).second) <= limit; }))
        ++beyond;
    }
  }
  return beyond;
}

/// How far the chords of `parts` samples a piece may lie from the curves: an eighth of the second derivative times the
/// squared step.
double sagitta(const CurveSet& set, int parts) {
  double most = 0;
  for (const CurvePiece& piece : set.pieces)
    for (int i = 0; i < 2; ++i)
      most = std::max(most, 6 * norm(piece.points[i + 2] - 2 * piece.points[i + 1] + piece.points[i]));
  return most / 8 / parts / parts;
}

/// Chords of two curves that are very near may cross where the curves do not: then many more of them are looked at.
std::size_t count_curve_meetings(const CurveSet& set, double bin) {
  const std::size_t few = test::count_meetings(dense(set, 32), bin);
  return few == 0 ? 0 : test::count_meetings(dense(set, 1024), bin / 8);
}

struct Fitted {
  ContourSet traced;
  CurveSet curves;
};

Fitted fit(const Raster& raster, double step, double tolerance, bool ring = false) {
  const BicubicGrid grid = make_bicubic(raster, {.keep_flats = !ring});
  const auto [low, high] = std::minmax_element(grid.z.begin(), grid.z.end());
  Fitted f;
  f.traced = trace_contours(grid, contour_levels(*low - 1, *high + 1, step), {tolerance / 5, false});
  f.curves = fit_line_curves(f.traced, {0.8 * tolerance, tolerance / 5});
  return f;
}

Raster waves(test::Random& random, int columns, int rows) {
  double kx[4], ky[4], phase[4];
  for (int i = 0; i < 4; ++i) {
    kx[i] = random.uniform(-0.7, 0.7);
    ky[i] = random.uniform(-0.7, 0.7);
    phase[i] = random.uniform(0, 6.28);
  }
  return test::contour_raster(columns, rows, [&](int c, int r) {
    double z = 0;
    for (int i = 0; i < 4; ++i) z += 5 * std::sin(kx[i] * c + ky[i] * r + phase[i]);
    return z;
  });
}

/// Joints where two pieces do not go on in one direction.
std::size_t kinks(const CurveSet& set) {
  std::size_t count = 0;
  for (const CurveLine& line : set.lines)
    for (std::size_t k = line.begin; k < line.end; ++k) {
      if (k + 1 == line.end && !line.closed) continue;
      const Cubic &a = set.pieces[k].points, &b = set.pieces[k + 1 == line.end ? line.begin : k + 1].points;
      const Vec2 u = a[3] - a[2], v = b[1] - b[0];
      if (std::abs(std::atan2(cross(u, v), dot(u, v))) > 1e-6) ++count;
    }
  return count;
}

void expect_kept(const Fitted& f, double tolerance) {
  ASSERT_EQ(f.curves.lines.size(), f.traced.lines.size());
  for (const CurveLine& line : f.curves.lines) {
    for (std::size_t k = line.begin + 1; k < line.end; ++k)
      ASSERT_EQ(f.curves.pieces[k].points[0], f.curves.pieces[k - 1].points[3]);
    if (line.closed) {
      ASSERT_EQ(f.curves.pieces[line.end - 1].points[3], f.curves.pieces[line.begin].points[0]);
    }
  }
  const ContourSet many = dense(f.curves, 32);
  EXPECT_EQ(count_beyond(many, f.traced, 0.8 * tolerance * (1 + 1e-9)), 0U);
  EXPECT_EQ(count_beyond(f.traced, many, 0.8 * tolerance + sagitta(f.curves, 32)), 0U);
  EXPECT_EQ(count_curve_meetings(f.curves, 1), 0U);
  EXPECT_EQ(f.curves.unproved, 0U);
}

TEST(LineCurves, CurvesAndTracedLinesAreWithinTheToleranceAndNoTwoMeet) {
  test::Random random;
  for (int round = 0; round < 6 * test::soak(); ++round) {
    const Fitted f = fit(waves(random, 24, 20), random.uniform(0.7, 2), 0.1);
    ASSERT_GT(f.curves.lines.size(), 5U);
    expect_kept(f, 0.1);
    // Fewer pieces than vertices, or it would be no drawing in curves.
    EXPECT_LT(3 * f.curves.pieces.size(), f.traced.points.size());
  }
}

TEST(LineCurves, RoughGroundAndWideTolerances) {
  test::Random random;
  std::size_t refined = 0;
  for (int round = 0; round < 4 * test::soak(); ++round) {
    const Raster noise = test::contour_raster(16, 14, [&](int, int) { return random.uniform(0, 10); });
    const Fitted f = fit(noise, 0.5, 0.6);  // a tolerance far wider than the lines lie apart
    expect_kept(f, 0.6);
    refined += f.curves.straight;
  }
  EXPECT_GT(refined, 0U) << "no case was hard enough to fall back to a traced line";
}

TEST(LineCurves, NeighboursShareTheirTangentUnlessTheLineHasACornerOrFellBack) {
  test::Random random;
  for (int round = 0; round < 5; ++round) {
    const Fitted f = fit(waves(random, 24, 20), 1, 0.1);
    EXPECT_LE(kinks(f.curves), f.curves.corners + 2 * f.curves.straight);
    EXPECT_EQ(f.curves.corners, 0U) << "the lines of a C2 surface have none";
    EXPECT_GT(f.curves.pieces.size(), 100U);
  }
}

TEST(LineCurves, CornersAreKept) {
  // Squares around a pyramid: straight sides, corners of 90 degrees.
  ContourSet set;
  set.levels = {1, 2, 3};
  for (int k = 0; k < 3; ++k) {
    const double s = 10 - 3 * k;
    ContourLine line{k, true, set.points.size(), 0};
    for (const Vec2 p : {Vec2{-s, -s}, Vec2{0, -s}, Vec2{s, -s}, Vec2{s, s}, Vec2{-s, s}}) set.points.push_back(p);
    line.end = set.points.size();
    set.lines.push_back(line);
  }
  const CurveSet curves = fit_line_curves(set, {0.08, 0.02});
  EXPECT_EQ(curves.corners, 12U);
  EXPECT_EQ(kinks(curves), 12U);
  EXPECT_EQ(count_beyond(dense(curves, 64), set, 1e-9), 0U);
}

TEST(LineCurves, WhereACurveWouldMeetAnotherTheTracedLineStands) {
  // Two combs whose teeth reach between each other: round them and they meet.
  ContourSet set;
  set.levels = {1, 2};
  for (int k = 0; k < 2; ++k) {
    ContourLine line{k, false, set.points.size(), 0};
    const double shift = 0.004 * k;
    for (int i = 0; i < 60; ++i) set.points.push_back({0.05 * i, shift + (i % 2 == 0 ? 0.02 : -0.02)});
    line.end = set.points.size();
    set.lines.push_back(line);
  }
  // With so coarse a trace, a zigzag of this size may be a smooth line's.
  const CurveSet curves = fit_line_curves(set, {0.05, 0.05});
  EXPECT_EQ(curves.corners, 0U);
  EXPECT_EQ(count_curve_meetings(curves, 0.1), 0U);
  EXPECT_EQ(curves.unproved, 0U);
}

TEST(LineCurves, NumbersAreWholeMultiplesOfTheUnit) {
  test::Random random;
  Fitted f = fit(waves(random, 16, 16), 1, 0.1);
  constexpr double kUnits = 1e5;
  for (Vec2& p : f.traced.points) p = {std::round(p.x * kUnits) / kUnits, std::round(p.y * kUnits) / kUnits};
  const CurveSet curves = fit_line_curves(f.traced, {0.08, 0.02, kUnits});
  std::size_t checked = 0;
  for (const CurvePiece& piece : curves.pieces) {
    if (piece.straight) continue;
    for (const Vec2 p : piece.points) {
      ASSERT_EQ(p.x, std::round(p.x * kUnits) / kUnits);
      ASSERT_EQ(p.y, std::round(p.y * kUnits) / kUnits);
      ++checked;
    }
  }
  EXPECT_GT(checked, 100U);
  EXPECT_EQ(count_curve_meetings(curves, 1), 0U);
}

TEST(LineCurves, ASeaATableAndVoids) {
  test::Random random;
  const auto land = [](int c, int r) {
    return 30 - 2.2 * std::hypot(c - 14, r - 11) + 3 * std::sin(0.9 * c + 0.4 * r);
  };
  const Raster sea = test::contour_raster(30, 24, [&](int c, int r) { return std::max(0.0, std::round(land(c, r))); });
  expect_kept(fit(sea, 2, 0.1), 0.1);
  const Raster table =
      test::contour_raster(30, 24, [&](int c, int r) { return std::min(15.0, std::round(land(c, r))); });
  expect_kept(fit(table, 5, 0.1), 0.1);
  const Raster voids = test::contour_raster(30, 24, [&](int c, int r) {
    return (c * 7 + r * 5) % 23 < 2 ? std::numeric_limits<double>::quiet_NaN() : land(c, r);
  });
  const Fitted f = fit(voids, 2, 0.1);
  EXPECT_GT(f.curves.lines.size(), 20U);
  expect_kept(f, 0.1);
}

TEST(LineCurves, TheSameFromAnyNumberOfThreadsAndNothingFromNothing) {
  test::Random random;
  const Fitted f = fit(waves(random, 40, 40), 0.5, 0.1);
  const CurveSet one = fit_line_curves(f.traced, {0.08, 0.02}, {.threads = 1});
  const CurveSet four = fit_line_curves(f.traced, {0.08, 0.02}, {.threads = 4});
  ASSERT_EQ(one.pieces.size(), four.pieces.size());
  for (std::size_t i = 0; i < one.pieces.size(); ++i) ASSERT_EQ(one.pieces[i].points, four.pieces[i].points);
  EXPECT_TRUE(fit_line_curves({}, {0.1, 0.1}).pieces.empty());
  EXPECT_THROW(fit_line_curves({}, {0, 0.1}), BadInput);
  EXPECT_THROW(fit_line_curves({}, {std::numeric_limits<double>::quiet_NaN(), 0.1}), BadInput);
}

TEST(LineCurves, JacksboroWithoutAMeeting) {
  const Raster raster = read_raster(test::source_folder() + "/examples/jacksboro.vrt");
  const BicubicGrid grid = make_bicubic(raster);
  const double tolerance = 0.1 * raster.cell_width;
  const ContourSet traced = trace_contours(grid, contour_levels(200, 1100, 100), {tolerance / 5, false});
  const CurveSet curves = fit_line_curves(traced, {0.8 * tolerance, tolerance / 5});
  EXPECT_EQ(curves.unproved, 0U);
  EXPECT_EQ(count_curve_meetings(curves, raster.cell_width), 0U);
  EXPECT_LT(5 * curves.pieces.size(), traced.points.size());
  EXPECT_LT(100 * curves.straight, curves.pieces.size());
}

/// Do two curves cross, by dense chords?
bool cross_by_samples(const Cubic& a, const Cubic& b) {
  ContourSet set;
  set.levels = {0};
  for (const Cubic* c : {&a, &b}) {
    ContourLine line{0, false, set.points.size(), 0};
    for (int i = 0; i <= 400; ++i) set.points.push_back(at(*c, i / 400.0));
    line.end = set.points.size();
    set.lines.push_back(line);
  }
  // A curve may cross itself: only pairs of different lines count.
  ContourSet first = set, second = set;
  first.lines.pop_back();
  second.lines.erase(second.lines.begin());
  return test::count_meetings(set, 0.1) > test::count_meetings(first, 0.1) + test::count_meetings(second, 0.1);
}

TEST(Apart, NeverSaysYesToCurvesThatMeet) {
  test::Random random;
  int met = 0, clear = 0;
  for (int round = 0; round < 300 * test::soak(); ++round) {
    Cubic a, b;
    for (Vec2& p : a) p = {random.uniform(), random.uniform()};
    const double shift = random.uniform(0, 1);
    for (Vec2& p : b) p = {random.uniform() + shift, random.uniform()};
    const bool crossing = cross_by_samples(a, b), proved = apart(a, b, false, false);
    EXPECT_FALSE(crossing && proved);
    met += crossing ? 1 : 0;
    clear += proved ? 1 : 0;
    if (!crossing && !proved) {
      // A near miss that samples cannot see; seldom.
      double least = 1;
      for (int i = 0; i <= 200; ++i)
        for (int j = 0; j <= 200; ++j) least = std::min(least, norm(at(a, i / 200.0) - at(b, j / 200.0)));
      EXPECT_LT(least, 0.02);
    }
  }
  EXPECT_GT(met, 30);
  EXPECT_GT(clear, 30);
}

TEST(Apart, JointsAreNoMeetingsButCrossingsBehindThemAre) {
  const Cubic a{{{0, 0}, {1, 0}, {2, 1}, {3, 1}}}, on{{{3, 1}, {4, 1}, {5, 0}, {6, 0}}};
  EXPECT_TRUE(apart(a, on, true, false));
  EXPECT_TRUE(apart(on, a, false, true));
  EXPECT_FALSE(apart(a, on, false, false));             // without the joint's excuse they meet
  const Cubic back{{{3, 1}, {4, 1}, {2, -3}, {1, 3}}};  // turns round and crosses a
  EXPECT_FALSE(apart(a, back, true, false));
  const Cubic half{{{0, 0}, {0, 1.3}, {2, 1.3}, {2, 0}}}, other{{{2, 0}, {2, -1.3}, {0, -1.3}, {0, 0}}};
  EXPECT_TRUE(apart(half, other, true, true));  // a loop of two pieces
  EXPECT_FALSE(apart(half, half, false, false));
}

}  // namespace
}  // namespace retalho
