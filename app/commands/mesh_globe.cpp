#include "mesh_globe.h"

#include <fmt/format.h>

#include <filesystem>

#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/mesh/terrain_mesh.h"
#include "table.h"

namespace retalho::app {
namespace {

constexpr const char *kLayer = "layer.json", *kTileset = "tileset.json";

std::string name_of(const std::string& output) {
  return std::filesystem::path(output).filename().string();
}

GlobeNotes write(const Program& program, const GlobeFlags& flags, const Terrain& terrain, const std::string& output,
                 double tolerance, const Context& context) {
  std::string folder = std::filesystem::path(output).parent_path().string();
  if (folder.empty()) folder = ".";
  if (name_of(output) == kTileset) {
    if (flags.level != -1 || flags.outside != 0 || flags.no_normals || flags.no_gzip)
      throw UsageError("--level, --outside, --no-normals and --no-gzip are of quantized-mesh (-o DIR/layer.json)");
    TilesetOptions options;
    options.tolerance = tolerance;
    if (flags.tile_triangles != 0) options.triangles = flags.tile_triangles;
    return write_tileset(terrain, folder, options, program.overwrite, context);
  }
  if (flags.tile_triangles != 0)
    throw UsageError("--tile-triangles is of 3D Tiles (-o DIR/tileset.json)", {}, "--tile-triangles");
  if (flags.level < -1) throw UsageError("--level must be 0 or more", {}, "--level");
  QuantizedMeshOptions options;
  options.tolerance = tolerance;
  options.level = flags.level;
  options.outside = flags.outside;
  options.normals = !flags.no_normals;
  options.gzip = !flags.no_gzip;
  return write_quantized_mesh(TerrainEvaluator(terrain, context), folder, options, program.overwrite, context);
}

}  // namespace

void add_globe_flags(CLI::App& command, GlobeFlags& flags) {
  command
      .add_option("--level", flags.level,
                  "layer.json: the finest level of quantized-mesh tiles (default: as fine as the model's cells)")
      ->type_name("Z");
  command.add_option("--outside", flags.outside, "layer.json: height of what the model does not cover (default 0)")
      ->type_name("H");
  command.add_flag("--no-normals", flags.no_normals, "layer.json: without the extension of oct-encoded normals");
  command.add_flag("--no-gzip", flags.no_gzip, "layer.json: tiles as they are, for servers that compress themselves");
  command
      .add_option("--tile-triangles", flags.tile_triangles, "tileset.json: about how many in a tile (default 65,536)")
      ->type_name("N");
}

bool is_globe_name(const std::string& output) {
  return name_of(output) == kLayer || name_of(output) == kTileset;
}

void mesh_globe(const Program& program, const GlobeFlags& flags, const std::string& model, const std::string& output,
                double tolerance) {
  if (std::filesystem::exists(output) && !program.overwrite)
    throw CannotWrite(fmt::format("'{}' exists: give another folder, or --overwrite", output), output);
  const Context context = program.context();
  const Terrain terrain = load_terrain(model);
  tolerance = mesh_tolerance(terrain, {.tolerance = tolerance});
  program.say("heights are taken as they are; globes mean heights over the ellipsoid");
  const GlobeNotes notes = write(program, flags, terrain, output, tolerance, context);
  nlohmann::ordered_json json = {{"tiles", notes.tiles},
                                 {"levels", notes.levels},
                                 {"triangles", notes.triangles},
                                 {"tolerance", tolerance},
                                 {"bytes", notes.bytes}};
  if (name_of(output) == kLayer) json["step"] = notes.step;
  if (program.json) return program.print(json);
  program.print(list_text({{"tiles", fmt::format("{} in {} levels", notes.tiles, notes.levels)},
                           {"triangles", fmt::format("{}", notes.triangles)},
                           {"tolerance", number_text(tolerance)},
                           {"bytes", fmt::format("{}", notes.bytes)}}));
}

}  // namespace retalho::app
