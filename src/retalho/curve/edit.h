// Changes of a curve that keep its shape (splitting, elevation, reversal) or move it as a whole (affine maps), and
// the one that does not (degree reduction, with its error).
#pragma once

#include <array>

#include "retalho/curve/curve.h"

namespace retalho {

/// Two segments that together are the segment, split at local t in (0, 1) (de Casteljau); breaks stay true.
Curve split_segment(const CurveSegment& segment, double t);
/// The piece between local parameters t0 < t1.
Curve cut_segment(const CurveSegment& segment, double t0, double t1);

/// The curve before and after parameter u. Throws UsageError unless begin < u < end. The parts are open.
std::pair<Curve, Curve> split(const Curve& curve, double u);
/// The part between two parameters, begin <= u0 < u1 <= end, as an open curve with the same parameter.
Curve cut(const Curve& curve, double u0, double u1);
/// The same curve with joins at the given parameters as well.
Curve refine(const Curve& curve, std::span<const double> parameters);

/// Runs backwards; the parameter interval stays.
Curve reverse(const Curve& curve);

/// All segments of degree `degree` at least; exact. Throws BadInput over degree 63.
Curve elevate(const Curve& curve, int degree);

struct Reduction {
  Curve curve;
  double error = 0;  ///< bound for |original - reduced| at every parameter, from the control points of the difference
};
/// Segments of degree over `degree` replaced by ones of that degree with the same end points that are nearest in the
/// least-squares sense of the coefficients, which is that of the curves (Lutterkort, Peters, Reif 1999).
/// Throws UsageError for degree < 1 and for rational segments.
Reduction reduce(const Curve& curve, int degree);

/// x' = m[0..2] x + m[3] and so on, row by row.
using Affine = std::array<std::array<double, 4>, 3>;
Curve transform(const Curve& curve, const Affine& map);

/// The hodograph Q'(u) as a curve of its own. A rational segment of degree n gives one of degree 2 n.
Curve hodograph(const Curve& curve);

/// Drops the control points' z, or lifts a plane curve to space with z = 0.
Curve with_dimension(const Curve& curve, int dimension);

}  // namespace retalho
