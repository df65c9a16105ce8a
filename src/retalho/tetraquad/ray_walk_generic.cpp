#include "retalho/tetraquad/ray_walk.h"

#include "retalho/tetraquad/rays.h"

namespace retalho {
static constexpr int kLanes = 4;
#include "retalho/tetraquad/ray_walk.inc"

void walk_rays_generic(const RayScene& scene, RayQuery& query) {
  walk(scene, query);
}

void meet_all_prims(const RayScene& scene, std::size_t count, RayQuery& query) {
  Segment ray;
  double inverse[3], enter = 0;
  query.prim = -1;
  if (!clip(scene, query, ray, inverse, &enter)) return;
  for (std::uint32_t n = 0; n < count; ++n) meet(scene, n, ray);
  answer(scene, ray, enter, query);
}

double first_root(const std::array<double, 4>& b) {
  return smallest_root(b.data());
}

RayWalk ray_walk() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return walk_rays_avx2;
#endif
  return walk_rays_generic;
}

}  // namespace retalho
