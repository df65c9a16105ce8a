// From oriented points to a TetraQuad surface: one sparse linear least-squares problem (docs/tetraquad.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "retalho/cloud/cloud.h"
#include "retalho/core/context.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// How the quadrics are found. `cholesky`: the least energy, by sparse factors. `cg`: the same by conjugate gradients,
/// starting from the local fits; less memory, more time. `local`: no system of equations, each vertex from the points
/// around it; fast and rough.
enum class TetraQuadSolver : std::uint8_t { cholesky, cg, local };

struct TetraQuadFitOptions {
  int resolution = 32;  ///< cubes along the longest side of the points' box, 2 to 1000
  TetSplit split = TetSplit::five;
  /// Multiplies all smoothing terms below: 0.1 for clean and dense points, 10 for noisy ones.
  double smoothness = 1;
  std::array<double, 3> jump = {1e-3, 1e-4, 1e-5};  ///< of the first three normal derivatives over faces
  double bending = 1e-6;                            ///< of the second derivatives
  double normal_weight = 1;                         ///< of the normals against the distances in steps of the grid
  double ridge = 1e-9;                              ///< of the mean of the diagonal: the redundancy's share
  /// At most so many times tetrahedra are added where the surface leaves those that there are, up to two cubes beyond
  /// those with points. What does not close a hole is taken back: larger holes and the border of open data stay open.
  int growth = 3;
  /// The shape is known to be closed: where the points have holes, however large, the surface follows a rough closed
  /// fit of them all, of half the resolution, a quarter and so on.
  bool closed = false;
  TetraQuadSolver solver = TetraQuadSolver::cholesky;
  double cg_tolerance = 1e-4;  ///< residual of `cg`, preconditioned, against the right-hand side; above 0
};

/// Refine until the points are near enough.
struct TetraQuadErrorOptions {
  double max_error = 0;    ///< distance, the points' unit; above 0
  double quantile = 0.99;  ///< the share of the points that must be within, above 0, at most 1
  int coarsest = 8;        ///< the first resolution; each next one is half as much again
  int finest = 128;        ///< the last
};

struct TetraQuadFitReport {
  std::size_t points = 0, used = 0;  ///< given; with finite coordinates
  std::size_t without_normal = 0;    ///< of those used: normal missing, zero or not finite
  std::size_t vertices = 0, tetrahedra = 0;
  std::size_t crossed = 0;         ///< tetrahedra that the surface passes through (TetraQuadField::crosses)
  std::size_t coefficients = 0;    ///< ten a vertex of those
  std::size_t factor_numbers = 0;  ///< in the Cholesky factors
  int iterations = 0;              ///< of conjugate gradients, all passes together
  int growth_rounds = 0;
  std::size_t stray = 0;                       ///< tetrahedra dropped with sheets that no point asks for
  std::size_t open_faces = 0;                  ///< border faces that the surface still meets (0: it is closed)
  double residual_mean = 0, residual_max = 0;  ///< of |C| / |grad C| at the points, lengths
  double residual_quantile = 0;       ///< 99 % of the points are within (or what TetraQuadErrorOptions asked for)
  int resolution = 0;                 ///< that was worked with
  std::size_t outliers = 0;           ///< points beyond max_error, where one was asked for
  std::vector<std::string> warnings;  ///< sentences for the user
};

/// The surface with C ~ signed distance, negative inside (against the normals).
///
/// Promises: points on a quadric, with its gradients as normals, give it back to 1e-6 of a grid step where `bending` is
/// 0; the same bytes on every run and from any number of threads. Throws BadInput: no point, all points at one place,
/// no normals. UsageError: options out of range. Cost: bunny's 40,000 points at 24: about 2 s and 400 MB on one thread;
/// grows with resolution^3.
TetraQuad fit_tetraquad(const PointCloud& cloud, const TetraQuadFitOptions& options = {},
                        TetraQuadFitReport* report = nullptr, const Context& context = {});

/// The coarsest of the resolutions of `error` at which the surface is within max_error of the asked share of the
/// points; options.resolution is not used. Where even the finest does not do, that one, with a warning. Outliers are
/// counted. Throws UsageError for options out of range, and as fit_tetraquad does.
TetraQuad fit_tetraquad_to(const PointCloud& cloud, const TetraQuadErrorOptions& error,
                           const TetraQuadFitOptions& options = {}, TetraQuadFitReport* report = nullptr,
                           const Context& context = {});

}  // namespace retalho
