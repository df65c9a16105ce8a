// Models beside one another: what each is, how large, how far from the grid that it stands for.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/report.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// One model with what is known of it.
struct ModelReport {
  std::string name;  ///< file, or kind
  std::string surface, gradients, cross_derivative;
  std::size_t vertices = 0, triangles = 0, coefficients = 0, numbers = 0, bytes = 0;
  double tolerance = 0;
  ErrorReport errors;
  bool has_slope = true;
  bool refined = false;  ///< by its own error: the tolerance is the surface's, not the flat triangulation's
};
/// Everything but name, bytes and errors.
ModelReport facts_of(const Terrain& terrain);

/// "clough-tocher quadratic", "clough-tocher cubic quadratic", "linear".
std::string kind_text(const ModelReport& report);

/// Called with each model that is compared, to look at more of it.
using CompareMore = std::function<void(const Terrain& terrain, const ModelReport& report)>;

/// Every kind of surface on one triangulation of `raster` (refine_tin): the paper's gradients first, then the better
/// ones, then those that are fitted to all cells; named by their kinds. `max_error`: the tolerance to be judged, 0:
/// none. Cost: about twelve fits of gradients, five of them least-squares.
std::vector<ModelReport> compare_kinds(const Tin& tin, const Raster& raster, double max_error,
                                       const CompareMore& more = {}, const Context& context = {});

}  // namespace retalho
