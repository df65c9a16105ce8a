#include "mesh_globe.h"

#include <fmt/format.h>

#include <filesystem>

#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/model/tiled.h"
#include "retalho/tiles/source.h"
#include "table.h"

namespace retalho::app {
namespace {

constexpr const char *kLayer = "layer.json", *kTileset = "tileset.json";

std::string name_of(const std::string& output) {
  return std::filesystem::path(output).filename().string();
}

std::string folder_of(const std::string& output) {
  const std::string folder = std::filesystem::path(output).parent_path().string();
  return folder.empty() ? "." : folder;
}

TilesetOptions tileset_options(const GlobeFlags& flags, double tolerance) {
  if (flags.level != -1 || flags.outside != 0 || flags.no_normals || flags.no_gzip)
    throw UsageError("--level, --outside, --no-normals and --no-gzip are of quantized-mesh (-o DIR/layer.json)");
  TilesetOptions options;
  options.tolerance = tolerance;
  if (flags.tile_triangles != 0) options.triangles = flags.tile_triangles;
  return options;
}

QuantizedMeshOptions quantized_options(const GlobeFlags& flags, double tolerance) {
  if (flags.tile_triangles != 0)
    throw UsageError("--tile-triangles is of 3D Tiles (-o DIR/tileset.json)", {}, "--tile-triangles");
  if (flags.level < -1) throw UsageError("--level must be 0 or more", {}, "--level");
  QuantizedMeshOptions options;
  options.tolerance = tolerance;
  options.level = flags.level;
  options.outside = flags.outside;
  options.normals = !flags.no_normals;
  options.gzip = !flags.no_gzip;
  return options;
}

GlobeNotes write_whole(const Program& program, const GlobeFlags& flags, const std::string& model,
                       const std::string& output, double& tolerance, const Context& context) {
  const Terrain terrain = load_terrain(model);
  check_terrain_need("meshing", terrain, kVertexMeshed, 0, model);
  tolerance = mesh_tolerance(terrain, {.tolerance = tolerance});
  if (name_of(output) == kTileset)
    return write_tileset(terrain, folder_of(output), tileset_options(flags, tolerance), program.overwrite, context);
  return write_quantized_mesh(TerrainEvaluator(terrain, context), folder_of(output),
                              quantized_options(flags, tolerance), program.overwrite, context);
}

/// A tiled model, sampled or meshed tile by tile.
GlobeNotes write_tiles(const Program& program, const GlobeFlags& flags, const std::string& model,
                       std::size_t tile_memory, const std::string& output, double& tolerance, const Context& context) {
  const VertexBox box = vertex_box(tile_source(model, tile_memory), context);
  if (!box.data) throw CannotRead(fmt::format("no tile of '{}' holds any data", model), model);
  tolerance = mesh_tolerance(box.low.z, box.high.z, {.tolerance = tolerance});
  if (name_of(output) == kTileset)
    return write_tileset(tile_source(model, tile_memory), folder_of(output), tileset_options(flags, tolerance),
                         program.overwrite, context);
  TileReader reader(model, tile_memory);
  return write_quantized_mesh(globe_surface(reader, box), folder_of(output), quantized_options(flags, tolerance),
                              program.overwrite, context);
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

void mesh_globe(const Program& program, const GlobeFlags& flags, const std::string& model,
                const TileMemoryFlag& tile_memory, const std::string& output, double tolerance) {
  if (std::filesystem::exists(output) && !program.overwrite)
    throw CannotWrite(fmt::format("'{}' exists: give another folder, or --overwrite", output), output);
  const Context context = program.context();
  program.say("heights are taken as they are; globes mean heights over the ellipsoid");
  const bool tiles = is_tiled_model(model);
  const GlobeNotes notes = tiles ? write_tiles(program, flags, model, tile_memory.bytes(), output, tolerance, context)
                                 : write_whole(program, flags, model, output, tolerance, context);
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
