// A TetraQuad on an adaptive mesh: Kuhn's tetrahedra, bisected where the fitted surface is farthest from its points.
#pragma once

#include <cstddef>

#include "retalho/tetraquad/fit.h"

namespace retalho {

struct TetraQuadAdaptiveOptions {
  /// Stop before the surface has more (ten a vertex of a crossed tetrahedron); closing holes may add a hundredth.
  std::size_t coefficients = 30000;
  double max_error = 0;  ///< or when `quantile` of the points are within; 0: never
  double quantile = 0.99;
  int roots = 6;           ///< cubes along the longest side of the points' box, 2 to 64
  int start_level = 4;     ///< bisections before the first fit, 0 to 12
  double share = 0.25;     ///< of the whole residual that a pass marks, above 0, at most 1
  std::size_t fewest = 6;  ///< points in a tetrahedron that is bisected; 20 for noisy points
  int growth = 3;          ///< as TetraQuadFitOptions::growth
};

/// Fit, sum |C| over the points of the tetrahedra round each edge that would be cut, cut the edges with the largest
/// sums, make the mesh conform, fit again. `options.resolution`, `split` and `growth` are not used. Lighter smoothing
/// than on a grid is right for clean points: smoothness 0.1. Throws as fit_tetraquad does. Cost: about four times the
/// last fit. Throws BadInput too where the budget, or a pass, does not fit into memory (core/memory.h).
TetraQuad fit_tetraquad_adaptive(const PointCloud& cloud, const TetraQuadAdaptiveOptions& adaptive = {},
                                 const TetraQuadFitOptions& options = {.smoothness = 0.1},
                                 TetraQuadFitReport* report = nullptr, const Context& context = {});

}  // namespace retalho
