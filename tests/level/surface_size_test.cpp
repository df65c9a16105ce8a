// What the samples of a grid say about the size of its surface, beside the surface itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "retalho/level/surface_size.h"
#include "retalho/terrain/bicubic.h"
#include "support/support.h"

namespace retalho {
namespace {

/// Steps of up to `step` from sample to sample, around a height that takes the largest near a power of two.
Raster rough(test::Random& random, int columns, int rows, double step, bool voids) {
  Raster r;
  r.columns = columns;
  r.rows = rows;
  std::vector<float> z(r.cells());
  const double middle = 256 - random.uniform(0, 12) * step;
  for (float& h : z) h = static_cast<float>(middle + random.uniform(-step, step) / 2);
  if (voids) z[random.index(z.size())] = std::numeric_limits<float>::quiet_NaN();
  r.heights = std::move(z);
  return r;
}

TEST(SurfaceSize, IsNeverTakenForSureWrongly) {
  test::Random random;
  int sure = 0, unsure = 0;
  for (int i = 0; i < 40; ++i) {
    const Raster raster = rough(random, 2 + static_cast<int>(random.index(80)),
                                60 + static_cast<int>(random.index(200)), random.uniform(0.5, 4), random.chance(0.2));
    const SurfaceSize size = bound_surface(raster, 16, {});
    int exponent = 0;
    std::frexp(size.least, &exponent);
    const double limit = std::ldexp(1.0, exponent);
    for (const Twist twist : {Twist::zero, Twist::adini, Twist::spline})
      for (const TangentEnds ends : {TangentEnds::not_a_knot, TangentEnds::natural}) {
        const BicubicGrid g = make_bicubic(raster, {ends, twist, false});
        double largest = 0;
        for (int row = 0; row < g.rows; ++row) {
          double most = 0;
          for (int c = 0; c < g.columns; ++c) {
            const std::size_t n = raster.index(c, row);
            most =
                std::max(most, std::abs(g.z[n]) + (std::abs(g.zu[n]) + std::abs(g.zv[n])) / 3 + std::abs(g.zuv[n]) / 9);
          }
          largest = std::max(largest, most);
          const bool known = std::none_of(size.unsure.begin(), size.unsure.end(),
                                          [&](const SizeBlock& b) { return row >= b.first && row < b.last; });
          EXPECT_TRUE(!known || most < limit) << most;
          ++(known ? sure : unsure);
        }
        EXPECT_GE(largest, size.least);
      }
  }
  EXPECT_GT(sure, 1000);  // both happen
  EXPECT_GT(unsure, 1000);
}

}  // namespace
}  // namespace retalho
