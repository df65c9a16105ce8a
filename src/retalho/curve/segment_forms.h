// A curve segment as scalar Bernstein polynomials, for questions that are roots of polynomials. With Q = A / w the
// direction of Q' is that of N = A' w - A w', for N = Q' w^2; a polynomial segment has w = 1 and N = Q'.
#pragma once

#include <array>

#include "retalho/bernstein/segment.h"
#include "retalho/curve/curve.h"

namespace retalho {

using BernsteinVector = std::array<Bernstein, 3>;

struct SegmentForms {
  BernsteinVector a;  ///< numerator
  Bernstein w;        ///< denominator: {1} for a polynomial segment
  BernsteinVector n;  ///< A' w - A w'
};

SegmentForms segment_forms(const CurveSegment& segment);

BernsteinVector derivative(const BernsteinVector& v);
Bernstein dot(const BernsteinVector& a, const BernsteinVector& b);
BernsteinVector cross(const BernsteinVector& a, const BernsteinVector& b);

/// Local parameters in [0, 1] where |N|^2 has a minimum or a maximum: all cusps, stops and near-cusps are among them.
std::vector<double> speed_extrema(const SegmentForms& forms);

}  // namespace retalho
