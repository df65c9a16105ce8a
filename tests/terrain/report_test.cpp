// The error report against sums made here cell by cell; ties, voids, threads; and the finding that the house starts
// from.
#include "retalho/terrain/report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "brute_force.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"
#include "support/support.h"
#include "synthetic.h"

namespace retalho {
namespace {

using namespace test;

Raster grid(int columns, int rows, const auto& height) {
  Raster r;
  r.columns = columns;
  r.rows = rows;
  r.cell_width = 3;
  r.cell_height = 2;
  r.georef.origin_x = 500000;
  r.georef.origin_y = 7000000;
  std::vector<float> z(r.cells());
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) z[r.index(x, y)] = static_cast<float>(height(x, y));
  r.heights = std::move(z);
  return r;
}

double hills(int x, int y) {
  return std::floor(80 * std::sin(x * 0.06) * std::cos(y * 0.05) + 12 * std::sin(x * 0.31 + y * 0.2));
}

constexpr SurfaceKind kKinds[] = {SurfaceKind::linear, SurfaceKind::powell_sabin, SurfaceKind::clough_tocher};

TEST(Report, IsTheSumOverTheCells) {
  const Raster r = grid(150, 110, [](int x, int y) {
    return (x - 90) * (x - 90) + (y - 40) * (y - 40) < 200 ? std::numeric_limits<double>::quiet_NaN() : hills(x, y);
  });
  for (const SurfaceKind kind : kKinds) {
    const Terrain terrain = make_terrain(refine_tin(r, {.max_error = 6}), r, {.surface = kind});
    const TerrainEvaluator evaluator(terrain);
    double sum = 0, worst = 0, slope = 0;
    std::size_t valid = 0, sloped = 0, over = 0;
    Vec2 at{};
    for (int y = 0; y < r.rows; ++y)
      for (int x = 0; x < r.columns; ++x) {
        if (!r.valid(x, y)) continue;
        ++valid;
        const Vec2 p = r.centre(x, y);
        const double e = std::abs(evaluator.value(p) - r.at(x, y));
        sum += e * e;
        over += e > 3 + 1e-9 ? 1U : 0U;
        if (e > worst + 1e-9) {
          worst = e;
          at = r.georef.to_crs(p);
        }
        if (x == 0 || y == 0 || x == r.columns - 1 || y == r.rows - 1) continue;
        if (!r.valid(x - 1, y) || !r.valid(x + 1, y) || !r.valid(x, y - 1) || !r.valid(x, y + 1)) continue;
        if (kind == SurfaceKind::linear) continue;  // on an edge a flat surface has two slopes
        const Vec2 d{(r.at(x + 1, y) - r.at(x - 1, y)) / 6, (r.at(x, y - 1) - r.at(x, y + 1)) / 4};
        slope += norm2(evaluator.jet(p)->gradient - d);
        ++sloped;
      }
    const ErrorReport report = assess(terrain, r, 3);
    EXPECT_EQ(report.cells, r.cells());
    EXPECT_EQ(report.valid_cells, valid);
    EXPECT_EQ(report.uncovered, 0U);
    EXPECT_EQ(report.violations, over);
    EXPECT_NEAR(report.rmse, std::sqrt(sum / static_cast<double>(valid)), 1e-9);
    EXPECT_NEAR(report.max_error, worst, 1e-9);
    EXPECT_NEAR(report.max_error_at.x, at.x, 1e-6);
    EXPECT_NEAR(report.max_error_at.y, at.y, 1e-6);
    if (sloped > 0) {
      EXPECT_NEAR(report.slope_rmse, std::sqrt(slope / static_cast<double>(sloped)), 1e-9);
    }
    EXPECT_GT(worst, 3);
  }
}

TEST(Report, AnErrorOfExactlyTheToleranceIsNoViolation) {
  const Raster r = grid(200, 160, hills);
  for (const double tolerance : {1.0, 2.0, 5.0, 9.0}) {
    const Terrain terrain = make_terrain(refine_tin(r, {.max_error = tolerance}), r, {.surface = SurfaceKind::linear});
    const ErrorReport report = assess(terrain, r, tolerance);
    EXPECT_EQ(report.violations, 0U) << tolerance;
    EXPECT_LE(report.max_error, tolerance);
    EXPECT_GT(assess(terrain, r, report.max_error * (1 - 1e-9)).violations, 0U);
  }
}

TEST(Report, SameFromAnyNumberOfThreads) {
  const Raster r = grid(300, 260, hills);
  const Terrain terrain = make_terrain(refine_tin(r, {.max_error = 4}), r);
  Context one, many;
  one.threads = 1;
  many.threads = 7;
  const ErrorReport a = assess(terrain, r, 2, one), b = assess(terrain, r, 2, many);
  EXPECT_EQ(a.rmse, b.rmse);
  EXPECT_EQ(a.slope_rmse, b.slope_rmse);
  EXPECT_EQ(a.max_error, b.max_error);
  EXPECT_EQ(a.violations, b.violations);
}

TEST(Report, RefusesAModelThatCoversNothing) {
  const Raster r = grid(20, 20, hills);
  Raster elsewhere = r;
  elsewhere.georef.origin_x += 1e6;
  const Terrain terrain = make_terrain(refine_tin(r, {.max_error = 4}), r);
  EXPECT_THROW(assess(terrain, elsewhere), BadInput);
}

// Affine maps of the plane: the incentres of Powell-Sabin and the perpendiculars of Clough-Tocher follow those that
// keep angles; Clough-Tocher's cubic variant, which knows no right angle, follows all of them.
TEST(Surfaces, FollowAffineMapsWhereTheyMay) {
  std::mt19937_64 random(test_seed());
  std::uniform_real_distribution<double> unit(0, 1);
  const std::vector<Vec2> points = random_points_with_border(120, 9);
  const Tin tin = delaunay(points, franke);
  int compared = 0;
  struct Map {
    double a, b, c, d;
    bool keeps_angles;
  };
  const auto turned = [](double angle, double scale) {
    return Map{scale * std::cos(angle), -scale * std::sin(angle), scale * std::sin(angle), scale * std::cos(angle),
               true};
  };
  for (const Map m : {turned(0.7, 3), turned(-2, 0.2), Map{1.5, 0.4, -0.2, 0.8, false}}) {
    const auto move = [&](Vec2 p) { return Vec2{m.a * p.x + m.b * p.y + 5, m.c * p.x + m.d * p.y - 2}; };
    const double det = m.a * m.d - m.b * m.c;
    const auto carry = [&](Vec2 g) { return Vec2{(m.d * g.x - m.c * g.y) / det, (m.a * g.y - m.b * g.x) / det}; };
    std::vector<Vec2> gradients, carried;
    for (std::size_t i = 0; i < tin.vertex_count(); ++i) {
      gradients.push_back({unit(random) - 0.5, unit(random) - 0.5});
      carried.push_back(carry(gradients.back()));
    }
    Tin moved = tin;
    for (Vec2& p : moved.points) p = move(p);
    const auto surface = [&](const Tin& t, const std::vector<Vec2>& g, SurfaceKind kind, CrossDerivative rule) {
      return make_terrain(t, Georef{},
                          {.surface = kind, .gradients = GradientKind::given, .cross_derivative = rule, .given = g});
    };
    for (const SurfaceKind kind : {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher}) {
      const bool any = kind == SurfaceKind::clough_tocher && !m.keeps_angles;
      if (!m.keeps_angles && !any) continue;
      const CrossDerivative rule = any ? CrossDerivative::cubic : CrossDerivative::perpendicular;
      const Terrain a = surface(tin, gradients, kind, rule), b = surface(moved, carried, kind, rule);
      // Where an edge falls back to the perpendicular the surface does not carry over. The fallback is decided by
      // ratios of areas, so it is the same on both sides; those triangles are left out.
      if (any) {
        EXPECT_EQ(a.edge_fallback, b.edge_fallback);
      }
      const TerrainEvaluator ea(a), eb(b);
      for (int i = 0; i < 500; ++i) {
        const Vec2 p{0.02 + 0.96 * unit(random), 0.02 + 0.96 * unit(random)};
        if (any) {
          bool fallback = false;
          for (const std::uint32_t e : ea.edges().of_triangle[ea.locate(p)])
            fallback = fallback || a.edge_fallback[e] != 0;
          if (fallback) continue;
        }
        EXPECT_NEAR(ea.value(p), eb.value(move(p)), 1e-9) << any;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 2100);
}

// Van Kaick et al., table 1: on Crater Lake with its greedy vertices the smooth surfaces are worse than the flat one
// (RMSE x 1.31 quadratic and x 1.49 cubic, largest error x 2.5 and x 3.3).
TEST(Finding, OnCraterWithAThousandVerticesSmoothIsWorseThanFlat) {
  RETALHO_DATA_FILE(file, "dem/crater.pgm");
  const Raster r = read_raster(file);
  const Tin tin = refine_tin(r, {.vertices = 1000});
  ASSERT_EQ(tin.vertex_count(), 1000U);
  ErrorReport flat;
  for (const SurfaceKind kind : kKinds) {
    const ErrorReport report = assess(make_terrain(tin, r, {.surface = kind, .gradients = GradientKind::normals}), r);
    if (kind == SurfaceKind::linear) {
      flat = report;
      continue;
    }
    EXPECT_GT(report.rmse, 1.15 * flat.rmse);
    EXPECT_LT(report.rmse, 1.5 * flat.rmse);
    EXPECT_GT(report.max_error, 1.5 * flat.max_error);
    EXPECT_LT(report.max_error, 3.5 * flat.max_error);
  }
}

}  // namespace
}  // namespace retalho
