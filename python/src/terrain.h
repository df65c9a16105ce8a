// The class Terrain: a model with its evaluator, made when it is first needed.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>

#include "grid.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/terrain.h"
#include "running.h"

namespace retalho::python {

class TerrainModel {
 public:
  explicit TerrainModel(Terrain terrain) : terrain_(std::move(terrain)) {}
  const Terrain& terrain() const { return terrain_; }
  /// Never call it with the interpreter lock held: another thread may be making it.
  const TerrainEvaluator& evaluator(const Context& context) const;

 private:
  Terrain terrain_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<TerrainEvaluator> evaluator_;
};

/// The surface at the cells of the grid that it was made from. Throws BadInput for a model of points.
std::shared_ptr<const Raster> model_raster(const TerrainModel& model, const Running& running);

/// Adds Terrain, with what other files define on it.
void add_terrain(pybind11::module_& module);
/// fit and fit_points.
void add_fit(pybind11::module_& module);

}  // namespace retalho::python
