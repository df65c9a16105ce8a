// The paper's adapted superconvergent patches (docs/triangular-patches.md, "spr"): one quadratic a node, the mean of
// those of the patches about it. Internal to the room patch.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "retalho/patch/patch.h"

namespace retalho {

/// M(d) = c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2, d = (x, y) = uv - uv of the node.
using NodeQuadratic = std::array<Vec3, 6>;

/// Disjoint patches that cover the triangulation: the patch of each triangle, counted from 0. Breadth-first from the
/// middle, stars of inner nodes that are free, then of side nodes; what is left joins the smallest neighbour.
std::vector<std::uint32_t> spr_patches(const Domain& domain, std::size_t& count);

std::vector<NodeQuadratic> spr_quadratics(const Domain& domain, const std::vector<Vec3>& positions);

}  // namespace retalho
