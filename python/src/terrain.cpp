#include "terrain.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <vector>

#include "arrays.h"
#include "model.h"
#include "quantity.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/render/field.h"
#include "retalho/terrain/point_report.h"
#include "retalho/terrain/report.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

constexpr std::size_t kFew = 256;  // points
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool finite(Vec2 p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

std::vector<double> values_at(const TerrainModel& model, const Pair& xy, What what, const Context& context) {
  const TerrainEvaluator& evaluator = model.evaluator(context);
  const Georef& georef = model.terrain().georef;
  const auto width = static_cast<std::size_t>(kQuantities[what].width);
  std::vector<double> out(xy.size() * width, kNan);
  if (what == height) {
    std::vector<Vec2> points(xy.size());
    bool all = true;
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = georef.to_local(xy.at(i));
      all = all && finite(points[i]);
    }
    if (all) {
      evaluator.values(points, out, context);
      return out;
    }
  }
  parallel_chunks(xy.size(), 4096, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2 p = georef.to_local(xy.at(i));
      if (!finite(p)) continue;
      if (const std::optional<Jet> jet = evaluator.jet(p)) put(what, *jet, out.data() + i * width);
    }
  });
  return out;
}

py::object ask(const TerrainModel& model, const py::object& x, const py::object& y, What what, int threads) {
  const Pair xy = broadcast(x, y, "x and y");
  std::vector<double> values;
  if (xy.size() <= kFew && threads >= 0) {  // a thread of its own would cost more than the answer
    const py::gil_scoped_release released;
    values = values_at(model, xy, what, Context{.threads = 1});
  } else {
    values = run(Running{threads}, [&](const Context& context) { return values_at(model, xy, what, context); });
  }
  Shape shape = xy.shape;
  if (kQuantities[what].width > 1) shape.push_back(kQuantities[what].width);
  return shaped(std::move(values), shape);
}

std::vector<double> values_on(const TerrainModel& model, Vec2 origin, Vec2 step, int columns, int rows, What what,
                              const Context& context) {
  const TerrainEvaluator& evaluator = model.evaluator(context);
  const auto cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  const auto width = static_cast<std::size_t>(kQuantities[what].width);
  std::vector<double> out(cells * width, kNan);
  if (what == curvature) {  // needs second derivatives
    parallel_chunks(static_cast<std::size_t>(rows), 4, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t r = begin; r < end; ++r)
        for (std::size_t c = 0; c < static_cast<std::size_t>(columns); ++c)
          if (const auto jet = evaluator.jet(
                  {origin.x + static_cast<double>(c) * step.x, origin.y - static_cast<double>(r) * step.y}))
            put(what, *jet, out.data() + (r * static_cast<std::size_t>(columns) + c));
    });
    return out;
  }
  if (what == height) {
    evaluator.grid_values(origin, step, columns, rows, out, {}, context);
    return out;
  }
  std::vector<double> heights(cells);
  std::vector<Vec2> gradients(cells);
  evaluator.grid_values(origin, step, columns, rows, heights, gradients, context);
  for (std::size_t i = 0; i < cells; ++i)
    if (!std::isnan(heights[i])) put(what, {heights[i], gradients[i], 0, 0, 0}, out.data() + i * width);
  return out;
}

py::object sample(const TerrainModel& model, const py::object& transform, const py::object& shape,
                  const std::string& what, const Running& running) {
  const What quantity = parse_what(what);
  const Cells cells = cells_of(model.terrain().georef, model.terrain().grid, transform, shape);
  std::vector<double> values = run(running, [&](const Context& context) {
    return values_on(model, cells.origin, cells.step, cells.columns, cells.rows, quantity, context);
  });
  Shape result{cells.rows, cells.columns};
  if (kQuantities[quantity].width > 1) result.push_back(kQuantities[quantity].width);
  return own<double>(std::move(values), result);
}

py::array vertices_of(const Terrain& terrain) {
  std::vector<Vec3> vertices;
  vertices.reserve(terrain.tin.points.size());
  for (std::size_t v = 0; v < terrain.tin.points.size(); ++v) {
    const Vec2 p = terrain.georef.to_crs(terrain.tin.points[v]);
    vertices.push_back({p.x, p.y, terrain.tin.heights[v]});
  }
  const Shape shape{count_of(vertices.size()), 3};
  return own<double>(std::move(vertices), shape);
}

std::string repr(const TerrainModel& model) {
  const Terrain& t = model.terrain();
  std::string from = t.grid.columns > 0 ? fmt::format("of {} x {} cells", t.grid.rows, t.grid.columns) : "of points";
  return fmt::format("<retalho.Terrain {} {}: {} vertices, {} triangles, {}, {}>", surface_name(t.kind), from,
                     t.tin.vertex_count(), t.tin.triangle_count(),
                     t.tolerance > 0 ? fmt::format("tolerance {:.6g}", t.tolerance) : "no tolerance",
                     crs_title(t.georef));
}

void add_report(py::module_& module) {
  py::class_<ErrorReport> report(module, "ErrorReport",
                                 "How far a model is from the grid that it stands for, at every valid cell.");
  report.def_readonly("cells", &ErrorReport::cells)
      .def_readonly("valid_cells", &ErrorReport::valid_cells)
      .def_readonly("uncovered", &ErrorReport::uncovered, "Valid cells where the model has no data.")
      .def_readonly("violations", &ErrorReport::violations, "Valid cells over the model's tolerance.")
      .def_readonly("rmse", &ErrorReport::rmse, "Root mean square error, height units.")
      .def_readonly("max_error", &ErrorReport::max_error, "Largest error, height units.")
      .def_property_readonly(
          "max_error_at", [](const ErrorReport& e) { return py::make_tuple(e.max_error_at.x, e.max_error_at.y); },
          "(x, y) of it in the CRS.")
      .def_readonly("slope_rmse", &ErrorReport::slope_rmse,
                    "Root mean square error of the gradient, height units a horizontal unit.")
      .def("__repr__", [](const ErrorReport& e) {
        return fmt::format("<retalho.ErrorReport rmse {:.6g}, max_error {:.6g}, {} of {} cells over the tolerance>",
                           e.rmse, e.max_error, e.violations, e.valid_cells);
      });
  report.attr("__module__") = "retalho";
}

void add_queries(py::class_<TerrainModel, std::shared_ptr<TerrainModel>>& terrain) {
  const auto define = [&](const char* name, What what, const char* words) {
    terrain.def(
        name,
        [what](const TerrainModel& m, const py::object& x, const py::object& y, int threads) {
          return ask(m, x, y, what, threads);
        },
        py::arg("x"), py::arg("y"), py::kw_only(), py::arg("threads") = 0, words);
  };
  define("__call__", height,
         "Heights at x, y (CRS coordinates, broadcast against each other), height units; NaN where there is no data. "
         "A float for two numbers, else float64 of the broadcast shape.");
  define("gradient", gradient,
         "(dz/dx, dz/dy), shape (..., 2), height units a horizontal unit (a metre where the CRS is geographic).");
  define("slope", slope, "Angle between surface and horizon, degrees in [0, 90).");
  define("aspect", aspect, "Where the surface looks downhill, degrees clockwise from north; NaN where it is flat.");
  define("normal", normal, "Upward unit normals, shape (..., 3).");
  define("curvature", curvature, "Mean curvature, 1 / horizontal unit; positive in hollows.");
}

}  // namespace

const TerrainEvaluator& TerrainModel::evaluator(const Context& context) const {
  const std::lock_guard lock(mutex_);
  if (!evaluator_) evaluator_ = std::make_unique<TerrainEvaluator>(terrain_, context);
  return *evaluator_;
}

std::shared_ptr<const Raster> model_raster(const TerrainModel& model, const Running& running) {
  const Cells cells = cells_of(model.terrain().georef, model.terrain().grid, py::none(), py::none());
  auto raster = std::make_shared<Raster>();
  raster->columns = cells.columns;
  raster->rows = cells.rows;
  raster->cell_width = cells.step.x;
  raster->cell_height = cells.step.y;
  raster->georef = model.terrain().georef;
  raster->heights = run(running, [&](const Context& context) {
    return values_on(model, cells.origin, cells.step, cells.columns, cells.rows, height, context);
  });
  return raster;
}

void add_terrain(py::module_& module) {
  add_report(module);
  py::class_<TerrainModel, std::shared_ptr<TerrainModel>> terrain(
      module, "Terrain", "A height surface on a triangulation, made by fit, fit_points or load. Immutable.");
  add_queries(terrain);
  terrain.def(
      "sample",
      [](const TerrainModel& m, const py::object& transform, const py::object& shape, const std::string& what,
         int threads, const py::object& progress) {
        return sample(m, transform, shape, what, {threads, progress});
      },
      py::arg("transform") = py::none(), py::arg("shape") = py::none(), py::kw_only(), py::arg("what") = "height",
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The surface at the centres of a raster's cells, float64 (rows, columns), NaN where there is no data.\n\n"
      "transform: (a, b, c, d, e, f) in the model's CRS; shape: (rows, columns); neither: the grid that the model was "
      "made from. what: height, slope, aspect (degrees), curvature (1 / unit), gradient (..., 2) or normal (..., 3).");
  terrain.def(
      "compare",
      [](const TerrainModel& m, const py::object& z, const py::object& transform, const py::object& crs,
         const py::object& nodata, int threads, const py::object& progress) {
        const Running running{threads, progress};
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        return run(running, [&](const Context& context) {
          return assess(m.terrain(), *raster, m.terrain().tolerance, context);
        });
      },
      py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The model's error at every valid cell of a grid, which may lie elsewhere than the model's own.");
  terrain.def(
      "compare_points",
      [](const TerrainModel& m, const py::object& points, int threads, const py::object& progress) {
        std::vector<Vec3> places = as_points3(points, "points");
        for (Vec3& p : places) {
          const Vec2 local = m.terrain().georef.to_local({p.x, p.y});
          p = {local.x, local.y, p.z};
        }
        return run(Running{threads, progress}, [&](const Context& context) {
          return assess_points(m.terrain(), places, m.terrain().tolerance, context);
        });
      },
      py::arg("points"), py::kw_only(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The model's error at points (n, 3), x, y in the CRS and height; those at one place count once, with their mean "
      "height. slope_rmse stays 0.");
  terrain.def_property_readonly(
      "surface", [](const TerrainModel& m) { return surface_name(m.terrain().kind); },
      "\"linear\", \"powell-sabin\" or \"clough-tocher\".");
  terrain.def_property_readonly(
      "gradients", [](const TerrainModel& m) { return gradient_name(m.terrain().gradient_kind); },
      "How the gradients at vertices were set.");
  terrain.def_property_readonly(
      "cross_derivative", [](const TerrainModel& m) { return cross_derivative_name(m.terrain().cross_derivative); },
      "\"perpendicular\" or \"cubic\": of clough-tocher across edges.");
  terrain.def_property_readonly(
      "coefficients", [](const TerrainModel& m) { return coefficient_count(m.terrain()); },
      "How many the surface has: 1 a vertex (linear) or 3, and with creases 2 for each further sector.");
  terrain.def_property_readonly(
      "numbers", [](const TerrainModel& m) { return number_count(m.terrain()); },
      "How many a plain table of the model would store: x, y and coefficients of each vertex, and creases.");
  terrain.def_property_readonly(
      "creases", [](const TerrainModel& m) { return m.terrain().creases.size(); },
      "How many edges the surface folds along.");
  terrain.def_property_readonly(
      "bounds",
      [](const TerrainModel& m) {
        const Extent box = extent_of(m.terrain());
        const Vec2 low = m.terrain().georef.to_crs(box.low), high = m.terrain().georef.to_crs(box.high);
        return py::make_tuple(low.x, low.y, high.x, high.y);
      },
      "(left, bottom, right, top) in the CRS.");
  terrain.def_property_readonly(
      "tolerance", [](const TerrainModel& m) { return m.terrain().tolerance; },
      "The max_error asked for, height units; 0: none.");
  terrain.def_property_readonly(
      "vertices", [](const TerrainModel& m) { return vertices_of(m.terrain()); },
      "(n, 3): x, y in the CRS and height.");
  terrain.def_property_readonly(
      "triangles",
      [](const py::object& self) {
        const auto& triangles = py::cast<const TerrainModel&>(self).terrain().tin.triangles;
        return view<std::uint32_t>(triangles.data(), {count_of(triangles.size()), 3}, self);
      },
      "(m, 3) indices of vertices, counter-clockwise, uint32. A read-only view.");
  terrain.def_property_readonly(
      "vertex_gradients",
      [](const py::object& self) {
        const auto& gradients = py::cast<const TerrainModel&>(self).terrain().gradients;
        return view<double>(gradients.data(), {count_of(gradients.size()), 2}, self);
      },
      "(n, 2): dz/dx, dz/dy at the vertices; (0, 2) for linear surfaces. A read-only view.");
  terrain.def_property_readonly(
      "crs", [](const TerrainModel& m) { return crs_object(m.terrain().georef); }, "The CRS as WKT, or None.");
  terrain.def_property_readonly(
      "unit", [](const TerrainModel& m) { return m.terrain().georef.unit; },
      "Of horizontal distances: \"metre\" (where the CRS is geographic too), \"unit\" where none is known.");
  terrain.def_property_readonly(
      "shape",
      [](const TerrainModel& m) -> py::object {
        if (m.terrain().grid.columns == 0) return py::none();
        return py::make_tuple(m.terrain().grid.rows, m.terrain().grid.columns);
      },
      "(rows, columns) of the grid that it was made from; None: made from points.");
  terrain.def_property_readonly(
      "transform",
      [](const TerrainModel& m) -> py::object {
        const GridDomain& grid = m.terrain().grid;
        if (grid.columns == 0) return py::none();
        return to_tuple(transform_of(m.terrain().georef, {0, 0}, {grid.cell_width, grid.cell_height}));
      },
      "(a, b, c, d, e, f) of that grid, at the cells' corners; None: made from points.");
  terrain.def("__repr__", &repr);
  add_model_methods(terrain);
  terrain.attr("__module__") = "retalho";
}

}  // namespace retalho::python
