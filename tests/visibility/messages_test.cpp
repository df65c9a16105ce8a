// What the room's calls refuse, in its own words: those that no command line can ask for.
#include <gtest/gtest.h>

#include "retalho/core/error.h"
#include "retalho/visibility/intervisibility.h"
#include "support/errors.h"
#include "support/grids.h"

namespace retalho::test {
namespace {

TEST(VisibilityMessages, AreThese) {
  const Raster grid = make_grid(4, 3, [](int x, int y) { return x + y; });
  const std::vector<float> map(12), other(11);
  expect_refused<UsageError>({
      {"3 directions are too few: give at least 4 (180 is usual)",
       [&] { intervisibility_map(grid, {.directions = 3}); }},
      {"a stride of 0 cells: give 1 or more", [&] { exact_intervisibility(grid, 0); }},
      {"maps of 12 and 11 cells: they must be of one grid", [&] { compare_maps(map, other); }},
  });
}

}  // namespace
}  // namespace retalho::test
