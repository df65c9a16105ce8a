#include "bicubic.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <vector>

#include "arrays.h"
#include "grid.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

py::object ask(const BicubicGrid& grid, const py::object& x, const py::object& y, bool gradient, int threads) {
  const Pair xy = broadcast(x, y, "x and y");
  const std::size_t width = gradient ? 2 : 1;
  std::vector<double> out(xy.size() * width, kNan);
  run(Running{threads}, [&](const Context& context) {
    parallel_chunks(xy.size(), 4096, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vec2 p = grid.georef.to_local(xy.at(i));
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
        const std::optional<Jet> jet = grid.at(p);
        if (!jet) continue;
        if (!gradient) {
          out[i] = jet->value;
        } else {
          out[2 * i] = jet->gradient.x;
          out[2 * i + 1] = jet->gradient.y;
        }
      }
    });
  });
  Shape shape = xy.shape;
  if (gradient) shape.push_back(2);
  return shaped(std::move(out), shape);
}

}  // namespace

BicubicOptions bicubic_options(const std::string& twist, const std::string& ends, bool keep_flats) {
  const std::optional<Twist> twisted = parse_twist(twist);
  if (!twisted) throw UsageError("twist must be 'spline', 'adini' or 'zero', not '" + twist + "'", {}, "twist");
  if (ends != "not-a-knot" && ends != "natural")
    throw UsageError("ends must be 'not-a-knot' or 'natural', not '" + ends + "'", {}, "ends");
  return {ends == "natural" ? TangentEnds::natural : TangentEnds::not_a_knot, *twisted, keep_flats};
}

void add_bicubic(py::module_& module) {
  py::class_<BicubicGrid, std::shared_ptr<BicubicGrid>> bicubic(
      module, "Bicubic",
      "The C1 bicubic surface through every cell of a grid, which retalho.contours traces.\n\n"
      "twist: spline (C2 on a grid without voids), adini or zero; ends: not-a-knot or natural; keep_flats: no slope "
      "where neighbours have the very same height, so that lakes stay flat. 32 bytes a cell.");
  bicubic.def(py::init([](const py::object& z, const py::object& transform, const py::object& crs,
                          const py::object& nodata, const std::string& twist, const std::string& ends, bool keep_flats,
                          int threads, const py::object& progress) {
                const BicubicOptions options = bicubic_options(twist, ends, keep_flats);
                const Running running{threads, progress};
                const auto raster = raster_of(z, {transform, crs, nodata}, running);
                return run(running, [&](const Context& context) {
                  return std::make_shared<BicubicGrid>(make_bicubic(*raster, options, context));
                });
              }),
              py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
              py::arg("nodata") = py::none(), py::arg("twist") = "spline", py::arg("ends") = "not-a-knot",
              py::arg("keep_flats") = true, py::arg("threads") = 0, py::arg("progress") = py::none());
  bicubic.def(
      "__call__",
      [](const BicubicGrid& g, const py::object& x, const py::object& y, int threads) {
        return ask(g, x, y, false, threads);
      },
      py::arg("x"), py::arg("y"), py::kw_only(), py::arg("threads") = 0,
      "Heights at x, y (CRS coordinates, broadcast); NaN outside of the cells' centres and beside voids.");
  bicubic.def(
      "gradient",
      [](const BicubicGrid& g, const py::object& x, const py::object& y, int threads) {
        return ask(g, x, y, true, threads);
      },
      py::arg("x"), py::arg("y"), py::kw_only(), py::arg("threads") = 0,
      "(dz/dx, dz/dy), shape (..., 2), height units a horizontal unit.");
  bicubic.def_property_readonly(
      "shape", [](const BicubicGrid& g) { return py::make_tuple(g.rows, g.columns); }, "(rows, columns)");
  bicubic.def("__repr__", [](const BicubicGrid& g) {
    return fmt::format("<retalho.Bicubic of {} x {} cells of {:.6g} x {:.6g} {}, {}>", g.rows, g.columns, g.cell_width,
                       g.cell_height, g.georef.unit, crs_title(g.georef));
  });
  bicubic.attr("__module__") = "retalho";
}

}  // namespace retalho::python
