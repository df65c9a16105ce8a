// Level lines of a tiled model, traced tile by tile: those of the joined model, to the bit.
#include "retalho/level/tile_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <tuple>
#include <utility>
#include <vector>

#include "level/contour_support.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/model/model.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/tiles/make.h"
#include "retalho/tiles/source.h"
#include "support/support.h"
#include "tiles/made.h"

namespace retalho {
namespace {

using test::MadeTiles;
using Case = test::TileCase;

/// Level, closed, points; a closed line from its smallest point on.
using Line = std::tuple<int, bool, std::vector<std::pair<double, double>>>;

void collect(const ContourSet& set, std::vector<Line>& all) {
  for (const ContourLine& line : set.lines) {
    std::vector<std::pair<double, double>> points;
    for (std::size_t i = line.begin; i < line.end; ++i) points.emplace_back(set.points[i].x, set.points[i].y);
    if (line.closed) std::rotate(points.begin(), std::min_element(points.begin(), points.end()), points.end());
    all.emplace_back(line.level, line.closed, std::move(points));
  }
}

std::vector<Line> sorted_lines(const ContourSet& set) {
  std::vector<Line> all;
  collect(set, all);
  std::sort(all.begin(), all.end());
  return all;
}

const std::vector<double> kLevels{-100, -77.5, -40, -12, 0, 3, 40, 66, 90, 300};

class TileLines : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Kinds, TileLines,
    ::testing::Values(Case{false, SurfaceKind::linear, false}, Case{true, SurfaceKind::linear, false},
                      Case{false, SurfaceKind::clough_tocher, false}, Case{true, SurfaceKind::clough_tocher, false},
                      Case{false, SurfaceKind::powell_sabin, false}, Case{true, SurfaceKind::powell_sabin, false},
                      Case{true, SurfaceKind::clough_tocher, true}, Case{true, SurfaceKind::powell_sabin, true}));

TEST_P(TileLines, AreThoseOfTheJoinedModelToTheBit) {
  const auto [voids, surface, fitted] = GetParam();
  const MadeTiles made(voids, surface, 1.5, fitted);
  make_tiles(made.plan, made.tiles, 2, false);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const ContourOptions options{.tolerance = 0.3, .simplify = false};
  const ContourSet expected = trace_contours(whole, kLevels, options);
  const TileSource tiles = tile_source(made.tiles);
  const SurfaceRange range = measure_range(tiles);
  ASSERT_TRUE(range.data);
  const auto [low, high] = std::minmax_element(whole.tin.heights.begin(), whole.tin.heights.end());
  EXPECT_EQ(range.low, *low);
  EXPECT_EQ(range.high, *high);
  std::vector<Line> got;
  const ContourSet set =
      stream_contours(tiles, range, kLevels, options, [&](const ContourSet& part) { collect(part, got); });
  EXPECT_EQ(set.height_quantum, expected.height_quantum);
  EXPECT_EQ(set.singular.size(), expected.singular.size());
  EXPECT_TRUE(set.lines.empty());
  std::sort(got.begin(), got.end());
  const std::vector<Line> want = sorted_lines(expected);
  EXPECT_GT(want.size(), 40U);
  ASSERT_EQ(got.size(), want.size());
  std::size_t closed = 0;
  for (std::size_t l = 0; l < want.size(); ++l) {
    ASSERT_TRUE(got[l] == want[l]) << "line " << l << " of level " << std::get<0>(want[l]);
    closed += std::get<1>(want[l]) ? 1 : 0;
  }
  EXPECT_GT(closed, 5U);
}

/// Band, then the rings from their smallest points on, the outer one first.
using Region = std::pair<int, std::vector<std::vector<std::pair<double, double>>>>;

std::vector<Region> sorted_regions(const BandSet& bands) {
  const auto ring = [](const BandRing& r) {
    std::vector<std::pair<double, double>> points;
    for (const Vec2 p : r.points) points.emplace_back(p.x, p.y);
    std::rotate(points.begin(), std::min_element(points.begin(), points.end()), points.end());
    return points;
  };
  std::vector<Region> regions;
  for (const BandPolygon& polygon : bands.polygons) {
    Region region{polygon.band, {}};
    for (const BandRing& hole : polygon.holes) region.second.push_back(ring(hole));
    std::sort(region.second.begin(), region.second.end());
    region.second.insert(region.second.begin(), ring(polygon.outer));
    regions.push_back(std::move(region));
  }
  std::sort(regions.begin(), regions.end());
  return regions;
}

TEST_P(TileLines, BandsAreThoseOfTheJoinedModelToTheBit) {
  const auto [voids, surface, fitted] = GetParam();
  const MadeTiles made(voids, surface, 1.5, fitted);
  make_tiles(made.plan, made.tiles, 2, false);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const ContourOptions options{.tolerance = 0.3, .simplify = false};
  ContourExtras wanted, got;
  wanted.want_bands = got.want_bands = true;
  const ContourSet expected = trace_contours(whole, kLevels, options, {}, &wanted);
  const TileSource tiles = tile_source(made.tiles);
  const SurfaceRange range = measure_range(tiles);
  const ContourSet lines = trace_contours(tiles, range, kLevels, options, {}, &got);
  EXPECT_TRUE(sorted_lines(lines) == sorted_lines(expected));
  const std::vector<Region> want = sorted_regions(wanted.bands), have = sorted_regions(got.bands);
  EXPECT_EQ(got.bands.levels, kLevels);
  EXPECT_GT(want.size(), 40U);
  ASSERT_EQ(have.size(), want.size());
  for (std::size_t k = 0; k < want.size(); ++k)
    ASSERT_TRUE(have[k] == want[k]) << "region " << k << " of band " << want[k].first;
  // Thinned, they still cover the valid area once.
  const auto area = [](const BandSet& bands) {
    double sum = 0;
    const auto doubled = [](const BandRing& r) {
      double a = 0;
      for (std::size_t i = 0; i < r.points.size(); ++i) a += cross(r.points[i], r.points[(i + 1) % r.points.size()]);
      return a;
    };
    for (const BandPolygon& polygon : bands.polygons) {
      sum += doubled(polygon.outer);
      for (const BandRing& hole : polygon.holes) sum += doubled(hole);
    }
    return sum / 2;
  };
  for (const int threads : {1, 2, 7}) {
    ContourExtras thinned;
    thinned.want_bands = true;
    trace_contours(tile_source(made.tiles, threads == 2 ? 1 : TileReader::kBound), range, kLevels, {.tolerance = 1},
                   {.threads = threads}, &thinned);
    EXPECT_NEAR(area(thinned.bands), area(wanted.bands), 1e-9 * area(wanted.bands));
    if (threads == 1)
      got = std::move(thinned);
    else
      EXPECT_TRUE(sorted_regions(thinned.bands) == sorted_regions(got.bands));
  }
}

TEST_P(TileLines, AreThinnedWithinTheToleranceAndDoNotCross) {
  const auto [voids, surface, fitted] = GetParam();
  const MadeTiles made(voids, surface, 1.5, fitted);
  make_tiles(made.plan, made.tiles, 2, false);
  const auto whole = std::get<Terrain>(load_model(made.tiles));
  const TileSource tiles = tile_source(made.tiles);
  const SurfaceRange range = measure_range(tiles);
  ContourSet all;
  all.levels = kLevels;
  const double tolerance = 1;
  stream_contours(tiles, range, kLevels, {.tolerance = tolerance}, [&](const ContourSet& part) {
    EXPECT_EQ(part.levels, kLevels);
    EXPECT_EQ(part.tolerance, tolerance);
    for (ContourLine line : part.lines) {
      const auto begin = part.points.begin() + static_cast<std::ptrdiff_t>(line.begin);
      const std::size_t n = line.end - line.begin;
      line.begin = all.points.size();
      all.points.insert(all.points.end(), begin, begin + static_cast<std::ptrdiff_t>(n));
      line.end = all.points.size();
      all.lines.push_back(line);
    }
  });
  const ContourSet joined = trace_contours(whole, kLevels, {.tolerance = tolerance});
  const ContourSet raw = trace_contours(whole, kLevels, {.tolerance = tolerance / 5, .simplify = false});
  ASSERT_EQ(all.lines.size(), joined.lines.size());
  EXPECT_LT(all.points.size(), raw.points.size() * 2 / 3) << "thinned";
  EXPECT_LT(all.points.size(), joined.points.size() * 3) << "two or three more at each seam, every 40 cells";
  EXPECT_EQ(test::count_meetings(all, 20), 0U);
}

/// Everything that leaves, in its order.
std::vector<Line> stream(const std::string& folder, int threads, std::size_t bound) {
  const TileSource tiles = tile_source(folder, bound);
  std::vector<Line> lines;
  const Context context{.threads = threads};
  stream_contours(
      tiles, measure_range(tiles, context), kLevels, {.tolerance = 0.5},
      [&](const ContourSet& part) { collect(part, lines); }, context);
  return lines;
}

TEST(TileLines, AreTheSameInTheSameOrderFromAnyNumberOfThreadsAndAnyBound) {
  const MadeTiles made(true);
  make_tiles(made.plan, made.tiles, 2, false);
  const std::vector<Line> one = stream(made.tiles, 1, TileReader::kBound);
  for (const int threads : {1, 2, 7})
    for (const std::size_t bound : {std::size_t{1}, TileReader::kBound})
      EXPECT_TRUE(stream(made.tiles, threads, bound) == one) << threads << " threads, " << bound << " bytes";
}

TEST(TileLines, HoldNoMoreTilesThanTheBoundAllows) {
  const MadeTiles made(false);
  make_tiles(made.plan, made.tiles, 2, false);
  for (const auto& [bound, most] : {std::pair{std::size_t{1}, 1}, {TileReader::kBound, 7}}) {
    TileSource tiles = tile_source(made.tiles, bound);
    EXPECT_EQ(tiles.at_once == 1, most == 1);
    std::atomic<int> reads = 0;
    const auto load = tiles.load;
    tiles.load = [&](int row, int column) {
      ++reads;
      return load(row, column);
    };
    const Context context{.threads = 7};
    const SurfaceRange range = measure_range(tiles, context);
    EXPECT_EQ(reads, 12) << "each tile once";
    stream_contours(
        tiles, range, kLevels, {.tolerance = 0.5}, [](const ContourSet&) {}, context);
    EXPECT_EQ(reads, 24);
  }
}

TEST(TileLines, WhatIsRefused) {
  const MadeTiles made(false);
  make_tiles(made.plan, made.tiles, 2, false);
  const TileSource tiles = tile_source(made.tiles);
  const SurfaceRange range = measure_range(tiles);
  const auto nothing = [](const ContourSet&) {};
  EXPECT_THROW(stream_contours(tiles, range, {0}, {.tolerance = 0}, nothing), BadInput);
  EXPECT_THROW(stream_contours(tiles, range, {2, 1}, {.tolerance = 1}, nothing), BadInput);
  EXPECT_THROW(tile_source(made.folder.path().string()), CannotRead);
}

}  // namespace
}  // namespace retalho
