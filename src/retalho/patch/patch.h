// A triangular patch as it is kept: its sides, a triangulation of its parameter triangle and a point in space for each
// node (docs/triangular-patches.md). What is between the nodes is a matter of patch/surface.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "retalho/patch/domain.h"
#include "retalho/patch/sides.h"
#include "retalho/patch/transfinite.h"

namespace retalho {

/// How points between the nodes are recovered.
enum class Recovery { barycentric, spr, smooth };
const char* recovery_name(Recovery recovery);

struct Patch {
  std::string name;
  PatchSides sides;
  Domain domain;
  std::vector<Vec3> positions;  ///< one a node
  Recovery recovery = Recovery::smooth;
};

/// Patches that belong together: what a file of them holds.
struct PatchSet {
  std::vector<Patch> patches;
};

struct PatchOptions {
  std::array<std::size_t, 3> divisions = {32, 32, 32};  ///< edges of each side
  DomainLayout layout = DomainLayout::delaunay;         ///< where the divisions differ
  Recovery recovery = Recovery::smooth;
};

/// The transfinite mesh of three sides that meet (join_sides). Side nodes are on the curves, to the last bit the same
/// as those of another patch with the same curve and count. Throws as make_domain.
Patch make_patch(const PatchSides& sides, const PatchOptions& options = {}, const Context& context = {});

/// New points for the same domain: the transfinite map of other sides. Where the domain is the regular one this costs
/// 3 (n + 1) evaluations of curves and a pass over the nodes.
void move_sides(Patch& patch, const PatchSides& sides);

/// Where a mesh of a patch folds over.
struct FoldReport {
  std::size_t folds = 0;  ///< plane patches: triangles of the wrong sign; others: edges whose two triangles look away
                          ///< from each other, by more than a right angle
  Vec2 parameters;        ///< the middle of the worst one
  Vec3 point;
};
FoldReport find_folds(const Patch& patch);

}  // namespace retalho
