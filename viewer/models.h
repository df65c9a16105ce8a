// The terrain models that the page is looking at: fitted once for each set of options, the last few kept.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "calls.h"
#include "detail.h"
#include "input_files.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/report.h"

namespace retalho::viewer {

struct FittedModel {
  std::string id;  ///< says which file and which options: the same ones, the same id
  std::size_t file = 0;
  std::shared_ptr<const Raster> grid;      ///< what it is compared with; null for a model file
  std::shared_ptr<const Terrain> terrain;  ///< null for a tiled model that is not joined, and so are the next two
  std::unique_ptr<TerrainEvaluator> evaluator;
  SurfaceBends bends;  ///< for the picture's level of detail
  std::shared_ptr<TiledTerrain> tiles;

  const Georef& georef() const { return tiles ? tiles->index().georef : terrain->georef; }
  std::optional<Jet> jet(Vec2 local) const { return tiles ? tiles->reader().jet(local) : evaluator->jet(local); }
  std::optional<ErrorReport> errors;
  double seconds = 0;
};
using ModelPointer = std::shared_ptr<const FittedModel>;

class Models {
 public:
  explicit Models(const InputFiles& inputs) : inputs_(inputs.terrains), given_(inputs.terrains_given) {}

  const std::vector<TerrainInput>& inputs() const { return inputs_; }
  bool given() const { return given_; }  ///< false: the terrain is the example
  /// {"file", "surface", "fit", "max_error" or "vertices"} to a model; a model file is taken as it is.
  /// `fit`: "interpolate", "least-squares", "z-only" or "surface" (refined by the surface's own error).
  ModelPointer fit(const Json& input, const Context& context);
  /// The model that {"model": id} names. Throws BadInput when it is no longer kept.
  ModelPointer get(const Json& input) const;
  /// The heights that a viewshed is computed on: the file's grid, or the model at the cells that it was made from; of a
  /// tiled model those within `radius` (0: all) of `around`, local coordinates, and its grid's `origin` is then another
  /// one. Throws BadInput for more cells than kMostSeen.
  struct Ground {
    std::shared_ptr<const Raster> grid;
    Vec2 origin;  ///< of its first cell, in the model's local coordinates
  };
  static constexpr double kMostSeen = 5e7;
  Ground grid_of(const FittedModel& model, Vec2 around, double radius, const Context& context);

 private:
  ModelPointer find(const std::string& id) const;

  std::vector<TerrainInput> inputs_;
  bool given_;
  mutable std::mutex mutex_;
  std::deque<ModelPointer> kept_;
};

/// The keys that `retalho fit --json` prints, as far as they are known without a file.
Json report_json(const FittedModel& model);

}  // namespace retalho::viewer
