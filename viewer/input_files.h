// What was given on the command line, read before the page opens: a wrong file is the program's error, with its exit
// code, and not a surprise in the browser. The page knows files by their number alone.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <variant>
#include <vector>

#include "calls.h"
#include "retalho/cloud/cloud.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho::viewer {

/// A terrain to look at: a grid, or a model, or both.
struct TerrainInput {
  std::string name;                      ///< the file's name without its folder, or what the example is
  std::string described;                 ///< one line
  std::shared_ptr<const Raster> grid;    ///< null for a model
  std::shared_ptr<const Terrain> model;  ///< null for a grid
};

/// An implicit surface: a model file, or quadrics by hand (docs/tetraquad.md).
struct TetraQuadInput {
  std::string name, described;
  std::shared_ptr<const TetraQuad> surface;
};

/// Points in space, with normals (estimated where the file has none), to be reconstructed as a TetraQuad.
struct CloudInput {
  std::string name, described;
  std::shared_ptr<const PointCloud> cloud;
};

struct InputFiles {
  std::vector<TerrainInput> terrains;
  bool terrains_given = true;  ///< false: the only terrain is the example
  std::vector<TetraQuadInput> tetraquads;
  std::vector<CloudInput> clouds;
};

/// Reads `paths`; with none, the terrain is an example made by formula. Throws as the readers do, and BadInput for a
/// file of a kind that the page cannot show.
InputFiles read_inputs(const std::vector<std::string>& paths, const Context& context);

}  // namespace retalho::viewer
