#include "points.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "grid.h"
#include "model.h"
#include "retalho/cloud/cloud.h"
#include "running.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

/// Positions in the CRS.
struct Points {
  PointCloud cloud;
  std::size_t skipped = 0;
};

py::object normals_of(const py::object& self) {
  const std::vector<Vec3>& normals = py::cast<const Points&>(self).cloud.normals;
  if (normals.empty()) return py::none();
  return view<double>(normals.data(), {count_of(normals.size()), 3}, self);
}

py::array_t<double> positions_of(const py::object& self) {
  const std::vector<Vec3>& positions = py::cast<const Points&>(self).cloud.positions;
  return view<double>(positions.data(), {count_of(positions.size()), 3}, self);
}

Points read(const std::string& path, const PointOptions& options, const Context& context) {
  Points points;
  PointNotes notes;
  points.cloud = read_points(path, options, &notes, context);
  points.skipped = notes.skipped;
  for (Vec3& p : points.cloud.positions) {
    const Vec2 place = points.cloud.georef.to_crs({p.x, p.y});
    p = {place.x, place.y, p.z};
  }
  return points;
}

}  // namespace

void add_points(py::module_& module) {
  py::class_<Points, std::shared_ptr<Points>> points(module, "Points", "Points of a file, as read_points makes them.");
  points
      .def_property_readonly(
          "positions", &positions_of,
          "(n, 3): x, y in the CRS and height. A read-only view; numpy.asarray(points) gives it, too.")
      .def_property_readonly("normals", &normals_of, "(n, 3), or None where the file has none. A read-only view.")
      .def_property_readonly(
          "crs", [](const Points& p) { return crs_object(p.cloud.georef); }, "The CRS as WKT, or None.")
      .def_property_readonly(
          "skipped", [](const Points& p) { return p.skipped; },
          "How many were left out, since a coordinate is missing or not finite.")
      .def(
          "__array__",
          [](const py::object& self, const py::object& dtype) -> py::object {
            const py::array_t<double> positions = positions_of(self);
            return dtype.is_none() ? py::object(positions) : positions.attr("astype")(dtype);
          },
          py::arg("dtype") = py::none())
      .def("__len__", [](const Points& p) { return p.cloud.positions.size(); })
      .def("__repr__", [](const Points& p) {
        return fmt::format("<retalho.Points {}{}, {}>", p.cloud.positions.size(),
                           p.cloud.normals.empty() ? "" : " with normals", crs_title(p.cloud.georef));
      });
  points.attr("__module__") = "retalho";
  module.def(
      "read_points",
      [](const py::object& path, const std::string& height_field, const std::string& layer, const py::object& crs,
         int threads, const py::object& progress) {
        const std::string name = path_text(path);
        const PointOptions options{height_field, layer, crs_text(crs)};
        return std::make_shared<Points>(
            run(Running{threads, progress}, [&](const Context& context) { return read(name, options, context); }));
      },
      py::arg("path"), py::kw_only(), py::arg("height_field") = "", py::arg("layer") = "", py::arg("crs") = py::none(),
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "Survey points or a scan: .xyz, .csv and other text, .ply, .las, .obj, and every vector layer, as fit_points and "
      "TetraQuad.fit take them.\n\n"
      "height_field: of a vector layer, the attribute with the height (else its geometries'); layer: which, where "
      "there "
      "are several; crs: of formats that have none. Raises CannotRead with the line, BadInput.");
}

}  // namespace retalho::python
