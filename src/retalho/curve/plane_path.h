// SVG's path language: the drawing form of plane curves. Lines, quadratic and cubic Bézier segments are taken over
// exactly both ways; elliptic arcs come in as exact rational quadratics.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "retalho/curve/curve.h"

namespace retalho {

enum class PathVerb : std::uint8_t { move, line, quad, cubic, close };

/// Verbs and their points: 1, 1, 2, 3 and 0 of them.
struct PlanePath {
  std::vector<PathVerb> verbs;
  std::vector<Vec2> points;
};

/// Segments of degree 1 to 3 as they are; others (higher degree, rational) as lines that stay within `tolerance`.
PlanePath to_path(const Curve& curve, double tolerance);

/// The `d` attribute, with the shortest decimals that read back to the same doubles.
std::string to_svg(const PlanePath& path);

/// One curve for each subpath of a `d` attribute (M L H V C S Q T A Z, absolute and relative). Throws BadInput with the
/// position in the text.
std::vector<Curve> parse_svg_path(std::string_view d);

/// All <path> elements of an SVG file, and its <polyline>, <polygon> and <line> elements, in the order of the file, in
/// their own coordinates. Elements of class "decoration" (retalho's own drawings) are left out.
/// `transforms` (may be null) counts elements under a transform of another program, which is not applied.
std::vector<Curve> read_svg(const std::string& file, int* transforms = nullptr);

}  // namespace retalho
