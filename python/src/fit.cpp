// retalho.fit and retalho.fit_points: what `retalho fit` does, on arrays.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "budget.h"
#include "grid.h"
#include "retalho/core/error.h"
#include "retalho/raster/gdal.h"
#include "retalho/terrain/crease_lines.h"
#include "retalho/terrain/fit.h"
#include "retalho/terrain/least_squares.h"
#include "retalho/terrain/surface_refine.h"
#include "retalho/tin/breaklines.h"
#include "retalho/tin/refine.h"
#include "retalho/tin/scattered.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

/// The options as Python gives them.
struct Asked : AskedBudget {
  std::string surface = "clough-tocher", cross_derivative = "perpendicular";
  std::optional<std::string> fit, refine, effort;  // none: as the program chooses
  std::optional<std::string> gradients;
  bool chosen_creases = false;                       // creases='auto'
  std::vector<std::vector<Vec2>> crease_lines = {};  // in the CRS

  bool creases() const { return chosen_creases || !crease_lines.empty(); }
};

/// One of `choices`, or an error that lists them.
std::string choose(const std::string& name, const std::string& word, std::initializer_list<const char*> choices) {
  std::string list;
  for (const char* choice : choices) {
    if (word == choice) return word;
    list += (list.empty() ? "'" : ", '") + std::string(choice) + "'";
  }
  throw UsageError(fmt::format("{} must be one of {}, not '{}'", name, list, word), {}, name);
}

SurfaceOptions surface_options(const Asked& asked, bool points) {
  SurfaceOptions options;
  options.surface = *parse_surface(choose("surface", asked.surface, {"linear", "powell-sabin", "clough-tocher"}));
  options.gradients = *parse_gradients(choose("gradients", asked.gradients.value_or(points ? "quadratic" : "normals"),
                                              {"normals", "quadratic", "network"}));
  options.cross_derivative =
      *parse_cross_derivative(choose("cross_derivative", asked.cross_derivative, {"perpendicular", "cubic"}));
  return options;
}

/// Are the vertices chosen by the surface's own error? As the program does: for a smooth surface, unless something that
/// is asked for speaks against it.
bool refines_surface(const Asked& asked) {
  if (asked.refine) return *asked.refine == "surface";
  return asked.effort || (asked.max_error != 0.0 && asked.surface != "linear" && !asked.gradients && !asked.fit &&
                          asked.cross_derivative == "perpendicular");
}

/// Throws UsageError for what does not go together.
void check_fit(const Asked& asked) {
  const std::string fit = choose("fit", asked.fit.value_or("interpolate"), {"interpolate", "least-squares", "z-only"});
  if (asked.refine) choose("refine", *asked.refine, {"flat", "surface"});
  if (asked.effort) choose("effort", *asked.effort, {"fast", "normal", "best"});
  const bool refined = refines_surface(asked);
  if (asked.effort && !refined)
    throw UsageError("effort moves the vertices of a surface: refine='flat' has none to move", {}, "effort");
  if (asked.creases()) {
    if (asked.max_error || !asked.given())
      throw UsageError("creases go with a budget: give vertices or ratio, and no max_error", {}, "creases");
    if (asked.surface == "linear")
      throw UsageError("creases are for smooth surfaces: a flat one folds along every edge", {}, "surface");
    if (fit == "z-only")
      throw UsageError("creases have gradients of their own on each side: leave fit='z-only' out", {}, "fit");
    if (!refined) throw UsageError("creases go with refine='surface'", {}, "refine");
  }
  if (fit == "interpolate" && !refined) return;
  if (asked.gradients)
    throw UsageError("gradients exclude fit='least-squares', fit='z-only' and refine='surface', which set them", {},
                     "gradients");
  if (asked.cross_derivative != "perpendicular")
    throw UsageError("a least-squares fit takes cross_derivative='perpendicular'", {}, "cross_derivative");
  if (refined && asked.max_error == 0.0) throw UsageError("refine='surface' takes a max_error over 0", {}, "max_error");
}

Terrain fit_raster(const Raster& raster, const Asked& asked, const SurfaceOptions& surface, const Context& context) {
  const RasterSummary summary = summarize(raster);
  const Budget budget = resolve(asked, summary.valid, summary.valid > 0 ? summary.maximum - summary.minimum : 0);
  Terrain terrain;
  const std::string fit = asked.fit.value_or("interpolate");
  if (refines_surface(asked) && (budget.max_error > 0 || budget.vertices > 0)) {
    const std::string effort = asked.effort.value_or("normal");
    const SurfaceRefineOptions how = with_effort({.surface = surface.surface,
                                                  .max_error = budget.max_error,
                                                  .vertices = budget.vertices,
                                                  .heights_only = fit == "z-only",
                                                  .creases = asked.chosen_creases},
                                                 effort == "fast"   ? Effort::fast
                                                 : effort == "best" ? Effort::best
                                                                    : Effort::normal);
    if (asked.crease_lines.empty()) {
      terrain = refine_surface(raster, how, context);
    } else {
      std::vector<std::vector<Vec2>> lines = asked.crease_lines;
      for (std::vector<Vec2>& line : lines)
        for (Vec2& p : line) p = raster.georef.to_local(p);
      terrain = refine_along_lines(raster, lines, how, nullptr, context);
    }
  } else {
    const FitKind kind = fit == "z-only"          ? FitKind::z_only
                         : fit == "least-squares" ? FitKind::least_squares
                                                  : FitKind::interpolate;
    terrain =
        make_fitted(refine_tin(raster, {budget.max_error, budget.vertices}, context), raster, surface, kind, context);
  }
  terrain.tolerance = budget.max_error;
  return terrain;
}

/// Local coordinates of points far out (as read_points has them), or of degrees.
std::vector<Vec3> localize(std::vector<Vec3> points, const std::string& crs, Georef& georef) {
  if (points.empty()) throw BadInput("there are no points", {}, "points");
  Vec2 low{points[0].x, points[0].y}, high = low;
  for (const Vec3& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw BadInput(fmt::format("points holds a coordinate that is not finite: ({}, {}, {})", p.x, p.y, p.z), {},
                     "points");
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  std::vector<std::string> remarks;
  if (!crs.empty()) describe_crs_text(crs, (low.y + high.y) / 2, georef, remarks);
  const double size = std::max(high.x - low.x, high.y - low.y);
  const double far = std::max({std::abs(low.x), std::abs(low.y), std::abs(high.x), std::abs(high.y)});
  if (far > 1000 * size && !georef.geographic) {
    georef.origin_x = std::round((low.x + high.x) / 2);
    georef.origin_y = std::round((low.y + high.y) / 2);
  }
  for (Vec3& p : points) {
    const Vec2 local = georef.to_local({p.x, p.y});
    p = {local.x, local.y, p.z};
  }
  return points;
}

using Lines = std::vector<std::vector<Vec3>>;

/// Lines of shape (n, 2) - without heights: NaN - or (n, 3).
Lines lines_of(const py::object& given, const char* name) {
  Lines lines;
  if (given.is_none()) return lines;
  for (const py::handle line : given) {
    int dimension = 0;
    std::vector<Vec3> places = as_points(py::reinterpret_borrow<py::object>(line), name, dimension);
    if (dimension == 2)
      for (Vec3& p : places) p.z = std::numeric_limits<double>::quiet_NaN();
    lines.push_back(std::move(places));
  }
  return lines;
}

/// creases: None, 'auto', or lines whose heights, if any, do not count.
void take_creases(const py::object& creases, Asked& asked) {
  if (py::isinstance<py::str>(creases)) {
    asked.chosen_creases = choose("creases", creases.cast<std::string>(), {"none", "auto"}) == "auto";
    return;
  }
  for (const std::vector<Vec3>& line : lines_of(creases, "creases")) {
    std::vector<Vec2>& flat = asked.crease_lines.emplace_back();
    for (const Vec3& p : line) flat.push_back({p.x, p.y});
  }
}

Terrain fit_cloud(const std::vector<Vec3>& points, Lines lines, const Georef& georef, const Asked& asked,
                  SurfaceOptions surface, const Context& context) {
  Tin tin;
  double tolerance = 0;
  if (asked.given()) {
    const auto [low, high] =
        std::minmax_element(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) { return a.z < b.z; });
    const Budget budget = resolve(asked, points.size(), high->z - low->z);
    tolerance = budget.max_error;
    tin = refine_points(points, {budget.max_error, budget.vertices}, nullptr, context);
  } else if (!lines.empty()) {
    const double spacing = mean_spacing(points);
    for (std::vector<Vec3>& line : lines) {
      for (Vec3& p : line) {
        const Vec2 local = georef.to_local({p.x, p.y});
        p = {local.x, local.y, p.z};
      }
      if (spacing > 0) line = with_steps(line, spacing);
    }
    ConstrainedTin made = triangulate_points(points, lines, nullptr, nullptr, context);
    tin = std::move(made.tin);
    surface.creases = std::move(made.edges);
  } else {
    tin = triangulate_points(points, nullptr, context);
  }
  Terrain terrain = make_terrain(std::move(tin), georef, surface, context);
  terrain.tolerance = tolerance;
  return terrain;
}

}  // namespace

void add_fit(py::module_& module) {
  module.def(
      "fit",
      [](const py::object& z, const py::object& transform, const py::object& crs, const py::object& nodata,
         std::optional<double> max_error, std::optional<long long> vertices, std::optional<double> ratio,
         const std::string& surface, std::optional<std::string> gradients, const std::string& cross_derivative,
         std::optional<std::string> fit, std::optional<std::string> refine, std::optional<std::string> effort,
         const py::object& creases, int threads, const py::object& progress) {
        Asked asked{{max_error, ratio, vertices},
                    surface,
                    cross_derivative,
                    std::move(fit),
                    std::move(refine),
                    std::move(effort),
                    std::move(gradients)};
        take_creases(creases, asked);
        const SurfaceOptions options = surface_options(asked, false);
        check_fit(asked);
        resolve(asked, 1, 1);  // bad options are told before the grid is read
        const Running running{threads, progress};
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        return std::make_shared<TerrainModel>(
            run(running, [&](const Context& context) { return fit_raster(*raster, asked, options, context); }));
      },
      py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("max_error") = py::none(), py::arg("vertices") = py::none(),
      py::arg("ratio") = py::none(), py::arg("surface") = "clough-tocher", py::arg("gradients") = py::none(),
      py::arg("cross_derivative") = "perpendicular", py::arg("fit") = py::none(), py::arg("refine") = py::none(),
      py::arg("effort") = py::none(), py::arg("creases") = py::none(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "An elevation grid to a terrain model.\n\n"
      "z: heights of shape (rows, columns), rows from north (array-like, masked array, DataArray, Grid or path); NaN "
      "and masked cells hold no data. max_error: largest error of the surface at any valid cell, height "
      "units (refine='flat': of the flat triangulation under it); vertices, ratio: a budget instead, or whichever "
      "comes first; "
      "none of them: 1 % of the height range. surface: linear, powell-sabin or clough-tocher. gradients: normals, "
      "quadratic or network. fit: interpolate, least-squares or z-only. refine: surface (the vertices are chosen by "
      "the "
      "surface's own error and everything is fitted: what a smooth surface gets without gradients, fit or "
      "cross_derivative) or flat. effort: fast, normal (default) or best, how long vertices are moved about. creases: "
      "edges that the surface may fold along, with vertices or ratio: auto (in place of vertices, where that is "
      "nearer), or lines of shape (n, 2) in the CRS. Raises "
      "BadInput (a ValueError) for grids without area, UsageError (a ValueError) for options. About 40 us a cell, 5 "
      "with effort='fast', 0.5 with refine='flat'.");
  module.def(
      "fit_points",
      [](const py::object& points, const py::object& crs, std::optional<double> max_error,
         std::optional<long long> vertices, std::optional<double> ratio, const std::string& surface,
         std::optional<std::string> gradients, const std::string& cross_derivative, const py::object& breaklines,
         int threads, const py::object& progress) {
        Asked asked;
        asked.max_error = max_error;
        asked.vertices = vertices;
        asked.ratio = ratio;
        asked.surface = surface;
        asked.gradients = std::move(gradients);
        asked.cross_derivative = cross_derivative;
        const SurfaceOptions options = surface_options(asked, true);
        resolve(asked, 1, 1);
        Lines lines = lines_of(breaklines, "breaklines");
        if (!lines.empty() && asked.given())
          throw UsageError("breaklines keep every point: leave max_error, vertices and ratio out", {}, "breaklines");
        Georef georef;
        const std::vector<Vec3> local = localize(as_points3(points, "points"), crs_text(crs), georef);
        return std::make_shared<TerrainModel>(run(Running{threads, progress}, [&](const Context& context) {
          return fit_cloud(local, std::move(lines), georef, asked, options, context);
        }));
      },
      py::arg("points"), py::kw_only(), py::arg("crs") = py::none(), py::arg("max_error") = py::none(),
      py::arg("vertices") = py::none(), py::arg("ratio") = py::none(), py::arg("surface") = "clough-tocher",
      py::arg("gradients") = py::none(), py::arg("cross_derivative") = "perpendicular",
      py::arg("breaklines") = py::none(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "Survey points of shape (n, 3) - x, y in the CRS and height - to a terrain model on their Delaunay "
      "triangulation.\n\nEvery point becomes a vertex, unless max_error, vertices or ratio keep fewer. Points that "
      "repeat an (x, y) become one vertex with the mean height. gradients: quadratic (default), normals or network. "
      "breaklines: lines that triangles keep to and that the surface may fold along, each of shape (n, 3), or (n, 2) "
      "without heights (they lie on the flat surface of the points).");
}

}  // namespace retalho::python
