// Which side of a border a place lies on, against the signs of areas.
#include "retalho/level/tile_outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "support/support.h"

namespace retalho {
namespace {

double turn(Vec2 a, Vec2 b, Vec2 p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Within a triangle whose border runs with its area to the left, the order of its pieces mixed.
TEST(OutlineArea, HoldsWhatATriangleHoldsAlsoBesideItsTips) {
  test::Random random(31);
  int inside = 0, beside_a_tip = 0;
  for (int round = 0; round < 2000; ++round) {
    std::array<Vec2, 3> corners;
    for (Vec2& c : corners) c = {static_cast<double>(random.index(9)), static_cast<double>(random.index(9))};
    if (turn(corners[0], corners[1], corners[2]) < 0) std::swap(corners[1], corners[2]);
    if (turn(corners[0], corners[1], corners[2]) == 0) continue;
    std::vector<DirectedBorder> border(3);
    for (std::size_t k = 0; k < 3; ++k) {
      border[k].place = corners[k];
      border[k].along = corners[(k + 1) % 3] - corners[k];
    }
    std::shuffle(border.begin(), border.end(), random.engine());
    const OutlineArea area(border);
    for (int y = 0; y < 9; ++y)
      for (double x = -0.5; x < 9; ++x) {
        bool truth = true, on_line = false;
        for (std::size_t k = 0; k < 3; ++k) {
          const double side = turn(corners[k], corners[(k + 1) % 3], {x, static_cast<double>(y)});
          on_line |= side == 0;
          truth &= side > 0;
        }
        if (on_line) continue;
        EXPECT_EQ(area.holds({x, static_cast<double>(y)}), truth) << x << ", " << y << " (round " << round << ")";
        inside += truth ? 1 : 0;
        for (const Vec2& c : corners) beside_a_tip += c.y == y && c.x < x ? 1 : 0;
      }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(beside_a_tip, 1000);
}

}  // namespace
}  // namespace retalho
