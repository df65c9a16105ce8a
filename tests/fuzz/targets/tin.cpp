// Small grids of any heights, void, huge or equal: the triangulation holds its tolerance at every cell that has one.
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "retalho/tin/refine.h"
#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  if (size < 4) return 0;
  Raster raster;
  raster.columns = 1 + data[0] % 24;
  raster.rows = 1 + data[1] % 24;
  const int kind = data[2] % 4;
  const double tolerance = data[3] % 8 == 0 ? 0 : std::ldexp(1.0, data[3] % 64 - 16);
  std::vector<float> heights(raster.cells());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const std::uint8_t byte = size > 4 ? data[4 + i % (size - 4)] : 0;
    heights[i] = kind == 0   ? static_cast<float>(byte)
                 : kind == 1 ? std::ldexp(static_cast<float>(byte % 16) - 8, byte / 2 - 64)
                 : kind == 2 ? (byte % 3 == 0 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(byte % 5))
                             : static_cast<float>(i % 7) * static_cast<float>(byte % 2) * 1e30F;
  }
  raster.heights = std::move(heights);
  return fuzz::refuse_or([&] {
    const Tin tin = refine_tin(raster, {.max_error = tolerance});
    for (const auto& triangle : tin.triangles) {
      for (const std::uint32_t v : triangle) fuzz::require(v < tin.points.size(), "a corner that is not there");
      const Vec2 a = tin.points[triangle[0]], b = tin.points[triangle[1]], c = tin.points[triangle[2]];
      fuzz::require(cross(b - a, c - a) > 0, "a triangle that is turned or flat");
    }
    for (const double h : tin.heights) fuzz::require(std::isfinite(h), "a vertex without height");
  });
}
