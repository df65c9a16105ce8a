// Reading what the commands take, with the one line on standard error that says what was read.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "needs.h"
#include "program.h"
#include "retalho/cloud/cloud.h"
#include "retalho/model/model.h"
#include "retalho/raster/io.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tiles/reader.h"

namespace retalho::app {

/// The file that is being worked on: main names it in errors of steps that know no files (a triangulation of points on
/// one line). The loaders of this header note theirs.
void note_input(const std::string& path);
const std::string& noted_input();

/// Options of the commands that read an elevation grid.
struct GridFlags {
  int band = 1;
  std::optional<double> nodata;
};
void add_grid_flags(CLI::App& command, GridFlags& flags);

/// An elevation grid; refused where it and `need` pass the memory limit; its summary line and the reader's remarks go
/// to standard error.
Raster load_grid(const Program& program, const std::string& path, const GridFlags& flags, RasterSummary& summary,
                 const Context& context, const Need& need = {});
/// The same for scattered points.
PointCloud load_points(const Program& program, const std::string& path, const PointOptions& options,
                       const Context& context);
/// Is this path read as points: by its ending, or since an attribute or a layer is named?
bool takes_points(const std::string& path, const PointOptions& options);
/// A terrain model. Throws BadInput when the model holds another kind of surface, or passes the memory limit.
Terrain load_terrain(const std::string& path, ModelFileNotes* notes = nullptr);
/// Any model. Throws CannotRead, which says how models are made where the file is none.
Model load_any_model(const std::string& path, ModelFileNotes* notes = nullptr);

/// --tile-memory of the commands that read a tiled model by its tiles.
struct TileMemoryFlag {
  double megabytes = static_cast<double>(TileReader::kBound >> 20);
  std::size_t bytes() const;  ///< throws UsageError for less than 1 MB
};
void add_tile_memory_flag(CLI::App& command, TileMemoryFlag& flag);

/// The name of a CRS, out of its WKT; empty when there is none.
std::string crs_name(const std::string& wkt);

/// Throws BadInput when the two files' CRSs have different names; with no CRS on either side they pass.
void check_same_crs(const Georef& a, const std::string& a_file, const Georef& b, const std::string& b_file);

/// "X,Y" as two finite numbers. Throws UsageError.
Vec2 parse_point(const std::string& option, const std::string& text);
/// "800x600" as two whole numbers from 16 to 20,000. Throws UsageError.
std::pair<int, int> parse_size(const std::string& option, const std::string& text);
/// "1%" or "0.01", above 0 and at most 1. Throws UsageError.
double parse_ratio(const std::string& option, const std::string& text);

}  // namespace retalho::app
