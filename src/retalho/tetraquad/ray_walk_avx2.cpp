// Compiled with AVX2 where the compiler has it (src/CMakeLists.txt); called only on machines that have it.
#if defined(__x86_64__)
#include "retalho/tetraquad/ray_walk.h"

namespace retalho {
static constexpr int kLanes = 8;
#include "retalho/tetraquad/ray_walk.inc"

void walk_rays_avx2(const RayScene& scene, RayQuery& query) {
  walk(scene, query);
}

}  // namespace retalho
#endif
