// `retalho fit --tiles`: a grid to a tiled model.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "fitting.h"
#include "inputs.h"

namespace retalho::app {

struct TileFlags {
  std::optional<int> size;
  int jobs = 0;
};
void add_tile_flags(CLI::App& command, TileFlags& flags);

/// What `fit` was asked for, with --tiles. Throws UsageError for options that tiles do not take.
void fit_tiles(const Program& program, const TileFlags& flags, const std::string& input, const std::string& output,
               const GridFlags& grid, const BudgetFlags& budget, const SurfaceFlags& surface);

}  // namespace retalho::app
