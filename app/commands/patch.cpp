// retalho patch: three boundary curves to a triangular parametric surface.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "inputs.h"
#include "retalho/core/error.h"
#include "retalho/mesh/patch_mesh.h"
#include "retalho/patch/document.h"
#include "retalho/patch/patch.h"
#include "table.h"

namespace retalho::app {
namespace {

struct Options {
  std::string input, recovery = "smooth", layout = "delaunay", samples = "parameter";
  std::vector<std::string> outputs;
  std::vector<std::size_t> divisions;
  double snap = 0;
};

std::vector<Patch> make_patches(const Options& options, const Context& context) {
  const auto placement = static_cast<SidePlacement>(choose("--samples", options.samples, {"parameter", "arc-length"}));
  PatchOptions made;
  made.recovery = static_cast<Recovery>(choose("--recovery", options.recovery, {"barycentric", "spr", "smooth"}));
  made.layout = static_cast<DomainLayout>(choose("--layout", options.layout, {"delaunay", "midpoint"}));
  if (!options.divisions.empty() && options.divisions.size() != 1 && options.divisions.size() != 3)
    throw UsageError("--divisions: expected one number, or three with commas", {}, "--divisions");
  const PatchOptions defaults = made;
  std::vector<Patch> patches;
  for (const PatchSpec& spec : read_patches(options.input, placement)) {
    context.check();
    made = defaults;
    if (spec.divisions) made.divisions = *spec.divisions;
    if (options.divisions.size() == 1) made.divisions.fill(options.divisions[0]);
    if (options.divisions.size() == 3) std::copy_n(options.divisions.begin(), 3, made.divisions.begin());
    try {
      patches.push_back(make_patch(join_sides(spec.sides, {.snap = options.snap}, spec.where), made, context));
    } catch (const BadInput& error) {
      throw BadInput(fmt::format("{}: {}", options.input, error.what()), options.input, error.where());
    }
    patches.back().name = spec.name;
  }
  return patches;
}

void run(const Program& program, const Options& options) {
  for (const std::string& out : options.outputs)
    check_output(program, out, {".ply", ".obj", ".stl", ".glb"}, {options.input});
  const Context context = program.context();
  const Stopwatch clock;
  const std::vector<Patch> patches = make_patches(options, context);
  std::size_t nodes = 0, triangles = 0, folds = 0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    nodes += patches[i].positions.size();
    triangles += patches[i].domain.triangles.size();
    const FoldReport report = find_folds(patches[i]);
    folds += report.folds;
    if (report.folds > 0)
      program.say(fmt::format(
          "patch {} folds over in {} places, worst at u = {:.4g}, v = {:.4g}, point ({:.6g}, {:.6g}, {:.6g}): other "
          "parameters of the sides (--samples arc-length), or two patches, may help",
          i, report.folds, report.parameters.x, report.parameters.y, report.point.x, report.point.y, report.point.z));
  }
  const TriangleMesh mesh = mesh_patches(patches);
  const MeshCheck check = check_mesh(mesh);
  for (const std::string& out : options.outputs) {
    context.check();
    write_mesh(mesh, out, program.overwrite);
    program.detail(fmt::format("wrote '{}'", out));
  }
  const nlohmann::ordered_json json = {{"patches", patches.size()},
                                       {"nodes", nodes},
                                       {"triangles", triangles},
                                       {"folds", folds},
                                       {"boundary_edges", check.open_edges},
                                       {"seconds", clock.seconds()}};
  if (program.json) return program.print(json);
  program.print(list_text({{"patches", json["patches"].dump()},
                           {"nodes", json["nodes"].dump()},
                           {"triangles", json["triangles"].dump()},
                           {"folds", json["folds"].dump()}}));
}

}  // namespace

void add_patch(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, program, "patch", "Three boundary curves to a triangular parametric surface",
                                  "retalho patch examples/patches/octant.json -o octant.glb\n"
                                  "retalho patch sides.json -o mesh.ply --divisions 20,30,25 --snap 0.01");
  command->add_option("FILE", options->input, "Patches (.json, docs/triangular-patches.md)")->required()->type_name("");
  command->add_option("-o,--output", options->outputs, "Triangles (.ply .obj .stl .glb); may be repeated")
      ->type_name("FILE")
      ->take_all()
      ->expected(1);
  command->add_option("--divisions", options->divisions, "Edges a side: N, or N1,N2,N3 (default: the file's, or 32)")
      ->type_name("N")
      ->delimiter(',');
  command->add_option("--layout", options->layout, "Different divisions a side: delaunay (any), midpoint (three grids)")
      ->type_name("KIND")
      ->capture_default_str();
  command->add_option("--samples", options->samples, "How sides are divided: by parameter, by arc-length")
      ->type_name("KIND")
      ->capture_default_str();
  command->add_option("--recovery", options->recovery, "Between the nodes: barycentric, spr, smooth")
      ->type_name("KIND")
      ->capture_default_str();
  command->add_option("--snap", options->snap, "Join ends of sides that are at most T apart")->type_name("T");
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
