#include "mesh.h"

#include <fmt/format.h>

#include <vector>

#include "arrays.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/mesh/terrain_mesh.h"
#include "running.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

using Holder = std::shared_ptr<TriangleMesh>;

TriangleMesh make(const py::object& positions, const py::object& triangles) {
  TriangleMesh mesh;
  mesh.positions = as_points3(positions, "positions");
  py::object mask;
  const py::array given = as_array(triangles, "triangles", mask);
  if (given.ndim() != 2 || given.shape(1) != 3 || given.dtype().kind() == 'f')
    throw BadInput("triangles must be whole numbers of shape (m, 3), not " + shape_text(given), {}, "triangles");
  const auto indices = py::cast<py::array_t<long long, py::array::c_style | py::array::forcecast>>(given);
  mesh.triangles.resize(static_cast<std::size_t>(indices.shape(0)));
  const long long most = static_cast<long long>(mesh.positions.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const long long v = indices.data()[3 * t + k];
      if (v < 0 || v >= most)
        throw BadInput(fmt::format("triangle {} names vertex {}: there are {}", t, v, most), {}, "triangles");
      mesh.triangles[t][k] = static_cast<std::uint32_t>(v);
    }
  return mesh;
}

py::dict check(const TriangleMesh& mesh) {
  const MeshCheck c = run(Running{}, [&](const Context&) { return check_mesh(mesh); });
  py::dict d;
  d["watertight"] = c.watertight();
  d["open_edges"] = c.open_edges;
  d["boundary_edges"] = c.boundary_edges;
  d["cracks"] = c.cracks;
  d["nonmanifold_edges"] = c.nonmanifold_edges;
  d["degenerate_triangles"] = c.degenerate_triangles;
  d["components"] = c.components;
  return d;
}

}  // namespace

void add_mesh(py::module_& module) {
  py::class_<TriangleMesh, Holder> mesh(module, "Mesh",
                                        "Triangles: positions (n, 3) and indices (m, 3), counter-clockwise from "
                                        "outside (above).");
  mesh.def(py::init([](const py::object& positions, const py::object& triangles) {
             return std::make_shared<TriangleMesh>(make(positions, triangles));
           }),
           py::arg("positions"), py::arg("triangles"));
  mesh.def_property_readonly(
          "positions",
          [](const py::object& self) {
            const auto& m = py::cast<const TriangleMesh&>(self);
            return view<double>(m.positions.data(), {count_of(m.positions.size()), 3}, self);
          },
          "(n, 3); add `offset` for CRS coordinates. A read-only view.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) {
            const auto& m = py::cast<const TriangleMesh&>(self);
            return view<double>(m.normals.data(), {count_of(m.normals.size()), 3}, self);
          },
          "(n, 3) unit normals, or (0, 3). A read-only view.")
      .def_property_readonly(
          "texture",
          [](const py::object& self) {
            const auto& m = py::cast<const TriangleMesh&>(self);
            return view<double>(m.texture.data(), {count_of(m.texture.size()), 2}, self);
          },
          "(n, 2) texture coordinates, or (0, 2). A read-only view.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            const auto& m = py::cast<const TriangleMesh&>(self);
            return view<std::uint32_t>(m.triangles.data(), {count_of(m.triangles.size()), 3}, self);
          },
          "(m, 3) indices, uint32. A read-only view.")
      .def_property_readonly(
          "offset", [](const TriangleMesh& m) { return py::make_tuple(m.offset.x, m.offset.y, m.offset.z); },
          "(x, y, z) that positions are less of; (0, 0, 0) where the CRS is geographic: positions are metres then.")
      .def("check", &check,
           "How the mesh hangs together: watertight, open_edges, boundary_edges, cracks, nonmanifold_edges, "
           "degenerate_triangles, components.")
      .def(
          "write",
          [](const TriangleMesh& m, const py::object& path, bool overwrite) {
            const std::string name = path_text(path);
            run(Running{}, [&](const Context&) { write_mesh(m, name, overwrite); });
          },
          py::arg("path"), py::kw_only(), py::arg("overwrite") = false,
          "Writes .ply, .obj, .stl, .glb or LandXML (.xml, .landxml); complete or absent. Raises CannotWrite, "
          "UsageError (ending).")
      .def("__repr__", [](const TriangleMesh& m) {
        return fmt::format("<retalho.Mesh {} vertices, {} triangles>", m.positions.size(), m.triangles.size());
      });
  mesh.attr("__module__") = "retalho";
  module.def(
      "read_mesh",
      [](const py::object& path) {
        const std::string name = path_text(path);
        return std::make_shared<TriangleMesh>(run(Running{}, [&](const Context&) { return read_mesh(name); }));
      },
      py::arg("path"), "A triangle mesh from .ply or .obj. Raises CannotRead, BadInput.");
  auto terrain =
      py::reinterpret_borrow<py::class_<TerrainModel, std::shared_ptr<TerrainModel>>>(module.attr("Terrain"));
  terrain.def(
      "mesh",
      [](const TerrainModel& model, double tolerance, int threads, const py::object& progress) {
        return std::make_shared<TriangleMesh>(run(Running{threads, progress}, [&](const Context& context) {
          return mesh_terrain(model.terrain(), {.tolerance = tolerance}, context);
        }));
      },
      py::kw_only(), py::arg("tolerance") = 0.0, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "Triangles whose corners lie on the surface, without cracks. tolerance: largest vertical distance to it, height "
      "units; 0: a thousandth of the height range.");
}

}  // namespace retalho::python
