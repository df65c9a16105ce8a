// Folded vertices: where one is, each of its triangles takes the slope of its own plane there instead of a gradient
// that all share. It costs a height and no gradient. Where all vertices are folded the surface is the flat one; along
// the edges of one that is folded the surface is continuous and has creases (terrain/creases.h). Internal to terrain/.
#pragma once

#include <cstdint>

#include "retalho/terrain/fit_element.h"

namespace retalho {

/// The slope of the plane through the heights of a triangle at these corners.
Vec2 plane_slope(const Corners& corners, const std::array<double, 3>& heights);

/// The plane's slope as the gradient of the folded corners: bit k of `folded` is corner k.
void fold_corners(const Corners& corners, std::uint8_t folded, CornerData& data);

/// The element of a triangle as a function of its heights and of the gradients at the corners that are not folded:
/// nothing depends on the others' any more.
void fold_element(const Corners& corners, std::uint8_t folded, FitElement& element);

}  // namespace retalho
