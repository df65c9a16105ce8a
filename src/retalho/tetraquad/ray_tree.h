// The tree that rays against a TetraQuad walk down: eight boxes a node, drawn tight around the surface in each
// tetrahedron. Internal to the room.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/tetraquad/ray_walk.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// In single precision.
struct RayBox {
  std::array<float, 3> low, high;
};

/// Nodes over the boxes, cut by the surface area heuristic; a leaf is the place of its box. At most so deep that
/// kRayStack entries do.
std::vector<RayNode> build_ray_nodes(const std::vector<RayBox>& boxes);

struct RayTree {
  std::vector<RayNode> nodes;  ///< none where there are no tetrahedra
  std::vector<RayPrim> prims;  ///< in the order in which the nodes name them
  std::vector<RayFrame> frames;
  Vec3 middle;  ///< of all, lattice coordinates
  RayBox all{};

  /// The tree must outlive it, and stay where it is.
  RayScene scene() const;
};

/// The tetrahedra that the surface passes through, in boxes tight by `halvings` bisections (tight_box.h). Boxes are
/// wider by what single precision loses for rays that start in the box of all. The same bytes from any number of
/// threads.
RayTree make_ray_tree(const TetraQuadField& field, int halvings, const Context& context);

}  // namespace retalho
