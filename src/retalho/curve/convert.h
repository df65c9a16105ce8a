// The exact ways into and out of the hub: Hermite data, power basis, Catmull-Rom (docs/curves.md, "One curve, many
// forms"). B-splines: curve/bspline.h; interpolating splines: curve/interpolate.h.
#pragma once

#include <span>
#include <vector>

#include "retalho/curve/curve.h"

namespace retalho {

/// Cubic segments from points and tangents dQ/du; `breaks` (one a point, ascending; empty: 0, 1, 2, ...) are the
/// parameters. Bézier points: P, P + h R / 3, P' - h R' / 3, P'. Throws BadInput on counts that do not fit.
Curve from_hermite(std::span<const Vec3> points, std::span<const Vec3> tangents, int dimension,
                   std::span<const double> breaks = {}, bool closed = false);

/// Quintic segments from points, first and second derivatives by u.
Curve from_hermite_quintic(std::span<const Vec3> points, std::span<const Vec3> tangents, std::span<const Vec3> seconds,
                           int dimension, std::span<const double> breaks = {}, bool closed = false);

struct HermiteData {
  std::vector<Vec3> points, tangents, seconds;
  std::vector<double> breaks;
};
/// Back again: ends and derivatives of each segment, two entries a segment (left end, right end).
HermiteData to_hermite(const Curve& curve);

/// One segment Q(u) = a[0] + a[1] (u - from) + a[2] (u - from)^2 + ... on [from, to].
Curve from_power(std::span<const Vec3> coefficients, double from, double to, int dimension);
/// Coefficients by (u - from) of a polynomial segment. Throws UsageError for a rational one.
std::vector<Vec3> to_power(const CurveSegment& segment);

/// Cubic through all points, tangents by the neighbours: uniform (power 0), centripetal (0.5) or chord-length (1)
/// parameters; end tangents by the parabola through three points. Throws BadInput: fewer than 2 points, repeated ones.
Curve catmull_rom(std::span<const Vec3> points, int dimension, bool closed = false, double power = 0.5);

/// The graph (x, p(x)) of a polynomial on [from, to] as a plane curve: Bézier points (from + i h / n, b_i).
Curve from_graph(std::span<const double> bernstein, double from, double to);

}  // namespace retalho
