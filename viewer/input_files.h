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
#include "retalho/patch/patch.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tetraquad/tetraquad.h"
#include "tiled_terrain.h"

namespace retalho::viewer {

/// A terrain to look at: a grid, a model, or a tiled model that is not joined.
struct TerrainInput {
  std::string name;                      ///< the file's name without its folder, or what the example is
  std::string described;                 ///< one line
  std::shared_ptr<const Raster> grid;    ///< null for a model
  std::shared_ptr<const Terrain> model;  ///< null for a grid
  std::shared_ptr<TiledTerrain> tiles = nullptr;

  const Georef& georef() const { return grid ? grid->georef : tiles ? tiles->index().georef : model->georef; }
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

/// A document of curves (docs/curves.md), as it was written.
struct CurvesInput {
  std::string name, described;
  Json document;
};

/// Triangular patches: a document of curves and sides (docs/triangular-patches.md), as it was written, or the patches
/// of a model file.
struct PatchInput {
  std::string name, described;
  Json document;                          ///< null for a model
  std::shared_ptr<const PatchSet> model;  ///< null for a document
};

struct InputFiles {
  std::vector<TerrainInput> terrains;
  bool terrains_given = true;  ///< false: the only terrain is the example
  std::vector<TetraQuadInput> tetraquads;
  std::vector<CloudInput> clouds;
  std::vector<CurvesInput> curves;
  std::vector<PatchInput> patches;
  std::string first_view = "start";  ///< where the first file is shown: "terrain", "curves", "patches", "tetraquads"
};

/// Reads `paths`; with no terrain among them there is an example made by formula. What a JSON file is, its keys say:
/// "patches", "tetrahedra", "curves". Throws as the readers do, and BadInput for a file of a kind that the page cannot
/// show, or that is larger than it can draw. A tiled model of more than `most_joined` vertices is shown by its tiles.
InputFiles read_inputs(const std::vector<std::string>& paths, const Context& context,
                       std::size_t most_joined = kMostJoined);

}  // namespace retalho::viewer
