#include "retalho/visibility/ray_kernel.h"

namespace retalho::visibility_detail {
static constexpr int kLanes = 4;
#include "retalho/visibility/ray_kernel.inc"

void add_rays_generic(const RayGrid& grid, const RaySlope& slope, int first, int last, float eye, float target,
                      float* seen) {
  add_rays(grid, slope, first, last, eye, target, seen);
}

}  // namespace retalho::visibility_detail
