// compare --visibility: how far each model's intervisibility map is from the grid's own, in numbers and pictures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "program.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"
#include "retalho/visibility/intervisibility.h"

namespace retalho::app {

struct VisibilityFlags {
  std::optional<double> radius;  ///< not given: no maps
  double observer_height = 2, target_height = 0;
  int directions = 180;
  std::string maps;  ///< folder for the pictures; empty: none
};
void add_visibility_flags(CLI::App& command, VisibilityFlags& flags);

/// Keeps the grid's own map, and compares those of models with it.
class VisibilityErrors {
 public:
  VisibilityErrors(const Program& program, const VisibilityFlags& flags, const Raster& raster, const Context& context);

  /// The model at the grid's valid cells, so that both maps go by one definition. The picture is named by `name`.
  void add(const Terrain& terrain, const std::string& name, const Context& context);
  /// One a model, in the order added.
  const std::vector<MapDifference>& differences() const { return differences_; }
  /// Writes the pictures of all models, one colour scale for all: blue sees too little, red too much.
  void write_pictures() const;

 private:
  const Program& program_;
  VisibilityFlags flags_;
  const Raster& raster_;
  IntervisibilityOptions options_;
  std::vector<float> own_;
  std::vector<MapDifference> differences_;
  std::vector<std::pair<std::string, std::vector<float>>> maps_;
};

}  // namespace retalho::app
