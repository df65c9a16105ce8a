// What the fits on a grid and on an adaptive mesh share. Internal to the room.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "retalho/tetraquad/closing.h"
#include "retalho/tetraquad/energy.h"
#include "retalho/tetraquad/fit.h"

namespace retalho {

/// Throws UsageError.
void check_options(const TetraQuadFitOptions& options);

/// The lattice of the fit and the points in it. Throws BadInput for points that make no surface; the report gets their
/// counts and warnings.
Samples take_samples(const PointCloud& cloud, const TetraQuadFitOptions& options, TetraQuadFitReport& report);

/// Throws BadInput for a fit of so many vertices and points that does not fit into memory (core/memory.h); `how` says
/// what made them so many. Bytes are measured (docs/limits.md); factors of a band along a surface grow as n log n.
void check_need(std::size_t vertices, std::size_t points, const TetraQuadFitOptions& options, const std::string& how);

/// `area`: that holds points, in steps^2.
EnergyWeights weights_of(const TetraQuadFitOptions& options, double area, std::size_t samples);

/// Finds the quadrics as `options.solver` says. `bins`: null where nothing local is asked for. `before`: a fit on
/// another mesh to start from, or null.
void solve_surface(TetraQuad& surface, const HalfFaces& faces, const SampleRuns& runs, const SampleBins* bins,
                   const TetraQuad* before, const EnergyWeights& weights, const TetraQuadFitOptions& options,
                   TetraQuadFitReport& report, const Context& context);

/// A fit on a grid that is closed along a guide.
TetraQuad fit_along(const PointCloud& cloud, const TetraQuadFitOptions& options, const ClosedGuide& guide,
                    const Context& context);

inline constexpr int kClosingRounds = 60;  ///< of growth, where the surface is to be closed

/// Finds the quadrics of the marked vertices, the others stay. `guide`: null unless the surface is to be closed.
void solve_added(TetraQuad& surface, const HalfFaces& faces, const std::vector<char>& is_new, const SampleBins* bins,
                 const ClosedGuide* guide, const EnergyWeights& weights, const TetraQuadFitOptions& options,
                 const Context& context);

/// The sizes of the finished surface: vertices, tetrahedra, crossed ones, coefficients.
void count_sizes(const TetraQuadField& field, TetraQuadFitReport& report);

/// Sizes and residuals of the finished surface.
void measure(const TetraQuadField& field, const SampleRuns& runs, const TetraQuadErrorOptions& error,
             TetraQuadFitReport& report);

}  // namespace retalho
