// Compiled with AVX2 where the compiler has it (src/CMakeLists.txt); called only on machines that have it.
#include "retalho/visibility/ray_kernel.h"

namespace retalho::visibility_detail {
static constexpr int kLanes = 8;
#include "retalho/visibility/ray_kernel.inc"

void add_rays_avx2(const RayGrid& grid, const RaySlope& slope, int first, int last, float eye, float target,
                   float* seen) {
  add_rays(grid, slope, first, last, eye, target, seen);
}

}  // namespace retalho::visibility_detail
