// The tiled refinement's own promises: the same bytes from any number of threads, a count near the plain order's, exact
// on large integers, borders that depend on themselves alone, budgets met to the vertex.
#include "retalho/tin/greedy_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "retalho/raster/io.h"
#include "retalho/tin/greedy_heap.h"
#include "retalho/tin/greedy_scan.h"
#include "support/grids.h"
#include "support/support.h"

namespace retalho {
namespace {

constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();

/// Hills over a range of scales, with noise: integers.
double hills(int x, int y) {
  const auto hash = static_cast<std::uint32_t>(x) * 2654435761U ^ static_cast<std::uint32_t>(y) * 2246822519U;
  return std::floor(300 * std::sin(x * 0.011) * std::cos(y * 0.013) + 60 * std::sin(x * 0.07 + y * 0.05) +
                    9 * std::cos(y * 0.31) * std::sin(x * 0.27) + static_cast<double>(hash >> 24) / 64);
}

/// The largest error over all valid cells, by barycentric coordinates in exact integers and long doubles: no part of
/// the refinement's scan is used. Counts valid cells that no triangle covers.
struct Checked {
  long double worst = 0;
  std::size_t uncovered = 0;
};
Checked check(const Raster& r, const GridTin& tin) {
  Checked result;
  std::vector<char> covered(r.cells(), 0);
  for (const auto& t : tin.triangles) {
    std::int64_t x[3], y[3];
    long double z[3];
    for (std::size_t k = 0; k < 3; ++k) {
      x[k] = tin.cells[t[k]] & 0xffffU;
      y[k] = tin.cells[t[k]] >> 16;
      z[k] = r.at(static_cast<int>(x[k]), static_cast<int>(y[k]));
    }
    const std::int64_t area = (x[2] - x[0]) * (y[1] - y[0]) - (x[1] - x[0]) * (y[2] - y[0]);
    EXPECT_GT(area, 0);
    for (std::int64_t row = std::min({y[0], y[1], y[2]}); row <= std::max({y[0], y[1], y[2]}); ++row)
      for (std::int64_t column = std::min({x[0], x[1], x[2]}); column <= std::max({x[0], x[1], x[2]}); ++column) {
        std::int64_t w[3];
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
          w[k] = (x[b] - column) * (y[a] - row) - (x[a] - column) * (y[b] - row);
        }
        if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
        const std::size_t cell = r.index(static_cast<int>(column), static_cast<int>(row));
        covered[cell] = 1;
        if (std::isnan(r.at(cell))) continue;
        const long double plane = static_cast<long double>(w[0]) * z[0] + static_cast<long double>(w[1]) * z[1] +
                                  static_cast<long double>(w[2]) * z[2];
        result.worst = std::max(
            result.worst, std::abs(plane / static_cast<long double>(area) - static_cast<long double>(r.at(cell))));
      }
  }
  for (std::size_t i = 0; i < r.cells(); ++i) result.uncovered += covered[i] == 0 && !std::isnan(r.at(i)) ? 1U : 0U;
  for (const std::uint32_t c : tin.cells)
    EXPECT_TRUE(r.valid(static_cast<int>(c & 0xffffU), static_cast<int>(c >> 16))) << "a void vertex";
  return result;
}

TEST(GreedyTiles, SameBytesFromAnyNumberOfThreads) {
  const Raster r =
      test::make_grid<float>(1300, 900, hills);  // over the size of the exact start: rounds, tiles and the rest
  Context one;
  one.threads = 1;
  for (const RefineOptions& options : {RefineOptions{.max_error = 12}, RefineOptions{.vertices = 9000}}) {
    const GridTin first = refine_grid_in_tiles(r, options, one);
    EXPECT_GT(first.cells.size(), 2000U);
    for (const int threads : {2, 3, 7}) {
      Context many;
      many.threads = threads;
      const GridTin again = refine_grid_in_tiles(r, options, many);
      EXPECT_EQ(first.cells, again.cells) << threads;
      EXPECT_EQ(first.triangles, again.triangles) << threads;
      EXPECT_EQ(first.neighbors, again.neighbors) << threads;
    }
  }
}

TEST(GreedyTiles, LanesAndScalarsFindTheSameCell) {
  if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this machine has no AVX2";
  std::mt19937 rng(3);
  const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(rng); };
  std::vector<double> reciprocals(401, 0);
  for (std::size_t i = 1; i < reciprocals.size(); ++i) reciprocals[i] = 1 / static_cast<double>(i);
  std::size_t found = 0;
  for (int round = 0; round < 3000; ++round) {
    // Few different heights: ties everywhere.
    const Raster r = test::make_grid<float>(60, 50, [&](int, int) { return pick(0, 19) == 0 ? kVoid : pick(0, 3); });
    const auto& z = std::get<std::vector<float>>(r.heights);
    greedy::Record a{};
    for (auto& c : a.corner) c = greedy::cell_at(pick(0, 59), pick(0, 49));
    for (auto& link : a.link) link = pick(0, 1) == 0 ? kNone : 4;
    if (greedy::area2(a.corner[0], a.corner[1], a.corner[2]) < 0) std::swap(a.corner[1], a.corner[2]);
    if (greedy::area2(a.corner[0], a.corner[1], a.corner[2]) == 0) continue;
    bool valid = true;
    for (const auto c : a.corner) valid = valid && r.valid(greedy::column_of(c), greedy::row_of(c));
    if (!valid) continue;
    greedy::Record b = a;
    const greedy::ScanField<float> field{z.data(),          60, 50, 0, 59, 0, 49, 0.5, 0.5, round % 2 == 0 ? 0 : 6,
                                         reciprocals.data()};
    greedy::scan_generic(field, a);
    greedy::scan_avx2(field, b);
    ASSERT_EQ(a.error, b.error);
    ASSERT_EQ(a.candidate, b.candidate);
    found += a.error > 0 ? 1U : 0U;
  }
  EXPECT_GT(found, 1000U);
}

TEST(GreedyTiles, HonoursTheToleranceOnEveryCellTiesIncluded) {
  for (const double tolerance : {40.0, 7.0, 2.0}) {
    const Raster r = test::make_grid<float>(1300, 900, hills);
    const GridTin tin = refine_grid_in_tiles(r, {.max_error = tolerance});
    const Checked c = check(r, tin);
    EXPECT_EQ(c.uncovered, 0U);
    EXPECT_LE(c.worst, tolerance * (1 + 1e-18L));  // integers: exact, an error of exactly the tolerance is accepted
    EXPECT_GT(c.worst, tolerance * 0.9L);
    EXPECT_LE(tin.max_error, tolerance * (1 + 1e-6));
  }
}

TEST(GreedyTiles, TakesAboutAsManyVerticesAsThePlainOrder) {
  const Raster r = test::make_grid<float>(1300, 900, hills);
  for (const double tolerance : {40.0, 7.0}) {
    const double tiles = static_cast<double>(refine_grid_in_tiles(r, {.max_error = tolerance}).cells.size());
    const double plain = static_cast<double>(refine_grid_by_heap(r, {.max_error = tolerance}).cells.size());
    EXPECT_LE(tiles, 1.03 * plain) << tolerance;
  }
}

TEST(GreedyTiles, HoldsInDoubleWhereFloatWouldRound) {
  // Heights over 2^24 with steps of one, and fractions of a millimetre at 8,000 m.
  const Raster large = test::make_grid<double>(300, 200, [](int x, int y) { return 16777216.0 * 4 + hills(x, y); });
  EXPECT_LE(check(large, refine_grid_in_tiles(large, {.max_error = 1})).worst, 1.0L);
  const Raster fine = test::make_grid<double>(200, 150, [](int x, int y) { return 8000 + 1e-4 * hills(x, y); });
  EXPECT_LE(check(fine, refine_grid_in_tiles(fine, {.max_error = 1e-4})).worst, 1e-4L);
  const Raster single = test::make_grid<float>(
      400, 300, [](int x, int y) { return 1234.567F + 0.013F * static_cast<float>(hills(x, y)); });
  EXPECT_LE(check(single, refine_grid_in_tiles(single, {.max_error = 0.05})).worst, 0.05L);
}

TEST(GreedyTiles, VoidsNeverEndTheRefinement) {
  std::mt19937 rng(5);
  std::size_t degenerate = 0;
  for (int round = 0; round < 30; ++round) {
    const int kind = round % 6;
    const Raster r = test::make_grid<float>(220, 170, [&](int x, int y) -> double {
      const bool corner = (x == 0 || x == 219) && (y == 0 || y == 169);
      const bool border = x == 0 || x == 219 || y == 0 || y == 169;
      const bool gone = kind == 0   ? corner
                        : kind == 1 ? border
                        : kind == 2 ? rng() % 10 < 7
                        : kind == 3 ? x + y < 150
                        : kind == 4 ? x == 0 && y == 0
                                    : (x - 110) * (x - 110) + (y - 85) * (y - 85) > 80 * 80;
      return gone ? kVoid : hills(3 * x, 3 * y);
    });
    const Checked c = check(r, refine_grid_in_tiles(r, {.max_error = 5}));
    EXPECT_LE(c.worst, 5.0L) << kind;
    EXPECT_EQ(c.uncovered, 0U) << kind;
    degenerate += c.worst == 0 ? 1U : 0U;
  }
  EXPECT_EQ(degenerate, 0U);
}

TEST(GreedyTiles, MeetsABudgetToTheVertex) {
  const Raster r = test::make_grid<float>(1300, 900, hills);
  for (const std::size_t budget : {4U, 50U, 1000U, 20000U}) {
    const GridTin tin = refine_grid_in_tiles(r, {.vertices = budget});
    EXPECT_EQ(tin.cells.size(), budget);
    if (budget == 1000) {  // the error that is left is near the plain order's
      const double plain = static_cast<double>(check(r, refine_grid_by_heap(r, {.vertices = budget})).worst);
      EXPECT_LE(static_cast<double>(check(r, tin).worst), 1.1 * plain);
    }
  }
}

/// Vertices along one side: the row's columns or the column's rows.
std::vector<int> side(const GridTin& tin, bool row, int at) {
  std::vector<int> places;
  for (const std::uint32_t c : tin.cells) {
    const int x = static_cast<int>(c & 0xffffU), y = static_cast<int>(c >> 16);
    if ((row ? y : x) == at) places.push_back(row ? x : y);
  }
  std::sort(places.begin(), places.end());
  return places;
}

TEST(GreedyTiles, GridsThatShareABorderAgreeAlongIt) {
  const Raster west = test::make_grid<float>(301, 240, hills),
               east = test::make_grid<float>(257, 240, [](int x, int y) { return hills(x + 300, y); });
  const Raster south = test::make_grid<float>(
      301, 200, [](int x, int y) { return hills(x, y + 239) + (y == 0 ? 0 : 40 * std::sin(x * 0.3)); });
  for (const double tolerance : {30.0, 6.0, 1.0}) {
    const GridTin a = refine_grid_in_tiles(west, {.max_error = tolerance});
    EXPECT_EQ(side(a, false, 300), side(refine_grid_in_tiles(east, {.max_error = tolerance}), false, 0)) << tolerance;
    EXPECT_EQ(side(a, true, 239), side(refine_grid_in_tiles(south, {.max_error = tolerance}), true, 0)) << tolerance;
    EXPECT_GT(side(a, true, 239).size(), 4U);
  }
}

TEST(GreedyTiles, RealNeighboursAgreeAlongTheirBorder) {
  RETALHO_DATA_FILE(n, "dem/N42E001.hgt.zip");
  RETALHO_DATA_FILE(s, "dem/N41E001.hgt.zip");
  RETALHO_DATA_FILE(w, "dem/N53E027.hgt.zip");
  RETALHO_DATA_FILE(e, "dem/N53E028.hgt.zip");
  for (const double tolerance : {20.0, 4.0}) {
    const GridTin north = refine_grid(read_raster(n), {.max_error = tolerance}),
                  south = refine_grid(read_raster(s), {.max_error = tolerance});
    EXPECT_EQ(side(north, true, 1200), side(south, true, 0)) << tolerance;
    const GridTin west = refine_grid(read_raster(w), {.max_error = tolerance}),
                  east = refine_grid(read_raster(e), {.max_error = tolerance});
    EXPECT_EQ(side(west, false, 1200), side(east, false, 0)) << tolerance;
  }
}

TEST(GreedyTiles, RealGridsKeepTheToleranceInEveryCell) {
  for (const char* name :
       {"dem/crater.pgm", "dem/exploradores_aster.tif", "dem/SainteHelens.dem", "dem/dom1_32_356_5699_1_nw_2020.tif"}) {
    RETALHO_DATA_FILE(file, name);
    const Raster r = read_raster(file);
    const RasterSummary summary = summarize(r);
    const double tolerance = name == std::string("dem/crater.pgm") ? 5 : (summary.maximum - summary.minimum) / 200;
    const Checked c = check(r, refine_grid(r, {.max_error = tolerance}));
    EXPECT_LE(c.worst, static_cast<long double>(tolerance)) << name;
    EXPECT_EQ(c.uncovered, 0U) << name;
  }
}

}  // namespace
}  // namespace retalho
