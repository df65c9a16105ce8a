// What the calls of the room refuse, in its own words: those that no command line can ask for.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>

#include "retalho/core/error.h"
#include "retalho/tin/cell_delaunay.h"
#include "retalho/tin/constraint_mesh.h"
#include "retalho/tin/refine.h"
#include "retalho/tin/scattered.h"
#include "support/errors.h"
#include "support/grids.h"

namespace retalho::test {
namespace {

using greedy::cell_at;

TEST(TinMessages, AreThese) {
  const std::vector<greedy::Cell> twice{cell_at(0, 0), cell_at(9, 0), cell_at(4, 4), cell_at(4, 4), cell_at(0, 9)};
  const std::vector<Vec3> far{{0, 0, 0}, {1e101, 0, 0}, {0, 1, 0}};
  // A length that no memory has: it is asked before the first point is read.
  const std::span<const Vec3> many(far.data(), std::size_t{1} << 31);
  Tin square;
  square.points = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  square.heights = {0, 0, 0, 0};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  build_neighbors(square);
  expect_refused<BadInput>({
      {"the grid holds infinite heights; a void is NaN",
       [] { refine_grid(make_grid(4, 4, [](int x, int) { return x == 2 ? HUGE_VAL : 0; })); }},
      {"no area: the grid holds no valid cell", [] { refine_grid(make_grid(4, 4, [](int, int) { return NAN; })); }},
      {"two vertices lie in one cell", [&] { triangulate_cells(twice); }},
      {"2147483648 points: at most 2147483646 can be triangulated", [&] { triangulate_points(many); }},
      {"point 1 has the coordinates (1e+101, 0, 0): leave out what is not a place", [&] { triangulate_points(far); }},
      {"two breaklines cross near 1, 1: their crossing has no vertex",
       [&] {
         ConstraintMesh mesh(square);
         mesh.insert(0, 2);
         mesh.insert(1, 3);
       }},
  });
}

}  // namespace
}  // namespace retalho::test
