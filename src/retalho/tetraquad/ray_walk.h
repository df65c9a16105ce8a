// The walk of a ray down a tree of boxes to a cubic in a tetrahedron, compiled for machines with and without AVX2
// (ray_walk_*.cpp); both give the same bytes. Internal to the room.
#pragma once

#include <cstddef>
#include <cstdint>

namespace retalho {

/// A tetrahedron as a ray meets it, in lattice coordinates about the middle of all: three lines of memory.
struct alignas(64) RayPrim {
  double corner[3];     ///< where the barycentric coordinates are 1, 0, 0, 0
  std::uint32_t frame;  ///< a place in RayScene::frames
  std::uint32_t tet;    ///< the mesh's
  double ordinate[20];
};

/// Gradients of the barycentric coordinates, by axis; tetrahedra of one shape share them.
struct alignas(32) RayFrame {
  double axis[3][4];
};

inline constexpr int kRayWidth = 8;
inline constexpr std::uint32_t kRayLeaf = 0x80000000U;
inline constexpr std::size_t kRayStack = 1024;  ///< entries that a walk can hold

/// Boxes by plane: low x, y, z, high x, y, z, in single precision. Slots that are not used hold a box that no ray
/// meets.
struct alignas(64) RayNode {
  float plane[6][kRayWidth];
  std::uint32_t child[kRayWidth];  ///< a node, or kRayLeaf and a place in RayScene::prims
};

/// What a walk reads; the first node is the root. The box of all lies about the middle; its fourth numbers say nothing.
struct RayScene {
  const RayNode* nodes;
  const RayPrim* prims;
  const RayFrame* frames;
  double low[4], high[4];
};

/// A ray in lattice coordinates about the middle of all, its direction unit, and what it hits.
struct RayQuery {
  double origin[3], direction[3];
  double from = 0, to = 0;  ///< `to` becomes where the hit is
  std::int64_t prim = -1;   ///< that was hit, -1: none; of several at the very same place the first
  double b[4] = {};         ///< barycentric coordinates of the hit
};

using RayWalk = void (*)(const RayScene& scene, RayQuery& query);
void walk_rays_generic(const RayScene& scene, RayQuery& query);
#if defined(__x86_64__)
void walk_rays_avx2(const RayScene& scene, RayQuery& query);
#endif
/// The faster one that this machine has.
RayWalk ray_walk();

/// The same without the tree: looks at every tetrahedron. What a ray hits does not depend on the order, so it gives the
/// same bytes.
void meet_all_prims(const RayScene& scene, std::size_t count, RayQuery& query);

}  // namespace retalho
