// From a TIN to a terrain model: gradients, edge splits, everything that the surface kind needs.
#pragma once

#include <optional>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

struct SurfaceOptions {
  SurfaceKind surface = SurfaceKind::clough_tocher;
  GradientKind gradients = GradientKind::normals;                     ///< how the vertex gradients are estimated
  CrossDerivative cross_derivative = CrossDerivative::perpendicular;  ///< Clough-Tocher only
  std::optional<std::vector<Vec2>> given = {};  ///< gradients for GradientKind::given, one a vertex (or sector)
  std::vector<std::uint32_t> creases = {};      ///< edges that a smooth surface folds along (terrain/creases.h)
};

/// A surface on any TIN (scattered points): `georef` says where its local coordinates lie.
/// Throws BadInput for a TIN without triangles or with heights that are not finite.
Terrain make_terrain(Tin tin, const Georef& georef, const SurfaceOptions& options = {}, const Context& context = {});

/// A surface on a TIN made from `raster`: takes over its position and its exact mask of valid cells.
Terrain make_terrain(Tin tin, const Raster& raster, const SurfaceOptions& options = {}, const Context& context = {});

}  // namespace retalho
