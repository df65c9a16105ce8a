// Internal to terrain/: the inner loops of spline_tangents.cpp, for many lines or places at once. What they give is
// what one place after the other gives, to the bit.
#pragma once

#include <array>
#include <cstddef>

#include "retalho/terrain/bicubic.h"

namespace retalho {

/// How far into a line its ends reach: a run of so many samples or more has no place that sees both.
inline constexpr int kLongRun = 2 * kSplineHalo;
/// Lines that the ends are worked out for at once.
inline constexpr std::size_t kEndLanes = 4;

/// The tridiagonal system of a line is eliminated downwards: m(k) = rest(k) - upper(k) m(k+1). The `upper` of its
/// equations, which the samples have no part in; of a line that starts with a sample's own equation.
const std::array<double, static_cast<std::size_t>(2 * kSplineHalo) + 1>& pivots(TangentEnds ends);
/// The same of a line that is cut: the tangent before the first one counts as zero.
const std::array<double, static_cast<std::size_t>(2 * kSplineHalo) + 1>& cut_pivots();

/// out[x], x < n: the tangent at `centre[x]`, whose line has kSplineHalo samples more to both sides, `stride` apart.
void inner_tangents(const double* centre, std::ptrdiff_t stride, std::size_t n, double* out);

/// The first kLongRun samples of kEndLanes lines: sample k of line l at [k][l].
using EndSamples = std::array<std::array<double, kEndLanes>, static_cast<std::size_t>(kLongRun)>;
/// Tangents at the first (or last) kSplineHalo of them.
using EndTangents = std::array<std::array<double, kEndLanes>, static_cast<std::size_t>(kSplineHalo)>;
void first_tangents(const EndSamples& z, TangentEnds ends, EndTangents& out);
/// The last kLongRun samples of the lines, and their last tangents.
void last_tangents(const EndSamples& z, TangentEnds ends, EndTangents& out);

}  // namespace retalho
