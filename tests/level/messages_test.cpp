// What the calls of the room refuse, in its own words: those that no command line can ask for.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/level/bands.h"
#include "retalho/level/contour.h"
#include "retalho/level/fixed_levels.h"
#include "retalho/level/implicit_curve.h"
#include "support/errors.h"

namespace retalho::test {
namespace {

TEST(LevelMessages, AreThese) {
  expect_refused<BadInput>({
      {"contour levels must ascend, each given once",
       [] {
         check_levels({2, 1});
       }},
      {"a contour level is not a finite number", [] { check_levels({HUGE_VAL}); }},
      {"the levels 1 and 1.001 are closer than the height quantum 0.0625: ask for a larger interval",
       [] {
         FixedLevels({1, 1.001}, 16);
       }},
      {"the contour interval must be a positive number, not 0", [] { contour_levels(0, 1, 0, 0); }},
  });
  const Expression f = Expression::parse("x*x + y*y - 1");
  expect_refused<UsageError>({
      {"the box 1, 1, 0, 0 is empty",
       [&] {
         trace_implicit(f, {1, 1, 0, 0});
       }},
      {"depth 15: 1 to 14 is possible",
       [&] {
         trace_implicit(f, {-2, -2, 2, 2}, {.depth = 15});
       }},
  });
}

/// The border of a square with roots on its sides, and two lines through it of levels 0 and 1: from 0 to 1, from 2
/// to 3.
void bands_of(const std::array<std::vector<std::uint32_t>, 4>& roots, std::size_t sides = 4, int band = 0) {
  const std::array<Vec2, 4> corners{Vec2{0, 0}, Vec2{9, 0}, Vec2{9, 9}, Vec2{0, 9}};
  std::vector<DirectedBorder> border;
  for (std::size_t k = 0; k < sides; ++k)
    border.push_back({k, (k + 1) % 4, corners[k], corners[(k + 1) % 4] - corners[k], band, roots[k]});
  ContourSet set;
  set.levels = {1, 2};
  set.points = {{0, 3}, {9, 3}, {0, 6}, {9, 6}};
  set.lines = {{0, false, 0, 2}, {1, false, 2, 4}};
  build_bands(set, {{0, 1}, {2, 3}}, border);
}

TEST(LevelMessages, LinesThatDoNotFitTheirBorderAreNamed) {
  expect_refused<Error>({
      {"bands: the border of the valid area has a gap", [] { bands_of({}, 3); }},
      {"bands: a border without lines lies outside of the area", [] { bands_of({}, 4, DirectedBorder::kUnknownBand); }},
      {"bands: a line ends inside the area", [] { bands_of({}); }},
      {"bands: a region changes its level",
       [] {
         bands_of({{{1}, {2}, {3}, {0}}});
       }},
      {"bands: a border root without a line",
       [] {
         bands_of({{{0}, {7}, {1}, {}}});
       }},
  });
}

}  // namespace
}  // namespace retalho::test
