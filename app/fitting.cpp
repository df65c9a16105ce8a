#include "fitting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inputs.h"
#include "retalho/core/error.h"

namespace retalho::app {
namespace {

constexpr double kDefaultShare = 0.01;  // of the height range, when no budget is given
constexpr std::size_t kLeastVertices = 3;

// In the order of the enumerations.
const std::vector<std::string> kSurfaces{"linear", "powell-sabin", "clough-tocher"};
const std::vector<std::string> kGradients{"normals", "quadratic", "network"};
const std::vector<std::string> kCrossDerivatives{"perpendicular", "cubic"};
const std::vector<std::string> kFits(kFitNames.begin(), kFitNames.end());
const std::vector<std::string> kRefinements{"flat", "surface"};
const std::vector<std::string> kFormats{"exact", "compact"};
const std::vector<std::string> kEfforts{"fast", "normal", "best"};
constexpr const char* kAuto = "auto";

}  // namespace

void add_budget_flags(CLI::App& command, BudgetFlags& flags) {
  command
      .add_option("--max-error", flags.max_error,
                  "Largest error, in height units (0: every cell): of the surface itself at every cell, with --refine "
                  "flat of the flat triangulation under it")
      ->type_name("E");
  command.add_option("--vertices", flags.vertices, "How many vertices; with --max-error: whichever comes first")
      ->type_name("N");
  command.add_option("--ratio", flags.ratio, "Vertices as a share of the valid cells: 1% or 0.01")->type_name("R");
}

Budget resolve(const Program& program, const BudgetFlags& flags, std::size_t valid_cells, double height_range) {
  Budget budget;
  if (flags.vertices && !flags.ratio.empty())
    throw UsageError("--vertices and --ratio say the same in two ways: give one of them", {}, "--ratio");
  if (flags.max_error) {
    if (!std::isfinite(*flags.max_error) || *flags.max_error < 0)
      throw UsageError(fmt::format("--max-error must be 0 or more, not {}", *flags.max_error), {}, "--max-error");
    budget.max_error = *flags.max_error;
    budget.tolerance = true;
  }
  if (flags.vertices) {
    if (*flags.vertices < kLeastVertices)
      throw UsageError(fmt::format("--vertices must be {} or more, not {}", kLeastVertices, *flags.vertices), {},
                       "--vertices");
    budget.vertices = *flags.vertices;
  }
  if (!flags.ratio.empty()) {
    const double wanted = parse_ratio("--ratio", flags.ratio) * static_cast<double>(valid_cells);
    budget.vertices = std::max(kLeastVertices, static_cast<std::size_t>(std::llround(wanted)));
  }
  if (!flags.given()) {
    budget.max_error = kDefaultShare * height_range;
    budget.tolerance = true;
    program.say(
        fmt::format("--max-error {:.6g}: 1 % of the height range (chosen, as none was given)", budget.max_error));
  }
  return budget;
}

void add_surface_flags(CLI::App& command, SurfaceFlags& flags) {
  command
      .add_option("--surface", flags.surface,
                  "linear, powell-sabin or clough-tocher (default); with --format compact also auto: the smallest file")
      ->type_name("KIND");
  command
      .add_option("--gradients", flags.gradients,
                  "At vertices: normals (default for grids), quadratic (default for points) or network")
      ->type_name("KIND");
  command
      .add_option("--cross-derivative", flags.cross_derivative,
                  "Clough-Tocher, across edges: perpendicular (default) or cubic")
      ->type_name("KIND");
  command
      .add_option(
          "--fit", flags.fit,
          "Grids, --refine flat: interpolate the vertices (default there), least-squares: heights and gradients "
          "fitted to every cell, or z-only: heights alone, with gradients that follow from them (also with --refine "
          "surface and --vertices or --ratio, on better vertices)")
      ->type_name("KIND");
  command
      .add_option(
          "--refine", flags.refine,
          "Grids: vertices chosen for the surface itself, with heights and gradients fitted to every cell (surface, "
          "the "
          "default of smooth surfaces without --gradients, --fit, --cross-derivative or --tiles), or for the flat "
          "triangulation (flat)")
      ->type_name("KIND");
  command
      .add_option(
          "--effort", flags.effort,
          "How long the vertices of --refine surface are moved about: fast (not at all), normal (default) or best; a "
          "million cells with a vertex for 3 % of them take 2 s, 40 s and 2 minutes on one core, fine tolerances "
          "longer")
      ->type_name("HOW");
  command
      .add_option("--format", flags.format,
                  "exact: every number as computed (default), or compact: refined by the surface, rounded within the "
                  "tolerance, a tenth of the bytes (grids; linear and clough-tocher)")
      ->type_name("FORM");
}

void add_crease_flags(CLI::App& command, SurfaceFlags& flags) {
  command
      .add_option(
          "--creases", flags.creases,
          "Grids, --vertices or --ratio: edges that the surface may fold along (ridges of roofs, kerbs, shores: a "
          "fold, no vertical wall): none (default), auto: in place of vertices, where that is nearer to the grid at as "
          "many numbers, or a vector layer with the lines. --format compact: auto (the default with --max-error) folds "
          "at vertices beside steps, none keeps the surface smooth")
      ->type_name("auto|none|FILE");
  command.add_option("--crease-layer", flags.crease_layer, "Of --creases FILE: which layer")->type_name("NAME");
}

CreaseKind resolve_creases(const SurfaceFlags& flags, const BudgetFlags& budget, bool from_points) {
  const bool none = flags.creases.empty() || flags.creases == "none";
  if (!flags.crease_layer.empty() && (none || flags.creases == kAuto))
    throw UsageError("--crease-layer goes with --creases FILE", {}, "--crease-layer");
  if (none || compact_format(flags)) return CreaseKind::none;  // compact_options judges for the compact form
  const auto refuse = [](const std::string& what, const char* where) {
    throw UsageError("--creases " + what, {}, where);
  };
  if (from_points) refuse("takes grids: --breaklines says where a surface of points folds", "--creases");
  if (budget.max_error || !budget.given())
    refuse("goes with a budget: give --vertices or --ratio, and no --max-error", "--creases");
  if (flags.surface == kSurfaces[0]) refuse("is for smooth surfaces: a flat one folds along every edge", "--surface");
  if (flags.fit == kFits[2]) refuse("has gradients of its own on each side: leave --fit z-only out", "--fit");
  if (!refines_surface(flags, budget, from_points)) refuse("goes with --refine surface", "--refine");
  return flags.creases == kAuto ? CreaseKind::chosen : CreaseKind::lines;
}

bool compact_format(const SurfaceFlags& flags) {
  const bool compact = choose("--format", flags.format, kFormats) == 1;
  if (!compact && flags.surface == kAuto)
    throw UsageError("--surface auto chooses by the size of the file: it needs --format compact", {}, "--surface");
  return compact;
}

std::vector<CompactOptions> compact_options(const SurfaceFlags& flags, bool from_points) {
  const Effort effort = resolve_effort(flags);
  const auto refuse = [](const std::string& what, const char* where) {
    throw UsageError("--format compact " + what, {}, where);
  };
  if (from_points) refuse("takes grids: its vertices are their cells", "--format");
  if (!flags.gradients.empty()) refuse("fits the gradients: leave --gradients out", "--gradients");
  if (flags.cross_derivative != kCrossDerivatives[0])
    refuse("takes --cross-derivative perpendicular", "--cross-derivative");
  if (!flags.refine.empty()) choose("--refine", flags.refine, kRefinements);
  const bool z_only = resolve_fit(flags, from_points) == FitKind::z_only;
  std::optional<bool> folds;
  if (!flags.crease_layer.empty() || (!flags.creases.empty() && flags.creases != "none" && flags.creases != kAuto))
    refuse("folds at vertices that it chooses: give --creases auto or none", "--creases");
  if (!flags.creases.empty()) folds = flags.creases == kAuto;
  if (flags.surface == kAuto)
    return {{.surface = SurfaceKind::clough_tocher, .folds = folds, .effort = effort},
            {.surface = SurfaceKind::linear, .effort = effort}};
  const auto kind = static_cast<SurfaceKind>(choose("--surface", flags.surface, kSurfaces) + 1);
  if (kind == SurfaceKind::powell_sabin) refuse("holds linear and clough-tocher surfaces", "--surface");
  if (z_only && kind == SurfaceKind::linear) refuse("--fit z-only is for clough-tocher", "--fit");
  if (folds.value_or(false) && (z_only || kind == SurfaceKind::linear))
    refuse("folds vertices that have gradients: --creases auto is for --surface clough-tocher", "--creases");
  return {{.surface = kind, .heights_only = z_only, .folds = folds, .effort = effort}};
}

SurfaceOptions resolve(const SurfaceFlags& flags, bool from_points) {
  SurfaceOptions options;
  const std::string gradients = !flags.gradients.empty() ? flags.gradients : from_points ? "quadratic" : "normals";
  options.surface = static_cast<SurfaceKind>(choose("--surface", flags.surface, kSurfaces) + 1);
  options.gradients = static_cast<GradientKind>(choose("--gradients", gradients, kGradients) + 1);
  options.cross_derivative =
      static_cast<CrossDerivative>(choose("--cross-derivative", flags.cross_derivative, kCrossDerivatives));
  return options;
}

FitKind resolve_fit(const SurfaceFlags& flags, bool from_points) {
  const auto fit = static_cast<FitKind>(choose("--fit", flags.fit.empty() ? kFits[0] : flags.fit, kFits));
  if (fit == FitKind::interpolate) return fit;
  if (from_points) throw UsageError("--fit " + flags.fit + " takes grids: survey points are interpolated", {}, "--fit");
  if (!flags.gradients.empty())
    throw UsageError(fmt::format("--gradients and --fit {} exclude each other: the fit sets the gradients", flags.fit),
                     {}, "--gradients");
  if (flags.cross_derivative != kCrossDerivatives[0])
    throw UsageError("--fit " + flags.fit + " takes --cross-derivative perpendicular", {}, "--cross-derivative");
  return fit;
}

bool refines_surface(const SurfaceFlags& flags, const BudgetFlags& budget, bool from_points) {
  const bool exact = budget.max_error == 0.0;  // every cell: there is nothing to choose
  if (flags.refine.empty() && flags.effort.empty()) {
    return !from_points && !exact && flags.surface != kSurfaces[0] && flags.gradients.empty() &&
           flags.cross_derivative == kCrossDerivatives[0] && flags.fit.empty();
  }
  const char* what = flags.refine.empty() ? "--effort" : "--refine surface";
  if (!flags.refine.empty() && choose("--refine", flags.refine, kRefinements) == 0) {
    if (!flags.effort.empty())
      throw UsageError("--effort moves the vertices of a surface: --refine flat has none to move", {}, "--effort");
    return false;
  }
  if (from_points) throw UsageError(fmt::format("{} takes grids", what), {}, "--refine");
  SurfaceFlags fitted = flags;
  if (flags.fit != kFits[2])
    fitted.fit = kFits[1];
  else if (!budget.given())
    throw UsageError("--fit z-only --refine surface takes a number of vertices: give --vertices or --ratio", {},
                     "--fit");
  resolve_fit(fitted, from_points);
  if (exact) throw UsageError(fmt::format("{} takes a --max-error over 0", what), {}, "--max-error");
  return true;
}

Effort resolve_effort(const SurfaceFlags& flags) {
  return flags.effort.empty() ? Effort::normal : static_cast<Effort>(choose("--effort", flags.effort, kEfforts));
}

nlohmann::ordered_json to_json(const ModelReport& report) {
  nlohmann::ordered_json json = {{"surface", report.surface}, {"gradients", report.gradients}};
  if (!report.cross_derivative.empty()) json["cross_derivative"] = report.cross_derivative;
  const ErrorReport& e = report.errors;
  json["vertices"] = report.vertices;
  json["triangles"] = report.triangles;
  json["coefficients"] = report.coefficients;
  json["numbers"] = report.numbers;
  json["bytes"] = report.bytes;
  json["rmse"] = e.rmse;
  json["max_error"] = e.max_error;
  json["max_error_at"] = {e.max_error_at.x, e.max_error_at.y};
  json["slope_rmse"] = report.has_slope ? nlohmann::ordered_json(e.slope_rmse) : nlohmann::ordered_json(nullptr);
  json["cells"] = e.cells;
  json["valid_cells"] = e.valid_cells;
  json["uncovered"] = e.uncovered;
  json["violations"] = e.violations;
  return json;
}

void say_violations(const Program& program, const ModelReport& report) {
  const ErrorReport& e = report.errors;
  if (e.uncovered > 0)
    program.say(fmt::format("warning: the model has no data at {} of {} valid cells", e.uncovered, e.valid_cells));
  if (e.violations == 0) return;
  if (report.surface == kSurfaces[0] || report.refined)
    program.say(fmt::format("warning: {} of {} valid cells are over the tolerance {:.6g} (largest error {:.6g})",
                            e.violations, e.valid_cells, report.tolerance, e.max_error));
  else
    program.say(
        fmt::format("the tolerance {:.6g} holds for the flat triangulation; this smooth surface over it passes "
                    "the tolerance at {} of {} valid cells (largest error {:.6g})",
                    report.tolerance, e.violations, e.valid_cells, e.max_error));
}

}  // namespace retalho::app
