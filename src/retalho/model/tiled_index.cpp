#include "retalho/model/tiled.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "retalho/core/error.h"
#include "retalho/terrain/surface_refine.h"

namespace retalho {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "retalho-tiles";
constexpr int kVersion = 1;
constexpr const char *kInterpolated = "interpolate", *kFitted = "least-squares", *kRefined = "surface";
constexpr int kMostCells = 1 << 30;  // a side

Json json_of(const TileEntry& tile, const TiledIndex& index) {
  const CellWindow& w = tile.cells;
  const double cell_x = index.cell_width / index.georef.scale_x, cell_y = index.cell_height / index.georef.scale_y;
  const double west = index.georef.origin_x + w.column * cell_x, north = index.georef.origin_y - w.row * cell_y;
  return {{"row", tile.row},
          {"column", tile.column},
          {"cells", {w.column, w.row, w.columns, w.rows}},
          {"extent", {west, north - (w.rows - 1) * cell_y, west + (w.columns - 1) * cell_x, north}},
          {"file", tile.file.empty() ? Json(nullptr) : Json(tile.file)},
          {"bytes", tile.bytes},
          {"checksum", tile.checksum},
          {"vertices", tile.vertices},
          {"triangles", tile.triangles}};
}

[[noreturn]] void refuse(const std::string& file, const std::string& words) {
  throw CannotRead(fmt::format("'{}' is not the index of a tiled model: {}", file, words), file);
}

TileEntry entry_of(const Json& json, const std::string& file) {
  TileEntry tile;
  tile.row = json.at("row").get<int>();
  tile.column = json.at("column").get<int>();
  const auto cells = json.at("cells").get<std::array<int, 4>>();
  tile.cells = {cells[0], cells[1], cells[2], cells[3]};
  if (!json.at("file").is_null()) tile.file = json.at("file").get<std::string>();
  tile.bytes = json.at("bytes").get<std::size_t>();
  tile.checksum = json.at("checksum").get<std::string>();
  tile.vertices = json.at("vertices").get<std::size_t>();
  tile.triangles = json.at("triangles").get<std::size_t>();
  if (tile.file.find('/') != std::string::npos || tile.file == "..")
    refuse(file, fmt::format("the tile '{}' would lie outside of the folder", tile.file));
  return tile;
}

void check(const TiledIndex& index, const std::string& file) {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  if (index.columns < 2 || index.rows < 2 || index.columns > kMostCells || index.rows > kMostCells ||
      index.tile_size < 1)
    refuse(file, fmt::format("{} x {} cells in tiles of {}", index.columns, index.rows, index.tile_size));
  if (!positive(index.cell_width) || !positive(index.cell_height) || !positive(index.georef.scale_x) ||
      !positive(index.georef.scale_y) || !std::isfinite(index.georef.origin_x) || !std::isfinite(index.georef.origin_y))
    refuse(file, "a cell size, scale or origin is no number that can be used");
}

void check_tiles(const TiledIndex& index, const std::string& file) {
  if (index.tiles.size() != index.tile_count())
    refuse(file, fmt::format("{} tiles, where {} make up the grid", index.tiles.size(), index.tile_count()));
  std::size_t k = 0;
  for (int r = 0; r < index.tile_rows(); ++r)
    for (int c = 0; c < index.tile_columns(); ++c, ++k) {
      const TileEntry& tile = index.tiles[k];
      const CellWindow w = index.window(r, c);
      if (tile.row != r || tile.column != c || tile.cells.column != w.column || tile.cells.row != w.row ||
          tile.cells.columns != w.columns || tile.cells.rows != w.rows)
        refuse(file, fmt::format("tile {} is not that of row {}, column {}", k, r, c));
    }
}

}  // namespace

std::string index_text(const TiledIndex& index) {
  const Georef& g = index.georef;
  Json json = {{"format", kFormat},
               {"version", kVersion},
               {"grid",
                {{"columns", index.columns},
                 {"rows", index.rows},
                 {"cell_width", index.cell_width},
                 {"cell_height", index.cell_height},
                 {"origin", {g.origin_x, g.origin_y}},
                 {"scale", {g.scale_x, g.scale_y}},
                 {"unit", g.unit},
                 {"geographic", g.geographic},
                 {"crs", g.crs_wkt}}},
               {"parameters",
                {{"tile_size", index.tile_size},
                 {"surface", surface_name(index.surface)},
                 {"fit", index.fitted ? kFitted : kInterpolated},
                 {"max_error", index.max_error},
                 {"budget", index.budget}}}};
  if (!index.effort.empty()) {
    json["parameters"]["refine"] = kRefined;
    json["parameters"]["effort"] = index.effort;
  }
  json["tiles"] = Json::array();
  for (const TileEntry& tile : index.tiles) json["tiles"].push_back(json_of(tile, index));
  return json.dump(1) + "\n";
}

TiledIndex parse_frame(std::string_view text, const std::string& file) {
  TiledIndex index;
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != kFormat) refuse(file, "its format is another one");
    if (json.at("version") != kVersion)
      refuse(file, fmt::format("its version is {}, and this Retalho knows {}", json.at("version").dump(), kVersion));
    const Json &grid = json.at("grid"), &parameters = json.at("parameters");
    index.columns = grid.at("columns").get<int>();
    index.rows = grid.at("rows").get<int>();
    index.cell_width = grid.at("cell_width").get<double>();
    index.cell_height = grid.at("cell_height").get<double>();
    const auto origin = grid.at("origin").get<std::array<double, 2>>(),
               scale = grid.at("scale").get<std::array<double, 2>>();
    index.georef = {origin[0],
                    origin[1],
                    scale[0],
                    scale[1],
                    grid.at("crs").get<std::string>(),
                    grid.at("unit").get<std::string>(),
                    grid.at("geographic").get<bool>()};
    index.tile_size = parameters.at("tile_size").get<int>();
    const auto surface = parse_surface(parameters.at("surface").get<std::string>());
    if (!surface) refuse(file, "an unknown kind of surface");
    index.surface = *surface;
    index.max_error = parameters.at("max_error").get<double>();
    // What folders made before these words existed are.
    const auto fit = parameters.value("fit", std::string(kInterpolated));
    if (fit != kInterpolated && fit != kFitted) refuse(file, fmt::format("an unknown fit '{}'", fit));
    index.fitted = fit == kFitted;
    index.budget = parameters.value("budget", std::size_t{0});
    if (parameters.contains("refine")) {
      if (parameters.at("refine") != kRefined)
        refuse(file, fmt::format("an unknown refinement {}", parameters.at("refine").dump()));
      index.effort = parameters.at("effort").get<std::string>();
      if (!parse_effort(index.effort)) refuse(file, fmt::format("an unknown effort '{}'", index.effort));
    }
    for (const Json& tile : json.at("tiles")) index.tiles.push_back(entry_of(tile, file));
  } catch (const nlohmann::json::exception& error) {
    refuse(file, error.what());
  }
  check(index, file);
  return index;
}

TiledIndex parse_index(std::string_view text, const std::string& file) {
  TiledIndex index = parse_frame(text, file);
  check_tiles(index, file);
  return index;
}

}  // namespace retalho
