// `retalho mesh` for viewers of the globe: folders of quantized-mesh or 3D Tiles.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "inputs.h"
#include "program.h"

namespace retalho::app {

struct GlobeFlags {
  int level = -1;
  double outside = 0;
  bool no_normals = false, no_gzip = false;
  std::size_t tile_triangles = 0;
  bool given() const { return level != -1 || outside != 0 || no_normals || no_gzip || tile_triangles != 0; }
};
void add_globe_flags(CLI::App& command, GlobeFlags& flags);

/// Is the output's name layer.json or tileset.json?
bool is_globe_name(const std::string& output);

/// A tiled model is sampled, or meshed, tile by tile.
void mesh_globe(const Program& program, const GlobeFlags& flags, const std::string& model,
                const TileMemoryFlag& tile_memory, const std::string& output, double tolerance);

}  // namespace retalho::app
