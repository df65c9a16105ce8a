// Several patches: which sides are shared, and how smoothly the surface passes over them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "retalho/core/vec.h"
#include "retalho/patch/surface.h"

namespace retalho {

/// A side of one patch that is a side of another one.
struct PatchJoin {
  std::size_t first = 0, second = 0;    ///< patches
  int first_side = 0, second_side = 0;  ///< 0 to 2
  bool watertight = false;              ///< the nodes on both are the same to the last bit
  double gap = 0;                       ///< largest distance of the two surfaces at equal places of the side
  double degrees = 0;                   ///< largest angle between their normals
  double at = 0;                        ///< s of the largest angle on the first
  Vec3 point;                           ///< ... and where that is
  bool g1 = false;                      ///< the tangent planes agree to 0.01 degrees all along
};

/// All pairs of sides whose ends and inner places coincide within 1e-6 of the size. Sampled at 65 places a side.
/// `surfaces` are those of `patches`, in order.
std::vector<PatchJoin> find_joins(std::span<const Patch> patches, std::span<const PatchSurface> surfaces);

/// The same patch on a domain with every triangle cut into factor^2: new inner nodes are the surface's points, new side
/// nodes the curves' (so shared sides stay watertight). factor 1 gives the patch itself. Throws UsageError: factor < 1.
Patch refine(const Patch& patch, const PatchSurface& surface, std::size_t factor);

}  // namespace retalho
