// What `fit` and `compare` share: the options for budgets and surfaces, and one model's report as JSON and as words.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "program.h"
#include "retalho/model/compact.h"
#include "retalho/model/comparison.h"
#include "retalho/raster/raster.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/report.h"
#include "retalho/terrain/surface_refine.h"

namespace retalho::app {

/// How fine a triangulation is asked for.
struct BudgetFlags {
  std::optional<double> max_error;
  std::optional<std::size_t> vertices;
  std::string ratio;

  bool given() const { return max_error || vertices || !ratio.empty(); }
};
void add_budget_flags(CLI::App& command, BudgetFlags& flags);

struct Budget {
  double max_error = 0;      ///< 0 with vertices == 0: every cell
  std::size_t vertices = 0;  ///< 0: no budget
  bool tolerance = false;    ///< whether max_error was asked for (or chosen) and is to be judged
};
/// Throws UsageError for contradictions and values out of range. Nothing given: 1 % of the height range, said.
Budget resolve(const Program& program, const BudgetFlags& flags, std::size_t valid_cells, double height_range);

/// Which surface, as words.
struct SurfaceFlags {
  std::string surface = "clough-tocher";
  std::string gradients = {};  ///< empty: normals for grids, quadratic for points
  std::string cross_derivative = "perpendicular";
  std::string fit = {};     ///< empty: interpolate, where the vertices are not refined by the surface
  std::string refine = {};  ///< empty: surface for a smooth surface of a grid whose gradients are not asked for
  std::string effort = {};  ///< empty: normal
  std::string format = "exact";
  std::string creases = {}, crease_layer = {};  ///< of fit alone; empty: none
};
void add_surface_flags(CLI::App& command, SurfaceFlags& flags);
/// Gradients that are not asked for: the vertices of a refined grid are its peaks and pits, where fitted gradients
/// overshoot and the triangles' normals do not; survey points are not chosen so, and there quadratic is far better.
/// Throws UsageError with the choices.
SurfaceOptions resolve(const SurfaceFlags& flags, bool from_points);

/// --fit: how the vertices get their data. Throws UsageError with the choices, and for what does not go together.
FitKind resolve_fit(const SurfaceFlags& flags, bool from_points);
/// Are the vertices chosen by the surface's own error (--refine surface, or nothing that speaks against it)? Throws as
/// resolve_fit.
bool refines_surface(const SurfaceFlags& flags, const BudgetFlags& budget, bool from_points);
/// --effort: how long they are moved about.
Effort resolve_effort(const SurfaceFlags& flags);
/// --creases: none, chosen by the fit, or along the lines of a file. Throws UsageError for what does not go together.
enum class CreaseKind : std::uint8_t { none, chosen, lines };
void add_crease_flags(CLI::App& command, SurfaceFlags& flags);
CreaseKind resolve_creases(const SurfaceFlags& flags, const BudgetFlags& budget, bool from_points);
/// --format compact: numbers rounded, the fit knows of it (model/compact.h).
bool compact_format(const SurfaceFlags& flags);
/// Which surfaces a compact file may hold: --surface auto gives several, of which the smallest file counts. Throws
/// UsageError for what does not go together.
std::vector<CompactOptions> compact_options(const SurfaceFlags& flags, bool from_points);

/// The keys of docs/cli.md, in its order.
nlohmann::ordered_json to_json(const ModelReport& report);

/// Says on standard error what the report's `violations` and `uncovered` mean, if there are any.
void say_violations(const Program& program, const ModelReport& report);

}  // namespace retalho::app
