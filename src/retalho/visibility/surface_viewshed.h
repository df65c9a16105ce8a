// What is seen on the smooth surface of a model itself, not on cells of it.
//
// Definition. The eye is `height` above the surface at its point; a target stands `target_height` above the surface at
// the centre of a cell. It is visible when the straight line between them is nowhere below the surface: on each piece
// that it passes, both are polynomials of the way along it, and their difference is decided by its Bernstein ordinates,
// halved where they leave it open (no sampling). Heights that differ by less than 1e-11 of the model's touch, and
// touching counts as visible. Cells without data block nothing (transparent) or everything that passes them (blocks).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "retalho/terrain/evaluate.h"
#include "retalho/visibility/line_of_sight.h"
#include "retalho/visibility/viewshed.h"

namespace retalho {

/// An observer at any point of a model.
struct SurfaceObserver {
  Vec2 at;            ///< local coordinates
  double height = 2;  ///< of the eye above the surface, height units
};

/// From how many observers each cell of the model's grid is visible; row-major; cells without data are 0. The same
/// bytes from any number of threads.
/// Throws BadInput for a model without a grid, and for an observer where the model has no data.
/// Cost: 10 to 20 ns a triangle that a line passes: about a second for a million cells and 10,000 vertices.
std::vector<std::uint32_t> surface_observer_counts(const TerrainEvaluator& evaluator,
                                                   std::span<const SurfaceObserver> observers,
                                                   const ViewshedOptions& options = {}, const Context& context = {});

/// The height above the surface that each cell needs to become visible from at least one observer, as needed_heights()
/// of viewshed.h has it.
std::vector<float> surface_needed_heights(const TerrainEvaluator& evaluator, std::span<const SurfaceObserver> observers,
                                          const ViewshedOptions& options = {}, const Context& context = {});

/// The sight line over the surface: the verdict, the smallest clearance and the first place that blocks it are the
/// polynomials' own (the clearance counts the ends too, unlike that over a grid); the profile has the ends of the
/// pieces and three points in each. Throws BadInput where an end has no data.
SightLine surface_line_of_sight(const TerrainEvaluator& evaluator, const SurfaceObserver& observer, Vec2 target,
                                const SightOptions& options = {});

}  // namespace retalho
