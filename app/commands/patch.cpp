// retalho patch: three boundary curves, or a mesh, to a triangular parametric surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "inputs.h"
#include "needs_in_space.h"
#include "render_patches.h"
#include "retalho/core/error.h"
#include "retalho/mesh/patch_mesh.h"
#include "retalho/model/model.h"
#include "retalho/patch/document.h"
#include "retalho/patch/joins.h"
#include "retalho/patch/parameterize.h"
#include "retalho/patch/report.h"
#include "retalho/render/patch_picture.h"
#include "table.h"

namespace retalho::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string input, recovery = "smooth", layout = "delaunay", samples = "parameter", weights = "mean-value",
                     style = "lines", size = "800x600";
  std::vector<std::string> outputs, at;
  std::vector<std::size_t> divisions;
  std::vector<std::uint32_t> corners;
  std::size_t refine = 1;
  double snap = 0, from = 30, elevation = 30;
};

bool ends_with(const std::string& path, const char* ending) {
  std::string end = std::filesystem::path(path).extension().string();
  std::transform(end.begin(), end.end(), end.begin(), [](unsigned char c) { return std::tolower(c); });
  return end == ending;
}

std::vector<Patch> from_mesh(const Program& program, const Options& options, Recovery recovery,
                             const Context& context) {
  note_input(options.input);
  check_file_need("the parameters of", kMeshFile, options.input);
  const TriangleMesh mesh = read_mesh(options.input);
  ParameterizeOptions made;
  made.weights = static_cast<Weights>(choose("--parameters", options.weights, {"shape-preserving", "mean-value"}));
  if (!options.corners.empty()) {
    if (options.corners.size() != 3) throw UsageError("--corners: expected three vertex numbers", {}, "--corners");
    made.corners = {options.corners[0], options.corners[1], options.corners[2]};
  }
  try {
    Parameterization result = parameterize(mesh.positions, mesh.triangles, made, context);
    program.say(fmt::format("corners U, V, W at vertices {}, {}, {}{}", result.domain.sides[0][0],
                            result.domain.sides[1][0], result.domain.sides[2][0],
                            options.corners.empty() ? " (the sharpest turns; --corners chooses others)" : ""));
    if (result.split_edges > 0)
      program.say(fmt::format("{} edges between two nodes of one side were split", result.split_edges));
    std::vector<Patch> patches;
    patches.push_back(patch_of(std::move(result), recovery));
    return patches;
  } catch (const BadInput& error) {
    throw BadInput(fmt::format("{}: {}", options.input, error.what()), options.input, error.where());
  }
}

std::vector<Patch> make_patches(const Program& program, const Options& options, const Context& context) {
  const auto placement = static_cast<SidePlacement>(choose("--samples", options.samples, {"parameter", "arc-length"}));
  PatchOptions made;
  made.recovery = static_cast<Recovery>(choose("--recovery", options.recovery, {"barycentric", "spr", "smooth"}));
  made.layout = static_cast<DomainLayout>(choose("--layout", options.layout, {"delaunay", "midpoint"}));
  if (is_model_file(options.input)) {  // as it was saved
    note_input(options.input);
    Model model = load_model(options.input);
    if (auto* set = std::get_if<PatchSet>(&model)) return std::move(set->patches);
    throw BadInput(fmt::format("'{}' holds no patches", options.input), options.input);
  }
  if (ends_with(options.input, ".ply") || ends_with(options.input, ".obj"))
    return from_mesh(program, options, made.recovery, context);
  if (!options.divisions.empty() && options.divisions.size() != 1 && options.divisions.size() != 3)
    throw UsageError("--divisions: expected one number, or three with commas", {}, "--divisions");
  const PatchOptions defaults = made;
  std::vector<Patch> patches;
  note_input(options.input);
  double nodes = 0;
  for (const PatchSpec& spec : read_patches(options.input, placement)) {
    context.check();
    made = defaults;
    if (spec.divisions) made.divisions = *spec.divisions;
    if (options.divisions.size() == 1) made.divisions.fill(options.divisions[0]);
    if (options.divisions.size() == 3) std::copy_n(options.divisions.begin(), 3, made.divisions.begin());
    const auto side = static_cast<double>(*std::max_element(made.divisions.begin(), made.divisions.end()));
    nodes += (side + 1) * (side + 2) / 2;
    check_nodes_need("making", nodes, made.recovery, options.input);
    try {
      patches.push_back(make_patch(join_sides(spec.sides, {.snap = options.snap}, spec.where), made, context));
    } catch (const BadInput& error) {
      throw BadInput(fmt::format("{}: {}", options.input, error.what()), options.input, error.where());
    }
    patches.back().name = spec.name;
  }
  return patches;
}

Json point_json(Vec3 p) {
  return {p.x, p.y, p.z};
}

Json joins_json(const std::vector<PatchJoin>& joins) {
  Json list = Json::array();
  for (const PatchJoin& join : joins)
    list.push_back({{"patches", {join.first, join.second}},
                    {"sides", {join.first_side + 1, join.second_side + 1}},
                    {"watertight", join.watertight},
                    {"gap", join.gap},
                    {"angle", join.degrees},
                    {"at", join.at},
                    {"point", point_json(join.point)},
                    {"kind", join.g1 ? "G1" : "G0"}});
  return list;
}

Json values_json(const Options& options, const PatchSurface& surface) {
  Json list = Json::array();
  for (const std::string& text : options.at) {
    const Vec2 uv = parse_point("--at", text);
    const PatchJet jet = surface.full_jet(uv);
    const PatchCurvature curvature = surface.curvature(uv);
    list.push_back({{"u", uv.x},
                    {"v", uv.y},
                    {"point", point_json(jet.point)},
                    {"du", point_json(jet.du)},
                    {"dv", point_json(jet.dv)},
                    {"duu", point_json(jet.duu)},
                    {"duv", point_json(jet.duv)},
                    {"dvv", point_json(jet.dvv)},
                    {"normal", point_json(jet.normal)},
                    {"gaussian", curvature.gaussian},
                    {"mean", curvature.mean},
                    {"inside", jet.inside}});
  }
  return list;
}

void write_outputs(const Program& program, const Options& options, const std::vector<Patch>& patches,
                   const std::vector<PatchSurface>& surfaces, const Context& context) {
  std::vector<Patch> fine;
  PatchPictureOptions picture;
  picture.style = parse_patch_style("--style", options.style);
  std::tie(picture.width, picture.height) = parse_size("--size", options.size);
  picture.from = options.from;
  picture.elevation = options.elevation;
  for (const std::string& out : options.outputs) {
    context.check();
    if (ends_with(out, ".retalho")) {
      save_model(PatchSet{patches}, out, program.overwrite);
    } else if (ends_with(out, ".png")) {
      write_png(draw_patches(patches, surfaces, picture, context), out, program.overwrite, context);
    } else {
      if (fine.empty())
        for (std::size_t i = 0; i < patches.size(); ++i)
          fine.push_back(refine(patches[i], surfaces[i], options.refine));
      write_mesh(mesh_patches(fine), out, program.overwrite);
    }
    program.detail(fmt::format("wrote '{}'", out));
  }
}

/// Bytes of the pictures that are asked for.
double pixels_need(const Options& options, std::size_t patches) {
  if (std::none_of(options.outputs.begin(), options.outputs.end(),
                   [](const auto& out) { return ends_with(out, ".png"); }))
    return 0;
  const auto [width, height] = parse_size("--size", options.size);
  return kPixelDrawn * width * height + kPatchDrawn * static_cast<double>(patches);
}

void run(const Program& program, const Options& options) {
  for (const std::string& out : options.outputs)
    check_output(program, out, {".retalho", ".ply", ".obj", ".stl", ".glb", ".png"}, {options.input});
  if (options.refine < 1 || options.refine > 1000) throw UsageError("--refine: 1 to 1000", {}, "--refine");
  parse_patch_style("--style", options.style);
  parse_size("--size", options.size);
  if (!(std::abs(options.elevation) <= 90) || !std::isfinite(options.from))
    throw UsageError("--elevation: -90 to 90 degrees; --from: a number of degrees", {}, "--elevation");
  const Context context = program.context();
  const Stopwatch clock;
  const std::vector<Patch> patches = make_patches(program, options, context);
  check_patches_need("the surfaces of", patches, pixels_need(options, patches.size()), options.input);
  std::vector<PatchSurface> surfaces;
  std::size_t nodes = 0, triangles = 0, folds = 0;
  double gap = 0, jump = 0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    surfaces.emplace_back(patches[i], context);
    nodes += patches[i].positions.size();
    triangles += patches[i].domain.triangles.size();
    const PatchReport report = assess(patches[i], surfaces[i]);
    folds += report.folds.folds;
    gap = std::max(gap, report.boundary_gap);
    jump = std::max(jump, report.gradient_jump);
    const Vec3 p = report.folds.point;
    if (report.folds.folds > 0)
      program.say(
          fmt::format("patch {} folds over in {} places, worst at u = {:.4g}, v = {:.4g}, point ({:.6g}, {:.6g}, "
                      "{:.6g}): other parameters of the sides (--samples arc-length), or two patches, may help",
                      i, report.folds.folds, report.folds.parameters.x, report.folds.parameters.y, p.x, p.y, p.z));
    else if (report.turned > 0)
      program.say(
          fmt::format("patch {}: in {} triangles the surface's normal turns away from the triangle: more "
                      "--divisions may help",
                      i, report.turned));
  }
  const std::vector<PatchJoin> joins = find_joins(patches, surfaces);
  for (const PatchJoin& join : joins)
    if (!join.watertight)
      program.say(
          fmt::format("patches {} and {} share a side, but not its nodes: give both the same divisions there, or "
                      "name one curve in both",
                      join.first, join.second));
  write_outputs(program, options, patches, surfaces, context);
  Json json = {{"patches", patches.size()}, {"nodes", nodes}, {"triangles", triangles},    {"boundary_gap", gap},
               {"gradient_jump", jump},     {"folds", folds}, {"joins", joins_json(joins)}};
  if (!options.at.empty()) json["points"] = values_json(options, surfaces[0]);
  json["seconds"] = clock.seconds();
  if (program.json) return program.print(json);
  std::vector<std::pair<std::string, std::string>> list = {
      {"patches", json["patches"].dump()},     {"nodes", json["nodes"].dump()},
      {"triangles", json["triangles"].dump()}, {"boundary gap", number_text(gap)},
      {"gradient jump", number_text(jump)},    {"folds", json["folds"].dump()}};
  for (const PatchJoin& join : joins)
    list.emplace_back(
        fmt::format("join {}.{} - {}.{}", join.first, join.first_side + 1, join.second, join.second_side + 1),
        fmt::format("{}, {}, largest angle {:.4g} degrees at s = {:.3g}", join.watertight ? "watertight" : "cracked",
                    join.g1 ? "G1" : "G0", join.degrees, join.at));
  if (!options.at.empty())
    for (const Json& at : json["points"])
      list.emplace_back(fmt::format("u {} v {}", at["u"].dump(), at["v"].dump()),
                        fmt::format("point {} normal {}", at["point"].dump(), at["normal"].dump()));
  program.print(list_text(list));
}

}  // namespace

void add_patch(CLI::App& root, Program& program) {
  auto o = std::make_shared<Options>();
  CLI::App* command =
      add_command(root, program, "patch", "Three boundary curves to a triangular parametric surface",
                  "retalho patch examples/patches/octant.json -o octant.retalho -o octant.glb --refine 4\n"
                  "retalho patch examples/patches/hull.json -o hull.png --style zebra\n"
                  "retalho patch sides.json -o mesh.ply --divisions 20,30,25 --snap 0.01\n"
                  "retalho patch scan.ply -o smooth.glb --corners 0,17,230 --refine 4");
  command
      ->add_option("FILE", o->input,
                   "Patches (.json, docs/triangular-patches.md; .retalho), or a mesh of a disk (.ply .obj)")
      ->required()
      ->type_name("");
  command
      ->add_option("-o,--output", o->outputs,
                   "A model (.retalho), triangles (.ply .obj .stl .glb) or a picture (.png); may be repeated")
      ->type_name("FILE")
      ->take_all()
      ->expected(1);
  command->add_option("--divisions", o->divisions, "Edges a side: N, or N1,N2,N3 (default: the file's, or 32)")
      ->type_name("N")
      ->delimiter(',');
  const auto kind = [&](const char* name, std::string& value, const char* words) {
    command->add_option(name, value, words)->type_name("KIND")->capture_default_str();
  };
  kind("--layout", o->layout, "Different divisions a side: delaunay (any), midpoint (three grids)");
  kind("--samples", o->samples, "How sides are divided: by parameter, by arc-length");
  kind("--recovery", o->recovery, "Between the nodes: barycentric, spr, smooth");
  kind("--parameters", o->weights, "A mesh's parameters: shape-preserving, mean-value");
  kind("--style", o->style, "Pictures: shaded, lines, isophotes, zebra, gaussian, mean");
  command->add_option("--corners", o->corners, "A mesh's corners: three vertices of its border (default: found)")
      ->type_name("A,B,C")
      ->delimiter(',');
  command->add_option("--snap", o->snap, "Join ends of sides that are at most T apart")->type_name("T");
  command->add_option("--refine", o->refine, "Written triangles: each edge cut into N, on the surface")->type_name("N");
  command->add_option("--at", o->at, "Report value, derivatives and curvature of the first patch there")
      ->type_name("U,V")
      ->take_all()
      ->expected(1);
  command->add_option("--size", o->size, "Pixels of a picture")->type_name("WxH")->capture_default_str();
  command->add_option("--from", o->from, "Where the eye stands: degrees from the x axis")->type_name("DEG");
  command->add_option("--elevation", o->elevation, "... and above the horizon")->type_name("DEG");
  command->callback([o, &program] { run(program, *o); });
}

}  // namespace retalho::app
