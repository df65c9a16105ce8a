// What the tests of tiled models are made of.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "retalho/core/atomic_file.h"
#include "retalho/raster/io.h"
#include "retalho/tiles/plan.h"
#include "support/support.h"

namespace retalho::test {

/// Hills with an odd cell size, so that products of cells round; `voids`: a lake across seams and one corner missing.
inline Raster hills(int columns, int rows, bool voids) {
  Raster raster;
  raster.columns = columns;
  raster.rows = rows;
  raster.cell_width = 7.3;
  raster.cell_height = 9.1;
  raster.georef.origin_x = 500003.65;
  raster.georef.origin_y = 4200004.55;
  std::vector<double> heights(raster.cells());
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const bool lake = voids && (std::hypot(c - 40, r - 37) < 9 || (c > columns - 20 && r < 25));
      heights[raster.index(c, r)] =
          lake ? std::numeric_limits<double>::quiet_NaN()
               : 80 * std::sin(c / 11.0) * std::cos(r / 9.0) + 30 * std::sin((c + 2 * r) / 17.0);
    }
  raster.heights = std::move(heights);
  return raster;
}

/// All files under a folder, by their names below it.
inline std::map<std::string, std::string> contents(const std::string& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      all[entry.path().lexically_relative(folder).string()] = read_file(entry.path().string());
  return all;
}

/// A kind of tiled model, and how a test's name says it.
struct TileCase {
  bool voids;
  SurfaceKind surface;
  bool fitted;
};
inline void PrintTo(const TileCase& c, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's name
  *out << surface_name(c.surface) << (c.fitted ? " fitted" : "") << (c.voids ? " with voids" : "");
}

struct MadeTiles {
  test::ScratchFolder folder;
  std::string dem = (folder.path() / "dem.tif").string(), tiles = (folder.path() / "tiles").string();
  TilePlan plan;

  explicit MadeTiles(bool voids, SurfaceKind surface = SurfaceKind::clough_tocher, double max_error = 1.5,
                     bool fitted = false) {
    write_raster(hills(131, 98, voids), dem);
    plan = plan_tiles(dem, {.size = 40, .max_error = max_error, .surface = surface, .fitted = fitted});
  }
  /// Fitted to a number of vertices; refined by the surface where an effort is given.
  MadeTiles(bool voids, SurfaceKind surface, std::size_t vertices, std::optional<Effort> refine) {
    write_raster(hills(131, 98, voids), dem);
    plan = plan_tiles(dem, {.size = 40, .vertices = vertices, .surface = surface, .fitted = true, .refine = refine});
  }
};

}  // namespace retalho::test
