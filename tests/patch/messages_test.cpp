// What the room's calls refuse, in its own words: those that no command line can ask for.
#include <gtest/gtest.h>

#include "retalho/core/error.h"
#include "retalho/patch/joins.h"
#include "retalho/patch/multigrid.h"
#include "retalho/patch/surface.h"
#include "support/errors.h"
#include "support/sample_patches.h"

namespace retalho::test {
namespace {

TEST(PatchMessages, AreThese) {
  const PatchSet set = sample_patches(3);
  PatchSurface surface(set.patches[0]);
  expect_refused<BadInput>({{"a side is a curve without segments", [] { SideCurve{Curve()}; }}});
  expect_refused<UsageError>({
      {"only sides that are curves can be joined", [] { join_sides(PatchSides{}); }},
      {"a patch is refined by a factor of 1 at least", [&] { refine(set.patches[0], surface, 0); }},
      {"a surface is moved with another domain or recovery than it was made with: make a new one",
       [&] { surface.move(set.patches[1]); }},
  });
}

TEST(PatchMessages, ASystemWithoutASolutionIsNamed) {
  ConvexSystem circle;  // each unknown is the other one: nothing says where they are
  circle.first = {0, 1, 2};
  circle.columns = {1, 0};
  circle.values = {1, 1};
  std::vector<Vec2> x(2);
  expect_refused<Error>({
      {"the system of the parameters could not be factored",
       [&] {
         solve_direct(circle, {{1, 0}, {0, 1}}, x);
       }},
  });
}

}  // namespace
}  // namespace retalho::test
