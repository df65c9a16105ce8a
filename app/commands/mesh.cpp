// retalho mesh: a model as triangles that other tools open.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <variant>

#include "inputs.h"
#include "mesh_globe.h"
#include "needs_in_space.h"
#include "render_patches.h"
#include "retalho/core/error.h"
#include "retalho/level/tile_lines.h"
#include "retalho/mesh/patch_mesh.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/mesh/tile_mesh.h"
#include "retalho/model/tiled.h"
#include "retalho/patch/joins.h"
#include "retalho/tiles/source.h"
#include "table.h"

namespace retalho::app {
namespace {

struct Options {
  std::string model, output;
  double tolerance = 0;
  GlobeFlags globe;
  TileMemoryFlag tile_memory;
};

struct Made {
  std::uint64_t vertices = 0, triangles = 0;
  double tolerance = 0;
  bool watertight = false;
  MeshCheck check;
};

void print(const Program& program, const Made& made, const std::string& output) {
  const nlohmann::ordered_json json = {{"vertices", made.vertices},
                                       {"triangles", made.triangles},
                                       {"tolerance", made.tolerance},
                                       {"watertight", made.watertight},
                                       {"boundary_edges", made.check.boundary_edges},
                                       {"components", made.check.components},
                                       {"bytes", std::filesystem::file_size(output)}};
  if (program.json) return program.print(json);
  program.print(list_text({{"vertices", json["vertices"].dump()},
                           {"triangles", json["triangles"].dump()},
                           {"tolerance", number_text(made.tolerance)},
                           {"watertight", made.watertight ? "yes" : "no"},
                           {"components", json["components"].dump()},
                           {"bytes", json["bytes"].dump()}}));
}

void say_chosen(const Program& program, const Options& options, double tolerance) {
  if (options.tolerance <= 0)
    program.say(
        fmt::format("--tolerance {:.6g}: a thousandth of the height range (chosen, as none was given)", tolerance));
}

/// A tiled model, tile by tile.
void mesh_tiles(const Program& program, const Options& options, const Context& context) {
  const TileSource tiles = tile_source(options.model, options.tile_memory.bytes());
  const SurfaceRange range = measure_range(tiles, context);
  if (!range.data) throw CannotRead(fmt::format("no tile of '{}' holds any data", options.model), options.model);
  Made made;
  made.tolerance = mesh_tolerance(range.low, range.high, {.tolerance = options.tolerance});
  say_chosen(program, options, made.tolerance);
  const TileMeshFacts facts = write_tile_mesh(tiles, made.tolerance, options.output, program.overwrite, context);
  made.vertices = facts.vertices;
  made.triangles = facts.triangles;
  made.check = facts.check;
  made.watertight = facts.check.watertight();
  print(program, made, options.output);
}

void run(const Program& program, const Options& options) {
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    throw UsageError("--tolerance must be 0 or more", {}, "--tolerance");
  if (is_globe_name(options.output))
    return mesh_globe(program, options.globe, options.model, options.tile_memory, options.output, options.tolerance);
  if (options.globe.given())
    throw UsageError(
        "--level, --outside, --no-normals, --no-gzip and --tile-triangles go with -o DIR/layer.json or "
        "DIR/tileset.json");
  check_output(program, options.output, {".ply", ".obj", ".stl", ".glb", ".xml", ".landxml"}, {options.model});
  const Context context = program.context();
  if (is_tiled_model(options.model)) return mesh_tiles(program, options, context);
  const Model model = load_any_model(options.model);
  double tolerance = options.tolerance;
  std::optional<bool> joined;  // patches: what the plan view of check_mesh cannot tell
  const TriangleMesh mesh = std::visit(
      [&](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Terrain>) {
          check_terrain_need("meshing", shape, kVertexMeshed, 0, options.model);
          tolerance = mesh_tolerance(shape, {.tolerance = options.tolerance});
          say_chosen(program, options, tolerance);
          return mesh_terrain(shape, {.tolerance = tolerance}, context);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, PatchSet>) {
          check_patches_need("meshing", shape.patches, 0, options.model);
          const std::vector<PatchSurface> surfaces = surfaces_of(shape.patches, context);
          if (tolerance <= 0) {
            for (const Patch& patch : shape.patches)
              tolerance = std::max(tolerance, 1e-3 * control_size(patch.positions));
            program.say(
                fmt::format("--tolerance {:.6g}: a thousandth of the size (chosen, as none was given)", tolerance));
          }
          const std::vector<PatchJoin> joins = find_joins(shape.patches, surfaces);
          joined = std::all_of(joins.begin(), joins.end(), [](const PatchJoin& join) { return join.watertight; });
          double deviation = 0;
          TriangleMesh triangles =
              mesh_patch_surfaces(shape.patches, surfaces, tolerance, &deviation, nullptr, context);
          if (deviation > tolerance) program.say(fmt::format("triangles within {:.3g} of the surface", deviation));
          tolerance = deviation;
          return triangles;
        } else {
          check_tetraquad_need("meshing", shape, kTetrahedronMeshed, 0, options.model);
          TetraQuadMeshNotes notes;
          const TetraQuadField field(shape);
          TriangleMesh triangles = mesh_tetraquad(field, {.tolerance = options.tolerance}, &notes, context);
          if (options.tolerance <= 0 || notes.deviation > options.tolerance)
            program.say(fmt::format("{} parts a tetrahedron's edge: triangles within {:.3g} of the surface",
                                    notes.divisions, notes.deviation));
          tolerance = notes.deviation;
          return triangles;
        }
      },
      model);
  context.check();
  const MeshCheck check = check_mesh(mesh);
  write_mesh(mesh, options.output, program.overwrite);
  print(program,
        {mesh.positions.size(), mesh.triangles.size(), tolerance,
         joined ? *joined && check.nonmanifold_edges == 0 : check.watertight(), check},
        options.output);
}

}  // namespace

void add_mesh(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, program, "mesh", "A model as triangles, to a tolerance",
                                  "retalho mesh dem.retalho -o dem.glb\n"
                                  "retalho mesh dem.retalho -o dem.ply --tolerance 0.1\n"
                                  "retalho mesh dem.retalho -o survey.xml\n"
                                  "retalho mesh dem.retalho -o terrain/layer.json --tolerance 0.5\n"
                                  "retalho mesh dem.retalho -o tiles/tileset.json");
  command->add_option("MODEL", options->model, "A .retalho file or a tiled model")->required()->type_name("");
  command
      ->add_option("-o,--output", options->output,
                   "The mesh: .ply, .obj, .stl, .glb, .xml (LandXML); or a folder's layer.json (quantized-mesh) or "
                   "tileset.json (3D Tiles)")
      ->required()
      ->type_name("FILE");
  command->add_option("--tolerance", options->tolerance, "Largest distance to the surface (terrain: vertical)")
      ->type_name("T");
  add_tile_memory_flag(*command, options->tile_memory);
  add_globe_flags(*command, options->globe);
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
