#include "tetraquad.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

#include "arrays.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/mesh/tetraquad_mesh.h"
#include "running.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr Vec3 kNowhere{kNan, kNan, kNan};

/// Many rays' hits.
struct Hits {
  py::array_t<double> t, points, normals;
};

Hits cast_rays(const TetraQuadModel& model, const py::object& origins, const py::object& directions, double from,
               double to, const Running& running) {
  std::vector<Vec3> starts = as_points3(origins, "origins"), ways = as_points3(directions, "directions");
  if (starts.size() == 1 && ways.size() > 1) starts.assign(ways.size(), starts[0]);
  if (ways.size() == 1 && starts.size() > 1) ways.assign(starts.size(), ways[0]);
  if (starts.size() != ways.size())
    throw BadInput(fmt::format("origins and directions must have the same shape (or one of them (3,)), not ({}, 3) and "
                               "({}, 3)",
                               starts.size(), ways.size()),
                   {}, "directions");
  const std::size_t count = starts.size();
  std::vector<double> t(count, kNan);
  std::vector<Vec3> points(count, kNowhere), normals(count, kNowhere);
  run(running, [&](const Context& context) {
    const TetraQuadRays& rays = model.rays(context);
    const TetraQuadField& field = model.field();
    parallel_chunks(count, 4096, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const auto hit = rays.first(starts[i], ways[i], from, to);
        if (!hit) continue;
        t[i] = hit->t;
        points[i] = starts[i] + hit->t * ways[i];
        normals[i] = normalized(field.gradient(hit->tet, hit->b).gradient);
      }
    });
  });
  const py::ssize_t n = count_of(count);
  return {own<double>(std::move(t), {n}), own<double>(std::move(points), {n, 3}),
          own<double>(std::move(normals), {n, 3})};
}

/// Value (width 1) or gradient (width 3) at points.
py::object ask(const TetraQuadModel& model, const py::object& object, bool gradient, int threads) {
  const std::vector<Vec3> points = as_points3(object, "points");
  const std::size_t width = gradient ? 3 : 1;
  std::vector<double> out(points.size() * width, kNan);
  run(Running{threads}, [&](const Context& context) {
    const TetraQuadField& field = model.field();
    parallel_chunks(points.size(), 4096, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::optional<Jet3> jet = field.jet(points[i]);
        if (!jet) continue;
        if (!gradient) {
          out[i] = jet->value;
        } else {
          out[3 * i] = jet->gradient.x;
          out[3 * i + 1] = jet->gradient.y;
          out[3 * i + 2] = jet->gradient.z;
        }
      }
    });
  });
  Shape shape{count_of(points.size())};
  if (gradient) shape.push_back(3);
  return own<double>(std::move(out), shape);
}

py::tuple project(const TetraQuadModel& model, const py::object& object, int threads) {
  const std::vector<Vec3> points = as_points3(object, "points");
  std::vector<Vec3> feet(points.size(), kNowhere), normals(points.size(), kNowhere);
  run(Running{threads}, [&](const Context& context) {
    const TetraQuadField& field = model.field();
    parallel_chunks(points.size(), 1024, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (const auto foot = field.project(points[i])) {
          feet[i] = foot->point;
          normals[i] = foot->normal;
        }
    });
  });
  const py::ssize_t n = count_of(points.size());
  return py::make_tuple(own<double>(std::move(feet), {n, 3}), own<double>(std::move(normals), {n, 3}));
}

}  // namespace

const TetraQuadField& TetraQuadModel::field() const {
  const std::lock_guard lock(mutex_);
  if (!field_) field_ = std::make_unique<TetraQuadField>(surface_);
  return *field_;
}

const TetraQuadRays& TetraQuadModel::rays(const Context& context) const {
  const TetraQuadField& asked = field();
  const std::lock_guard lock(mutex_);
  if (!rays_) rays_ = std::make_unique<TetraQuadRays>(asked, 9, context);
  return *rays_;
}

void add_tetraquad(py::module_& module) {
  py::class_<Hits> hits(module, "RayHits", "The first hits of many rays; NaN where a ray misses.");
  hits.def_readonly("t", &Hits::t, "(n,): the point is origin + t * direction.")
      .def_readonly("points", &Hits::points, "(n, 3)")
      .def_readonly("normals", &Hits::normals, "(n, 3), unit, towards the side where the function is positive.")
      .def_property_readonly(
          "hit",
          [](const Hits& h) {
            std::vector<std::uint8_t> hit(static_cast<std::size_t>(h.t.size()));
            for (std::size_t i = 0; i < hit.size(); ++i) hit[i] = std::isnan(h.t.data()[i]) ? 0 : 1;
            return own<bool>(std::move(hit), {h.t.size()});
          },
          "(n,) bool")
      .def("__len__", [](const Hits& h) { return h.t.size(); })
      .def("__repr__", [](const Hits& h) { return fmt::format("<retalho.RayHits of {} rays>", h.t.size()); });
  hits.attr("__module__") = "retalho";
  py::class_<TetraQuadModel, std::shared_ptr<TetraQuadModel>> tetraquad(
      module, "TetraQuad",
      "A smooth surface in tetrahedra, the zero set of a function that is about the signed distance, negative inside. "
      "Made by TetraQuad.fit or load. Immutable.");
  tetraquad.def(
      "cast",
      [](const TetraQuadModel& m, const py::object& origins, const py::object& directions, double near, double far,
         int threads, const py::object& progress) {
        return cast_rays(m, origins, directions, near, far, {threads, progress});
      },
      py::arg("origins"), py::arg("directions"), py::kw_only(), py::arg("near") = 0.0,
      py::arg("far") = std::numeric_limits<double>::infinity(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "The first point of the surface on each ray origin + t * direction, near <= t <= far. origins, directions: "
      "(n, 3), or one of them (3,). Directions need not be unit. About 0.2 us a ray.");
  tetraquad.def(
      "__call__",
      [](const TetraQuadModel& m, const py::object& points, int threads) { return ask(m, points, false, threads); },
      py::arg("points"), py::kw_only(), py::arg("threads") = 0,
      "The function at points (n, 3), a length; NaN outside of the tetrahedra.");
  tetraquad.def(
      "gradient",
      [](const TetraQuadModel& m, const py::object& points, int threads) { return ask(m, points, true, threads); },
      py::arg("points"), py::kw_only(), py::arg("threads") = 0, "Its gradient, (n, 3).");
  tetraquad.def("project", &project, py::arg("points"), py::kw_only(), py::arg("threads") = 0,
                "(points, normals), each (n, 3): where Newton's steps along the gradient lead; NaN where they leave "
                "the tetrahedra.");
  tetraquad.def(
      "mesh",
      [](const TetraQuadModel& m, double tolerance, int divisions, int threads, const py::object& progress) {
        return std::make_shared<TriangleMesh>(run(Running{threads, progress}, [&](const Context& context) {
          return mesh_tetraquad(m.field(), {tolerance, divisions}, nullptr, context);
        }));
      },
      py::kw_only(), py::arg("tolerance") = 0.0, py::arg("divisions") = 0, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Triangles whose corners lie on the surface, without cracks. tolerance: largest distance to the surface; 0: "
      "three divisions of a tetrahedron's edge. divisions: 1 to 16, instead.");
  tetraquad.def_property_readonly(
      "step", [](const TetraQuadModel& m) { return m.surface().mesh.step; }, "Edge of a cube of the grid, a length.");
  tetraquad.def_property_readonly(
      "tetrahedra", [](const TetraQuadModel& m) { return m.surface().mesh.tets.size(); }, "How many.");
  tetraquad.def_property_readonly(
      "vertices", [](const TetraQuadModel& m) { return m.surface().mesh.lattice.size(); }, "How many.");
  tetraquad.def_property_readonly(
      "quadrics",
      [](const py::object& self) {
        const auto& q = py::cast<const TetraQuadModel&>(self).surface().quadrics;
        return view<double>(q.data(), {count_of(q.size()), 10}, self);
      },
      "(vertices, 10): factors of 1, u, v, w, uu, vv, ww, uv, uw, vw about each vertex, in steps. A read-only view.");
  tetraquad.def("__repr__", [](const TetraQuadModel& m) {
    return fmt::format("<retalho.TetraQuad {} vertices, {} tetrahedra, step {:.6g}>", m.surface().mesh.lattice.size(),
                       m.surface().mesh.tets.size(), m.surface().mesh.step);
  });
  add_model_methods(tetraquad);
  tetraquad.attr("__module__") = "retalho";
}

}  // namespace retalho::python
