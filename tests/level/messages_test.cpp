// What the calls of the room refuse, in its own words: those that no command line can ask for.
#include <gtest/gtest.h>

#include "retalho/core/error.h"
#include "retalho/level/contour.h"
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

}  // namespace
}  // namespace retalho::test
