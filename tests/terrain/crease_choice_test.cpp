// Creases chosen by the refinement, and along given lines.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"
#include "retalho/model/model.h"
#include "retalho/terrain/crease_lines.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/report.h"
#include "retalho/terrain/surface_refine.h"
#include "support/errors.h"
#include "support/grids.h"
#include "support/support.h"

namespace retalho {
namespace {

constexpr SurfaceKind kSmooth[] = {SurfaceKind::powell_sabin, SurfaceKind::clough_tocher};

/// Houses with flat and with pitched roofs on gentle ground.
Raster town(int columns, int rows) {
  return test::make_grid<double>(columns, rows, [](int x, int y) {
    const double ground = 100 + 2 * std::sin(x / 17.0) + 0.05 * y;
    const int i = x % 24, j = y % 20, house = (x / 24) * 7 + (y / 20) * 3;
    if (i < 5 || i > 18 || j < 4 || j > 15) return ground;
    return 108.0 + house % 5 + (house % 2 == 0 ? 0.0 : 4 - 0.6 * std::abs(i - 11.5));
  });
}

/// Hipped roofs in rows, askew to the grid.
Raster roofs() {
  const auto from_middle = [](double along) { return std::abs(along - 40 * std::floor(along / 40) - 20); };
  return test::make_grid<double>(96, 80, [&](int x, int y) {
    return 100 + std::max(0.0, 12 - 0.8 * std::max(from_middle(x + 0.2 * y), from_middle(y - 0.2 * x)));
  });
}

TEST(CreaseChoice, TradesVerticesForCreasesWhereThatIsNearer) {
  const Raster raster = roofs();
  SurfaceRefineOptions options{.vertices = 200};
  const Terrain without = refine_surface(raster, options);
  options.creases = true;
  const Terrain with = refine_surface(raster, options);
  EXPECT_TRUE(without.creases.empty());
  EXPECT_FALSE(with.creases.empty());
  EXPECT_LT(with.tin.vertex_count(), without.tin.vertex_count());
  EXPECT_LE(number_count(with), number_count(without));
  EXPECT_EQ(number_count(with), 3 * with.tin.vertex_count() + 2 * with.gradients.size() + with.creases.size());
  EXPECT_LT(assess(with, raster).rmse, assess(without, raster).rmse);
  EXPECT_EQ(assess(with, raster).uncovered, 0U);
  const Terrain back = std::get<Terrain>(decode_model(encode_model(with)));
  EXPECT_EQ(back.creases, with.creases);
  EXPECT_EQ(back.gradients, with.gradients);
}

TEST(CreaseChoice, NeverMoreNumbersNorFartherOff) {
  const Raster houses = town(96, 80), hill = test::make_grid<double>(60, 60, [](int x, int y) {
                                        return 20 * std::sin(x / 9.0) * std::cos(y / 8.0) + 5 * std::sin((x + y) / 4.0);
                                      });
  for (const SurfaceKind kind : kSmooth)
    for (const Raster* raster : {&houses, &hill}) {
      SurfaceRefineOptions options{.surface = kind, .vertices = 80};
      const Terrain without = refine_surface(*raster, options);
      options.creases = true;
      const Terrain with = refine_surface(*raster, options);
      EXPECT_LE(number_count(with), number_count(without)) << surface_name(kind);
      EXPECT_LE(assess(with, *raster).rmse, assess(without, *raster).rmse) << surface_name(kind);
    }
}

TEST(CreaseChoice, TheSameFromAnyNumberOfThreads) {
  const Raster raster = town(72, 60);
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  const SurfaceRefineOptions options{.vertices = 200, .creases = true};
  const Terrain a = refine_surface(raster, options, one), b = refine_surface(raster, options, four);
  EXPECT_EQ(encode_model(a), encode_model(b));
}

TEST(CreaseChoice, RefusesATolerance) {
  const Raster raster = town(40, 40);
  EXPECT_TRUE(
      test::holds(test::words_of<UsageError>([&] { refine_surface(raster, {.max_error = 1, .creases = true}); }),
                  "chosen for smooth surfaces and a budget"));
}

/// Two planes that meet along a line across the grid.
Raster valley() {
  return test::make_grid<double>(60, 50,
                                 [](int x, int y) { return std::abs(1.5 * (x - 30) - 0.7 * (y - 20)) + 0.1 * x; });
}
std::vector<std::vector<Vec2>> valley_line() {  // from outside to outside
  return {{{30 + 0.7 * (-40 - 20) / 1.5, 40}, {30 + 0.7 * (90 - 20) / 1.5, -90}}};
}

TEST(CreaseLines, ASurfaceFoldsAlongThem) {
  const Raster raster = valley();
  for (const SurfaceKind kind : kSmooth) {
    const SurfaceRefineOptions options{.surface = kind, .vertices = 60};
    CreaseLineNotes notes;
    const Terrain terrain = refine_along_lines(raster, valley_line(), options, &notes);
    EXPECT_EQ(notes.lines, 1U);
    EXPECT_GT(notes.vertices, 5U);
    EXPECT_GE(notes.edges, notes.vertices - 1);
    EXPECT_EQ(terrain.creases.size(), notes.edges);
    EXPECT_LE(terrain.tin.vertex_count(), 60U);
    EXPECT_LT(assess(terrain, raster).max_error, 1e-4) << surface_name(kind);
    EXPECT_GT(assess(refine_surface(raster, options), raster).max_error, 0.05) << surface_name(kind);
  }
}

// Two houses share a wall: a line and the same line backwards are one, not two with needles between them.
TEST(CreaseLines, ALineGivenTwiceIsOne) {
  const Raster raster = valley();
  std::vector<std::vector<Vec2>> lines = valley_line();
  const Terrain once = refine_along_lines(raster, lines, {.vertices = 60});
  lines.emplace_back(lines[0].rbegin(), lines[0].rend());
  const Terrain twice = refine_along_lines(raster, lines, {.vertices = 60});
  EXPECT_EQ(once.creases.size(), twice.creases.size());
  EXPECT_LT(assess(twice, raster).max_error, 1e-4);
  for (const auto& t : twice.tin.triangles) {
    const Vec2 a = twice.tin.points[t[0]], b = twice.tin.points[t[1]], c = twice.tin.points[t[2]];
    EXPECT_GT(cross(b - a, c - a), 1e-6);
  }
}

// Two surveys of one ridge: a part of it again, with vertices of its own that lie beside it by a rounding or by less
// than a thousandth of a cell. The same fold, and no needles.
TEST(CreaseLines, LinesThatRunOverEachOtherAreOne) {
  const Raster raster = valley();
  const Vec2 from = valley_line()[0][0], along = valley_line()[0][1] - from, side{along.y, -along.x};
  test::Random random;
  for (const double beside : {0.0, 1e-9, 3e-4 / norm(side)}) {
    std::vector<std::vector<Vec2>> lines = valley_line();
    std::vector<Vec2> again;
    for (const double t : {0.4, 0.43711, 0.5012, 0.53, 0.6017, 0.7})
      again.push_back(from + t * along + random.uniform(-beside, beside) * side);
    lines.push_back(again);
    std::reverse(again.begin(), again.end());
    again.erase(again.begin() + 2);
    lines.push_back(again);
    CreaseLineNotes notes;
    const Terrain terrain = refine_along_lines(raster, lines, {.vertices = 80}, &notes);
    EXPECT_EQ(notes.lines, 3U);
    EXPECT_EQ(notes.edges, notes.vertices - 1) << "one line from end to end";
    EXPECT_LE(terrain.tin.vertex_count(), 80U);
    EXPECT_LT(assess(terrain, raster).max_error, 1e-3) << beside;
    for (const auto& t : terrain.tin.triangles) {
      const Vec2 a = terrain.tin.points[t[0]], b = terrain.tin.points[t[1]], c = terrain.tin.points[t[2]];
      EXPECT_GT(cross(b - a, c - a), 1e-2) << beside;
    }
  }
}

// Vertices near the lines give way to them; what they leave of the budget goes elsewhere, and crossings count.
TEST(CreaseLines, TheBudgetIsSpentAndKept) {
  const Raster raster = valley();
  std::vector<std::vector<Vec2>> lines = valley_line();
  const double right = raster.columns - 1.0, low = 1.0 - raster.rows;
  lines.push_back({{0, low / 3}, {right, low / 2}});
  lines.push_back({{0, low / 2}, {right, low / 3}});
  const Terrain terrain = refine_along_lines(raster, lines, {.vertices = 150});
  EXPECT_LE(terrain.tin.vertex_count(), 150U);
  EXPECT_GE(terrain.tin.vertex_count(), 140U);
}

TEST(CreaseLines, RefusesWhatItCannotFollow) {
  const Raster raster = valley();
  const auto words = [&](const SurfaceRefineOptions& options, std::vector<std::vector<Vec2>> lines) {
    try {
      refine_along_lines(raster, lines, options);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_TRUE(test::holds(words({.max_error = 1}, valley_line()), "takes a budget"));
  EXPECT_TRUE(test::holds(words({.surface = SurfaceKind::linear, .vertices = 60}, valley_line()), "flat one folds"));
  EXPECT_TRUE(test::holds(words({.vertices = 60}, {{{-10, 5}, {80, 9}}}), "none of the lines"));
  EXPECT_TRUE(test::holds(words({.vertices = 5}, valley_line()), "of a budget of 5"));
}

}  // namespace
}  // namespace retalho
