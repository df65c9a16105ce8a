// Asking a terrain model for heights: at points, and on rasters by scan conversion.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "retalho/core/context.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// A model made ready for queries: ordinates of every patch, and a grid for point location. Keep it for many queries;
/// it refers to the terrain, which must outlive it. Safe to use from several threads at once.
class TerrainEvaluator {
 public:
  explicit TerrainEvaluator(const Terrain& terrain, const Context& context = {});
  ~TerrainEvaluator();
  TerrainEvaluator(TerrainEvaluator&&) noexcept;
  TerrainEvaluator& operator=(TerrainEvaluator&&) noexcept;

  const Terrain& terrain() const;
  const EdgeTable& edges() const;

  /// The triangle that holds `p` (local coordinates), by an exact-sign walk from `hint` (kNone: from the location
  /// grid); kNone outside of the triangulation. A point on an edge belongs to one of its triangles, always the same.
  std::uint32_t locate(Vec2 p, std::uint32_t hint = kNone) const;

  /// Is `p` where the model has data: inside the triangulation and in a valid cell of the model's grid?
  bool valid(Vec2 p) const;

  /// Height at `p`; NaN where there is no data.
  double value(Vec2 p) const;
  /// Height, gradient and second derivatives; nullopt where there is no data.
  std::optional<Jet> jet(Vec2 p) const;
  /// The jet on triangle `triangle`, extrapolated beyond it; no check of data.
  Jet jet_in(std::uint32_t triangle, Vec2 p) const;

  /// Heights at many points (NaN: no data). Points near each other in order are fast; threads share the work.
  void values(std::span<const Vec2> points, std::span<double> out, const Context& context = {}) const;

  /// Heights on a regular grid by scan conversion: cell (c, r) at origin + (c * step.x, -r * step.y), row-major.
  /// `gradients` may be empty, or as long as `out`. NaN: no data.
  void grid_values(Vec2 origin, Vec2 step, int columns, int rows, std::span<double> out, std::span<Vec2> gradients = {},
                   const Context& context = {}) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The model at the cells of the grid that it was made from (NaN: no data), with its georeference.
/// Throws BadInput for a model of points, which has no cells.
Raster raster_of_cells(const TerrainEvaluator& evaluator, const Context& context = {});

}  // namespace retalho
