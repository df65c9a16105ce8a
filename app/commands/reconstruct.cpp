// retalho reconstruct: points with normals to a TetraQuad surface.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "inputs.h"
#include "needs_in_space.h"
#include "retalho/cloud/normals.h"
#include "retalho/core/error.h"
#include "retalho/mesh/surface_parts.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/adaptive.h"
#include "retalho/tetraquad/document.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/without.h"
#include "table.h"

namespace retalho::app {
namespace {

const std::vector<std::string> kSplits{"five", "kuhn"};
const std::vector<std::string> kSolvers{"cholesky", "cg", "local"};

struct Options {
  std::string points, output, tetrahedra, split = "five", fit = "cholesky";
  std::optional<int> resolution;
  std::optional<double> max_error;
  std::optional<std::size_t> adaptive, parts, part_points;
  double quantile = 0.99, tolerance = 0, smoothness = 1;
  int neighbours = 16;
  bool closed = false;
};

/// Gives points without normals estimated ones, and says how sure they are.
void complete_normals(const Program& program, PointCloud& cloud, int neighbours, std::vector<std::string>& warnings,
                      const Context& context) {
  const bool given =
      std::any_of(cloud.normals.begin(), cloud.normals.end(), [](const Vec3& n) { return norm2(n) > 0; });
  if (given && cloud.normals.size() == cloud.positions.size()) return;
  NormalNotes notes;
  cloud.normals = estimate_normals(cloud.positions, {.neighbours = neighbours}, &notes, context);
  warnings.push_back(
      fmt::format("the points have no normals: estimated from {} neighbours; {:.2f} % of neighbouring normals agree, "
                  "{} part{} turned "
                  "outwards by {} outermost points{}",
                  neighbours, 100 * notes.agreement, notes.parts, notes.parts == 1 ? "" : "s",
                  notes.parts == 1 ? "its" : "their", notes.agreement < 0.98 ? ": not sure, look at the result" : ""));
  program.say("warning: " + warnings.back());
}

/// Leaves out the parts that are not asked for, and says how many there are. The surface is changed only where it will
/// be written (`as_model`).
nlohmann::ordered_json leave_out_parts(const Program& program, const Options& options, const PointCloud& cloud,
                                       bool as_model, TetraQuad& surface, TriangleMesh& mesh,
                                       TetraQuadFitReport& report, const Context& context) {
  const TetraQuadField field(surface);
  const SurfaceParts found = find_parts(mesh, field, cloud, context);
  PartChoice choice;
  choice.most = options.parts.value_or(choice.most);
  choice.points = options.part_points.value_or(0);
  std::vector<char> keep = choose_parts(found, choice);
  const auto unwanted = std::count(keep.begin(), keep.end(), 0);
  if (unwanted > 0 && as_model)
    surface = without_tetrahedra(surface, tetrahedra_left_out(mesh, field, found, keep), &report);
  const auto left_out = std::count(keep.begin(), keep.end(), 0);
  if (left_out > 0) mesh = keep_parts(mesh, found, keep);
  if (unwanted > 0)
    program.say(fmt::format("{} of {} parts left out", left_out, keep.size()));
  else if (keep.size() > 1)
    program.say(
        fmt::format("the surface has {} parts, {} points near the largest, {} near the smallest: --parts N keeps "
                    "the N largest, --part-points K those with K points near them",
                    keep.size(), found.parts.front().points, found.parts.back().points));
  if (left_out < unwanted)
    program.say(
        fmt::format("{} more share tetrahedra with parts that stay, and stay in the model: as triangles (-o "
                    "FILE.ply) they can be left out",
                    unwanted - left_out));
  nlohmann::ordered_json list = nlohmann::json::array();
  for (std::size_t n = 0; n < std::min<std::size_t>(100, keep.size()); ++n) {
    const SurfacePart& part = found.parts[n];
    const Vec3 low = part.low + mesh.offset, high = part.high + mesh.offset;
    list.push_back({{"points", part.points},
                    {"triangles", part.triangles},
                    {"area", part.area},
                    {"low", {low.x, low.y, low.z}},
                    {"high", {high.x, high.y, high.z}},
                    {"kept", keep[n] != 0}});
  }
  return {{"parts", found.parts.size()}, {"parts_left_out", left_out}, {"part_list", std::move(list)}};
}

/// A document of quadrics at vertices: nothing to fit.
void run_document(const Program& program, const Options& options, const Context& context) {
  note_input(options.points);
  const TetraQuad surface = read_quadrics(options.points);
  check_tetraquad_need("meshing", surface, kTetrahedronMeshed, 0, options.points);
  const TetraQuadField field(surface);
  const TriangleMesh mesh = mesh_tetraquad(field, {.tolerance = options.tolerance}, nullptr, context);
  const MeshTopology topology = topology_of(mesh);
  if (std::filesystem::path(options.output).extension() == ".retalho")
    save_model(surface, options.output, program.overwrite);
  else
    write_mesh(mesh, options.output, program.overwrite);
  const nlohmann::ordered_json json = {{"vertices", surface.mesh.lattice.size()},
                                       {"tetrahedra", surface.mesh.tets.size()},
                                       {"coefficients", 10 * surface.mesh.lattice.size()},
                                       {"components", topology.components},
                                       {"open_edges", topology.open_edges},
                                       {"triangles", mesh.triangles.size()}};
  if (program.json) return program.print(json);
  program.say(
      fmt::format("{}: {} tetrahedra, {} triangles", options.output, surface.mesh.tets.size(), mesh.triangles.size()));
}

void run(const Program& program, const Options& options) {
  if (options.parts && *options.parts == 0) throw UsageError("--parts must be 1 or more", {}, "--parts");
  const std::size_t split = choose("--split", options.split, kSplits);
  const std::size_t solver = choose("--fit", options.fit, kSolvers);
  if (!std::isfinite(options.tolerance) || options.tolerance < 0)
    throw UsageError("--tolerance must be 0 or more", {}, "--tolerance");
  check_output(program, options.output, {".retalho", ".ply", ".obj", ".stl", ".glb"}, {options.points});
  if (options.adaptive && options.resolution)
    throw UsageError("--adaptive chooses the sizes of tetrahedra itself: leave --resolution out", {}, "--adaptive");
  if (!options.tetrahedra.empty())
    check_output(program, options.tetrahedra, {".vtk"}, {options.points, options.output});
  const Context context = program.context();
  if (std::filesystem::path(options.points).extension() == ".json") {
    if (options.parts || options.part_points)
      throw UsageError("--parts and --part-points are for surfaces that are fitted to points", {},
                       options.parts ? "--parts" : "--part-points");
    return run_document(program, options, context);
  }
  PointCloud cloud = load_points(program, options.points, {}, context);
  const Stopwatch watch;
  std::vector<std::string> warnings;
  complete_normals(program, cloud, options.neighbours, warnings, context);
  TetraQuadFitOptions fit;
  fit.resolution = options.resolution.value_or(32);
  fit.smoothness = options.smoothness;
  fit.closed = options.closed;
  fit.solver = static_cast<TetraQuadSolver>(solver);
  fit.split = split == 0 ? TetSplit::five : TetSplit::kuhn;
  TetraQuadFitReport report;
  TetraQuadErrorOptions error;
  error.max_error = options.max_error.value_or(0);
  error.quantile = options.quantile;
  if (options.resolution) error.finest = *options.resolution;
  error.coarsest = std::min(error.coarsest, error.finest);
  TetraQuadAdaptiveOptions budget;
  budget.coefficients = options.adaptive.value_or(budget.coefficients);
  budget.max_error = error.max_error;
  budget.quantile = error.quantile;
  TetraQuad surface = options.adaptive    ? fit_tetraquad_adaptive(cloud, budget, fit, &report, context)
                      : options.max_error ? fit_tetraquad_to(cloud, error, fit, &report, context)
                                          : fit_tetraquad(cloud, fit, &report, context);
  for (const std::string& warning : report.warnings) program.say("warning: " + warning);
  warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
  TetraQuadMeshNotes notes;
  TriangleMesh mesh = mesh_tetraquad(TetraQuadField(surface), {.tolerance = options.tolerance}, &notes, context);
  const bool as_model = std::filesystem::path(options.output).extension() == ".retalho";
  const nlohmann::ordered_json parts =
      leave_out_parts(program, options, cloud, as_model, surface, mesh, report, context);
  const MeshTopology topology = topology_of(mesh);
  const double seconds = watch.seconds();
  if (options.tolerance > 0 && notes.deviation > options.tolerance)
    program.say(
        fmt::format("warning: the triangles are within {:.3g} of the surface, not {:.3g}: 16 parts an edge are "
                    "the most",
                    notes.deviation, options.tolerance));
  if (topology.open_edges > 0)
    program.say(fmt::format("the surface is open: {} edges along {} borders", topology.open_edges, topology.borders));
  context.check();
  if (as_model)
    save_model(surface, options.output, program.overwrite);
  else
    write_mesh(mesh, options.output, program.overwrite);
  if (!options.tetrahedra.empty()) {
    std::vector<double> values;
    for (const Quadric& q : surface.quadrics) values.push_back(q[0] * surface.mesh.step);
    write_vtk(surface.mesh, values, options.tetrahedra, program.overwrite);
  }
  nlohmann::ordered_json json = {{"points", report.points},
                                 {"resolution", report.resolution},
                                 {"used", report.used},
                                 {"vertices", report.vertices},
                                 {"tetrahedra", report.tetrahedra},
                                 {"crossed", report.crossed},
                                 {"coefficients", report.coefficients},
                                 {"iterations", report.iterations},
                                 {"step", surface.mesh.step},
                                 {"components", topology.components},
                                 {"open_edges", topology.open_edges},
                                 {"borders", topology.borders},
                                 {"genus", topology.genus},
                                 {"residual_mean", report.residual_mean},
                                 {"residual_quantile", report.residual_quantile},
                                 {"residual_max", report.residual_max},
                                 {"quantile", options.quantile},
                                 {"outliers", report.outliers},
                                 {"triangles", mesh.triangles.size()},
                                 {"deviation", notes.deviation},
                                 {"bytes", std::filesystem::file_size(options.output)},
                                 {"seconds", seconds},
                                 {"warnings", warnings}};
  json.update(parts);
  if (program.json) return program.print(json);
  std::vector<std::pair<std::string, std::string>> lines;
  for (const auto& [key, value] : json.items())
    if (!value.is_array()) lines.emplace_back(key, value.is_number_float() ? number_text(value) : value.dump());
  program.print(list_text(lines));
}

}  // namespace

void add_reconstruct(CLI::App& root, Program& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(root, program, "reconstruct", "Points with normals to a smooth closed surface",
                                  "retalho reconstruct scan.ply -o surface.retalho\n"
                                  "retalho reconstruct scan.xyz --resolution 48 -o surface.glb --tolerance 0.01\n"
                                  "retalho reconstruct scan.ply --max-error 0.05 -o surface.ply\n"
                                  "retalho reconstruct noisy.ply --smoothness 10 -o surface.obj --json");
  command
      ->add_option("POINTS", options->points, "Points with normals: .ply, .xyz, .csv; or quadrics at vertices: .json")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", options->output, "The model (.retalho), or triangles: .ply, .obj, .stl, .glb")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("--resolution", options->resolution,
                   "Cubes along the longest side of the points' box (default 32; with --max-error: at most, 128)")
      ->type_name("N");
  command->add_option("--max-error", options->max_error, "Refine until the points are this near to the surface")
      ->type_name("E");
  command->add_option("--quantile", options->quantile, "The share of the points that --max-error means (default 0.99)")
      ->type_name("Q");
  command->add_option("--neighbours", options->neighbours, "For normals, where the points have none (default 16)")
      ->type_name("K");
  command
      ->add_option(
          "--adaptive", options->adaptive,
          "Smaller tetrahedra where the points ask for them, at most N coefficients; best with --smoothness 0.1")
      ->type_name("N");
  command->add_option("--smoothness", options->smoothness, "0.1 for clean points, 10 for noisy ones (default 1)")
      ->type_name("S");
  command
      ->add_option("--tolerance", options->tolerance,
                   "Largest distance of the triangles to the surface (default: three parts an edge)")
      ->type_name("T");
  command->add_option("--split", options->split, "Tetrahedra of a cube: five (default) or kuhn (six)")
      ->type_name("KIND");
  command
      ->add_option(
          "--fit", options->fit,
          "How: cholesky (default), cg (the same with less memory, slower), local (no equations: quick, rough)")
      ->type_name("HOW");
  command->add_option("--parts", options->parts, "Keeps the N parts of the surface with the most points near them")
      ->type_name("N");
  command->add_option("--part-points", options->part_points, "Keeps the parts with at least K points near them")
      ->type_name("K");
  command->add_flag("--closed", options->closed, "The shape is closed: close holes of any size");
  command->add_option("--tetrahedra", options->tetrahedra, "Writes the tetrahedra as well, for ParaView: .vtk")
      ->type_name("FILE");
  command->callback([options, &program] { run(program, *options); });
}

}  // namespace retalho::app
