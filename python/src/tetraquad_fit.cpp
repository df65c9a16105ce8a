// TetraQuad.fit, and what is asked of points before and of the surface's parts after it.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "model.h"
#include "retalho/cloud/normals.h"
#include "retalho/core/error.h"
#include "retalho/mesh/surface_parts.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "retalho/tetraquad/adaptive.h"
#include "retalho/tetraquad/document.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/without.h"
#include "running.h"
#include "tetraquad.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

using Holder = std::shared_ptr<TetraQuadModel>;

/// What a fit gives: the surface and its report.
struct Fitted {
  TetraQuad surface;
  TetraQuadFitReport report;
};

struct Asked {
  std::optional<int> resolution;
  int neighbours = 16;
  double smoothness = 1, quantile = 0.99;
  std::optional<double> max_error;
  std::optional<std::size_t> adaptive, parts, part_points;
  std::string split = "five", solver = "cholesky";
  bool closed = false;
};

TetraQuadSolver parse_solver(const std::string& name) {
  if (name == "cholesky") return TetraQuadSolver::cholesky;
  if (name == "cg") return TetraQuadSolver::cg;
  if (name == "local") return TetraQuadSolver::local;
  throw UsageError("solver must be 'cholesky', 'cg' or 'local', not '" + name + "'", {}, "solver");
}

/// Leaves out the parts of the surface that are not asked for. Those that cannot be parted from others stay, which is
/// a warning.
void leave_out_parts(Fitted& fitted, const PointCloud& cloud, const Asked& asked, const Context& context) {
  PartChoice choice;
  choice.most = asked.parts.value_or(choice.most);
  choice.points = asked.part_points.value_or(0);
  const TetraQuadField field(fitted.surface);
  const TriangleMesh mesh = mesh_tetraquad(field, {}, nullptr, context);
  const SurfaceParts found = find_parts(mesh, field, cloud, context);
  std::vector<char> keep = choose_parts(found, choice);
  const auto unwanted = std::count(keep.begin(), keep.end(), 0);
  if (unwanted == 0) return;
  TetraQuad kept = without_tetrahedra(fitted.surface, tetrahedra_left_out(mesh, field, found, keep), &fitted.report);
  const auto left_out = std::count(keep.begin(), keep.end(), 0);
  if (left_out < unwanted)
    fitted.report.warnings.push_back(
        fmt::format("{} parts share tetrahedra with parts that stay, and stay, too", unwanted - left_out));
  fitted.surface = std::move(kept);
}

Fitted fit_cloud(PointCloud cloud, const Asked& asked, const Context& context) {
  if (cloud.normals.empty())
    cloud.normals = estimate_normals(cloud.positions, {.neighbours = asked.neighbours}, nullptr, context);
  TetraQuadFitOptions options;
  options.resolution = asked.resolution.value_or(options.resolution);
  options.smoothness = asked.smoothness;
  options.split = asked.split == "kuhn" ? TetSplit::kuhn : TetSplit::five;
  options.solver = parse_solver(asked.solver);
  options.closed = asked.closed;
  Fitted fitted;
  if (asked.adaptive) {
    TetraQuadAdaptiveOptions budget;
    budget.coefficients = *asked.adaptive;
    budget.max_error = asked.max_error.value_or(0);
    budget.quantile = asked.quantile;
    fitted.surface = fit_tetraquad_adaptive(cloud, budget, options, &fitted.report, context);
  } else if (asked.max_error) {
    TetraQuadErrorOptions error;
    error.max_error = *asked.max_error;
    error.quantile = asked.quantile;
    error.finest = asked.resolution.value_or(error.finest);
    error.coarsest = std::min(error.coarsest, error.finest);
    fitted.surface = fit_tetraquad_to(cloud, error, options, &fitted.report, context);
  } else {
    fitted.surface = fit_tetraquad(cloud, options, &fitted.report, context);
  }
  if (asked.parts || asked.part_points) leave_out_parts(fitted, cloud, asked, context);
  return fitted;
}

/// Throws UsageError for what does not go together.
void check(const Asked& asked) {
  if (asked.split != "five" && asked.split != "kuhn")
    throw UsageError("split must be 'five' or 'kuhn', not '" + asked.split + "'", {}, "split");
  parse_solver(asked.solver);
  if (asked.adaptive && asked.resolution)
    throw UsageError("adaptive chooses the sizes of tetrahedra itself: leave resolution out", {}, "resolution");
  if (asked.parts && *asked.parts == 0) throw UsageError("parts must be 1 or more", {}, "parts");
}

Holder fit(const py::object& points, const py::object& normals, const Asked& asked, const Running& running) {
  check(asked);
  PointCloud cloud;
  cloud.positions = as_points3(points, "points");
  if (!normals.is_none()) {
    cloud.normals = as_points3(normals, "normals");
    if (cloud.normals.size() != cloud.positions.size())
      throw BadInput(fmt::format("normals must have the shape of points, ({}, 3), not ({}, 3)", cloud.positions.size(),
                                 cloud.normals.size()),
                     {}, "normals");
  }
  Fitted fitted = run(running, [&](const Context& context) { return fit_cloud(std::move(cloud), asked, context); });
  const py::module_ warnings = py::module_::import("warnings");
  for (const std::string& words : fitted.report.warnings) warnings.attr("warn")(words, py::arg("stacklevel") = 2);
  return std::make_shared<TetraQuadModel>(std::move(fitted.surface), std::move(fitted.report));
}

py::object report_of(const TetraQuadModel& model) {
  if (!model.report()) return py::none();
  const TetraQuadFitReport& r = *model.report();
  py::dict d;
  d["points"] = r.points;
  d["used"] = r.used;
  d["resolution"] = r.resolution;
  d["coefficients"] = r.coefficients;
  d["crossed"] = r.crossed;
  d["residual_mean"] = r.residual_mean;
  d["residual_quantile"] = r.residual_quantile;
  d["residual_max"] = r.residual_max;
  d["outliers"] = r.outliers;
  d["open_faces"] = r.open_faces;
  return d;
}

py::list parts_of(const TetraQuadModel& model, const py::object& points, const Running& running) {
  PointCloud cloud;
  cloud.positions = as_points3(points, "points");
  TriangleMesh mesh;
  const SurfaceParts found = run(running, [&](const Context& context) {
    mesh = mesh_tetraquad(model.field(), {}, nullptr, context);
    return find_parts(mesh, model.field(), cloud, context);
  });
  py::list list;
  for (const SurfacePart& part : found.parts) {
    const Vec3 low = part.low + mesh.offset, high = part.high + mesh.offset;
    py::dict d;
    d["points"] = part.points;
    d["triangles"] = part.triangles;
    d["area"] = part.area;
    d["low"] = py::make_tuple(low.x, low.y, low.z);
    d["high"] = py::make_tuple(high.x, high.y, high.z);
    list.append(d);
  }
  return list;
}

py::array normals_of(const py::object& points, int neighbours, const Running& running) {
  const std::vector<Vec3> positions = as_points3(points, "points");
  std::vector<Vec3> normals = run(running, [&](const Context& context) {
    return estimate_normals(positions, {.neighbours = neighbours}, nullptr, context);
  });
  const Shape shape{count_of(normals.size()), 3};
  return own<double>(std::move(normals), shape);
}

}  // namespace

void add_tetraquad_fit(py::module_& module) {
  auto tetraquad = py::reinterpret_borrow<py::class_<TetraQuadModel, Holder>>(module.attr("TetraQuad"));
  tetraquad.def_static(
      "fit",
      [](const py::object& points, const py::object& normals, std::optional<int> resolution, double smoothness,
         std::optional<double> max_error, double quantile, std::optional<std::size_t> adaptive,
         const std::string& split, const std::string& solver, bool closed, int neighbours,
         std::optional<std::size_t> parts, std::optional<std::size_t> part_points, int threads,
         const py::object& progress) {
        Asked asked;
        asked.resolution = resolution;
        asked.smoothness = smoothness;
        asked.max_error = max_error;
        asked.quantile = quantile;
        asked.adaptive = adaptive;
        asked.split = split;
        asked.solver = solver;
        asked.closed = closed;
        asked.neighbours = neighbours;
        asked.parts = parts;
        asked.part_points = part_points;
        return fit(points, normals, asked, {threads, progress});
      },
      py::arg("points"), py::arg("normals") = py::none(), py::kw_only(), py::arg("resolution") = py::none(),
      py::arg("smoothness") = 1.0, py::arg("max_error") = py::none(), py::arg("quantile") = 0.99,
      py::arg("adaptive") = py::none(), py::arg("split") = "five", py::arg("solver") = "cholesky",
      py::arg("closed") = false, py::arg("neighbours") = 16, py::arg("parts") = py::none(),
      py::arg("part_points") = py::none(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "Points (n, 3) with outward normals (n, 3; None: estimated from so many neighbours) to a surface.\n\n"
      "resolution: cubes along the longest side (None: 32; with max_error at most so many, 128). max_error: the "
      "coarsest resolution at which `quantile` of the points are that near, instead. adaptive: at most so many "
      "coefficients, smaller tetrahedra where the points ask for them. smoothness: 0.1 for clean points, 10 for noisy "
      "ones. solver: 'cholesky'; 'cg' needs less memory and more time; 'local' solves nothing, fast and rough. closed: "
      "the shape is known to be closed, so holes of any size are closed. parts: keep so many, those with the most "
      "points near them; part_points: keep those with at least so many. What is doubtful is a warning. "
      "40,000 points at 24: about 2 s.");
  tetraquad.def_property_readonly(
      "report", &report_of,
      "How the fit went: points, used, resolution, coefficients, crossed (tetrahedra), residual_mean, "
      "residual_quantile, residual_max (lengths), outliers, open_faces. None: the surface was loaded.");
  tetraquad.def(
      "parts",
      [](const TetraQuadModel& m, const py::object& points, int threads, const py::object& progress) {
        return parts_of(m, points, {threads, progress});
      },
      py::arg("points"), py::kw_only(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The pieces that do not hang together, those with the most of `points` (n, 3) near them first: one dict each, "
      "points, triangles, area, low and high (corners of its box).");
  tetraquad.def(
      "write_tetrahedra",
      [](const TetraQuadModel& m, const py::object& path, bool overwrite) {
        const std::string name = path_text(path);
        run(Running{}, [&](const Context&) {
          const TetraQuad& surface = m.surface();
          std::vector<double> values;
          values.reserve(surface.quadrics.size());
          for (const Quadric& q : surface.quadrics) values.push_back(q[0] * surface.mesh.step);
          write_vtk(surface.mesh, values, name, overwrite);
        });
      },
      py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
      "The tetrahedra with the function's values at their vertices, for ParaView: .vtk. Raises CannotWrite.");
  module.def(
      "estimate_normals",
      [](const py::object& points, int neighbours, int threads, const py::object& progress) {
        return normals_of(points, neighbours, {threads, progress});
      },
      py::arg("points"), py::kw_only(), py::arg("neighbours") = 16, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Unit normals (n, 3) of points (n, 3), outwards: by the plane through so many neighbours, each connected part "
      "turned by its outermost points; zeros where there is no plane. About 8 us a point.");
  module.def(
      "read_quadrics",
      [](const py::object& path) {
        const std::string name = path_text(path);
        return run(Running{}, [&](const Context&) { return std::make_shared<TetraQuadModel>(read_quadrics(name)); });
      },
      py::arg("path"),
      "A TetraQuad written by hand: quadrics at the vertices of a few tetrahedra, JSON (docs/tetraquad.md). Raises "
      "CannotRead, BadInput with the key.");
}

}  // namespace retalho::python
