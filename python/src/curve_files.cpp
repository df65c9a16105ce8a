// Curves from files, to files, and as pictures.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "curves.h"
#include "formulas.h"
#include "model.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/curve/curve_files.h"
#include "retalho/render/curve_sheet.h"
#include "running.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

using Holder = std::shared_ptr<CurveBox>;

py::list read(const py::object& path) {
  const std::string name = path_text(path);
  std::vector<Curve> curves = run(Running{}, [&](const Context&) {
    std::vector<Curve> all;
    for (const CurveSpec& spec : read_curve_specs(name))
      all.push_back(to_curve(spec, fmt::format("curves[{}]", all.size())));
    return all;
  });
  py::list list;
  for (Curve& curve : curves) list.append(std::make_shared<CurveBox>(CurveBox{std::move(curve)}));
  return list;
}

void write(const std::vector<Holder>& curves, const py::object& path, const std::vector<std::string>& names,
           std::optional<double> flatten, bool overwrite) {
  const std::string file = path_text(path);
  if (!names.empty() && names.size() != curves.size())
    throw BadInput(fmt::format("{} names for {} curves", names.size(), curves.size()), {}, "names");
  if (flatten && !(*flatten > 0))
    throw UsageError(fmt::format("flatten must be above 0, not {}", *flatten), {}, "flatten");
  const bool json = file.ends_with(".json");
  run(Running{}, [&](const Context& context) {
    CurveDocument document;
    std::vector<VectorLine> lines;
    for (std::size_t i = 0; i < curves.size(); ++i) {
      const std::string name = names.empty() ? std::string() : names[i];
      if (json && !flatten) {
        document.curves.push_back(to_spec(curves[i]->curve));
        document.curves.back().name = name;
        continue;
      }
      for (VectorLine& line : vector_lines(curves[i]->curve, name, flatten.value_or(0), context)) {
        if (json)
          document.curves.push_back(to_spec(line));
        else
          lines.push_back(std::move(line));
      }
    }
    if (json)
      write_file(file, to_json(document), overwrite);
    else
      write_vector_lines(lines, file, overwrite);
  });
}

/// Of a vector layer, for breaklines and creases.
py::list lines_of(const py::object& path, const std::string& layer, const Running& running) {
  const std::string name = path_text(path);
  const LineLayer all =
      run(running, [&](const Context& context) { return read_line_layer(name, layer, "layer", context); });
  py::list list;
  for (const VectorLine& line : all.lines) {
    std::vector<Vec3> points = line.points;
    if (line.closed && !points.empty()) points.push_back(points.front());
    list.append(coordinates(points, line.dimension));
  }
  return list;
}

/// What is drawn, kept alive while it is.
struct Drawn {
  std::vector<py::object> kept;
  std::vector<SheetCurve> curves;
};

Drawn drawn_of(const py::object& curves) {
  Drawn drawn;
  const auto add = [&](const py::object& one) {
    drawn.kept.push_back(one);
    SheetCurve& c = drawn.curves.emplace_back();
    if (py::isinstance<CurveBox>(one)) {
      c.curve = &py::cast<const CurveBox&>(one).curve;
    } else if (py::isinstance<GraphBox>(one)) {
      c.graph = &py::cast<const GraphBox&>(one).graph;
    } else if (py::isinstance<LevelSetBox>(one)) {
      const auto& level = py::cast<const LevelSetBox&>(one);
      c.level = &level.level;
      c.box = level.box;
    } else {
      throw py::type_error("curves must be Curves, Graphs and LevelSets, not " +
                           py::cast<std::string>(py::str(py::type::of(one))));
    }
  };
  if (py::isinstance<CurveBox>(curves) || py::isinstance<GraphBox>(curves) || py::isinstance<LevelSetBox>(curves))
    add(curves);
  else
    for (const py::handle one : curves) add(py::reinterpret_borrow<py::object>(one));
  return drawn;
}

CurveView parse_view(const std::string& word) {
  constexpr std::array<const char*, 4> kViews{"iso", "top", "front", "side"};
  for (std::size_t k = 0; k < kViews.size(); ++k)
    if (word == kViews[k]) return static_cast<CurveView>(k);
  throw UsageError("view must be 'iso', 'top', 'front' or 'side', not '" + word + "'", {}, "view");
}

}  // namespace

py::array_t<double> coordinates(const std::vector<Vec3>& points, int dimension) {
  std::vector<double> numbers;
  numbers.reserve(points.size() * static_cast<std::size_t>(dimension));
  for (const Vec3& p : points) {
    numbers.insert(numbers.end(), {p.x, p.y});
    if (dimension == 3) numbers.push_back(p.z);
  }
  return own<double>(std::move(numbers), {count_of(points.size()), dimension});
}

void add_curve_files(py::module_& module) {
  module.def("read_curves", &read, py::arg("path"),
             "The curves of a file, a list of Curve: .json (docs/curves.md) and .svg exactly, of any other vector file "
             "its lines. Raises CannotRead, BadInput with the place.");
  module.def("write_curves", &write, py::arg("curves"), py::arg("path"), py::kw_only(),
             py::arg("names") = std::vector<std::string>{}, py::arg("flatten") = py::none(),
             py::arg("overwrite") = false,
             "Curves to a file: .json exactly; .gpkg, .geojson, .shp or .dxf as lines nowhere farther away than "
             "`flatten` (None: 1e-4 of a curve's size), which may be asked for in .json, too. names: one a curve. "
             "Raises CannotWrite.");
  module.def(
      "read_lines",
      [](const py::object& path, const std::string& layer, int threads, const py::object& progress) {
        return lines_of(path, layer, {threads, progress});
      },
      py::arg("path"), py::kw_only(), py::arg("layer") = "", py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The lines and rings of a vector layer, (n, 3), or (n, 2) without heights: for breaklines of fit_points and "
      "creases of fit. layer: its name, where there are several. Raises CannotRead, BadInput.");
  module.def(
      "draw_curves",
      [](const py::object& curves, const py::object& path, bool control, bool tangents, bool comb, double comb_scale,
         std::optional<double> casteljau, bool hodograph, bool joins, bool axes, bool stretch, const py::object& window,
         const std::string& title, const std::string& view, const std::pair<int, int>& size, bool overwrite) {
        CurveSheetOptions options;
        options.control = control;
        options.tangents = tangents;
        options.comb = comb;
        options.comb_scale = comb_scale;
        options.casteljau = casteljau;
        options.hodograph = hodograph;
        options.joins = joins;
        options.axes = axes;
        options.stretch = stretch;
        options.title = title;
        options.view = parse_view(view);
        std::tie(options.width, options.height) = size;
        if (options.width < 50 || options.height < 50 || options.width > 10000 || options.height > 10000)
          throw UsageError(fmt::format("size must be (width, height), 50 to 10,000 pixels each, not ({}, {})",
                                       options.width, options.height),
                           {}, "size");
        if (!window.is_none()) options.window = as_vector(window, "window");
        if (!options.window.empty() && options.window.size() != 4)
          throw BadInput("window must be four numbers (xmin, ymin, xmax, ymax)", {}, "window");
        const std::string name = path_text(path);
        const Drawn drawn = drawn_of(curves);
        run(Running{}, [&](const Context& context) {
          write_picture(curve_sheet(drawn.curves, options, context), name, overwrite);
        });
      },
      py::arg("curves"), py::arg("path"), py::kw_only(), py::arg("control") = false, py::arg("tangents") = false,
      py::arg("comb") = false, py::arg("comb_scale") = 0.0, py::arg("casteljau") = py::none(),
      py::arg("hodograph") = false, py::arg("joins") = false, py::arg("axes") = false, py::arg("stretch") = false,
      py::arg("window") = py::none(), py::arg("title") = "", py::arg("view") = "iso",
      py::arg("size") = std::pair{640, 480}, py::arg("overwrite") = false,
      "A picture of Curves, Graphs and LevelSets: .svg (with the exact numbers), .pdf or .png.\n\n"
      "control, tangents, comb, joins: control polygons, tangents at joins, curvature combs (comb_scale: a tooth's "
      "length at curvature 1), dots at joins. casteljau: the construction at a parameter. hodograph: the derivative "
      "beside each curve. axes: a frame with numbers; stretch: scales of their own; window: (xmin, ymin, xmax, ymax). "
      "view: iso, top, front or side, of curves in space. size: (width, height) of a panel, pixels. Raises "
      "CannotWrite.");
}

}  // namespace retalho::python
