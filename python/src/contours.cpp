#include "contours.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "arrays.h"
#include "bicubic.h"
#include "grid.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/level/write_vector.h"
#include "retalho/terrain/bicubic.h"
#include "retalho/terrain/height_range.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

/// Lines in the CRS, a closed one with its first point again at its end, beside what the tracer gave.
struct Lines {
  ContourSet set;
  std::optional<BandSet> bands;
  Georef georef;
  std::vector<Vec2> points;
  std::vector<std::uint64_t> offsets{0};  ///< line i has points [offsets[i], offsets[i + 1])
  VectorOptions attributes;
};

struct Line {
  double level = 0;
  bool closed = false;
  py::array_t<double> points;
};

struct Band {
  std::optional<double> low, high;  ///< open to that side
  py::array_t<double> outer;
  py::list holes;
};

std::shared_ptr<Lines> finish(ContourSet set, ContourExtras extras, const Georef& georef, const AskedLines& asked) {
  auto lines = std::make_shared<Lines>();
  lines->georef = georef;
  lines->attributes.index_base = asked.base;
  lines->attributes.interval = asked.interval.value_or(0);
  if (asked.bands) lines->bands = std::move(extras.bands);
  for (const ContourLine& line : set.lines) {
    for (std::size_t i = line.begin; i < line.end; ++i) lines->points.push_back(georef.to_crs(set.points[i]));
    if (line.closed) lines->points.push_back(georef.to_crs(set.points[line.begin]));
    lines->offsets.push_back(lines->points.size());
  }
  lines->set = std::move(set);
  return lines;
}

std::shared_ptr<Lines> trace_model(const TerrainModel& model, const AskedLines& asked, const Context& context) {
  const Terrain& terrain = model.terrain();
  const HeightRange range = height_range(terrain);
  const ContourOptions options{asked.tolerance.value_or(0.1 * line_cell(terrain)), asked.simplify};
  ContourExtras extras;
  extras.want_bands = asked.bands;
  ContourSet set = trace_contours(terrain, levels_of(asked, range.low, range.high), options, context, &extras);
  return finish(std::move(set), std::move(extras), terrain.georef, asked);
}

std::shared_ptr<Lines> trace_raster(const Raster& raster, const AskedLines& asked, const BicubicOptions& surface,
                                    const Context& context) {
  const RasterSummary summary = summarize(raster);
  if (summary.valid == 0) throw BadInput("z holds no data", {}, "z");
  const ContourOptions options{asked.tolerance.value_or(0.1 * std::min(raster.cell_width, raster.cell_height)),
                               asked.simplify};
  ContourExtras extras;
  extras.want_bands = asked.bands;
  std::vector<double> levels = levels_of(asked, summary.minimum, summary.maximum);
  ContourSet set =
      asked.bands ? trace_contours(make_bicubic(raster, surface, context), std::move(levels), options, context, &extras)
                  : trace_contours(raster, surface, std::move(levels), options, context);
  return finish(std::move(set), std::move(extras), raster.georef, asked);
}

Line line_at(const py::object& self, py::ssize_t index) {
  const auto& lines = py::cast<const Lines&>(self);
  const py::ssize_t count = count_of(lines.set.lines.size());
  if (index < 0) index += count;
  if (index < 0 || index >= count) throw py::index_error(fmt::format("line {} of {}", index, count));
  const auto i = static_cast<std::size_t>(index);
  const ContourLine& line = lines.set.lines[i];
  const std::uint64_t begin = lines.offsets[i], end = lines.offsets[i + 1];
  return {lines.set.levels[static_cast<std::size_t>(line.level)], line.closed,
          view<double>(lines.points.data() + begin, {count_of(end - begin), 2}, self)};
}

py::array_t<double> ring(const BandRing& ring, const Georef& georef) {
  std::vector<Vec2> points;
  points.reserve(ring.points.size() + 1);
  for (const Vec2 p : ring.points) points.push_back(georef.to_crs(p));
  if (!points.empty()) points.push_back(points.front());
  const Shape shape{count_of(points.size()), 2};
  return own<double>(std::move(points), shape);
}

py::object bands_of(const Lines& lines) {
  if (!lines.bands) return py::none();
  py::list list;
  for (const BandPolygon& polygon : lines.bands->polygons) {
    Band band;
    const auto k = static_cast<std::size_t>(polygon.band);
    if (k > 0) band.low = lines.bands->levels[k - 1];
    if (k < lines.bands->levels.size()) band.high = lines.bands->levels[k];
    band.outer = ring(polygon.outer, lines.georef);
    for (const BandRing& hole : polygon.holes) band.holes.append(ring(hole, lines.georef));
    list.append(py::cast(std::move(band)));
  }
  return list;
}

py::list singular_of(const Lines& lines) {
  py::list list;
  for (const SingularPlace& place : lines.set.singular) {
    const Vec2 low = lines.georef.to_crs(place.low), high = lines.georef.to_crs(place.high);
    list.append(py::make_tuple(lines.set.levels[static_cast<std::size_t>(place.level)],
                               py::make_tuple(low.x, low.y, high.x, high.y)));
  }
  return list;
}

void write(const Lines& lines, const py::object& path, bool overwrite, int index_every) {
  const std::string name = path_text(path);
  VectorOptions options = lines.attributes;
  options.overwrite = overwrite;
  options.index_every = index_every;
  run(Running{}, [&](const Context& context) {
    if (lines.bands)
      write_bands(*lines.bands, lines.georef, name, options, context);
    else
      write_contours(lines.set, lines.georef, name, options, context);
  });
}

void add_classes(py::module_& module) {
  py::class_<Line> line(module, "ContourLine", "One line, high ground on its left.");
  line.def_readonly("level", &Line::level, "Its height.")
      .def_readonly("closed", &Line::closed, "A ring; an open line ends on the border of the data.")
      .def_readonly("points", &Line::points,
                    "(n, 2) in the CRS; of a ring the last is the first again. A read-only view.")
      .def(
          "__array__",
          [](const Line& l, const py::object& dtype) -> py::object {
            return dtype.is_none() ? py::object(l.points) : l.points.attr("astype")(dtype);
          },
          py::arg("dtype") = py::none())
      .def("__len__", [](const Line& l) { return l.points.shape(0); })
      .def("__repr__", [](const Line& l) {
        return fmt::format("<retalho.ContourLine at {:.6g}, {} points, {}>", l.level, l.points.shape(0),
                           l.closed ? "closed" : "open");
      });
  line.attr("__module__") = "retalho";
  py::class_<Band> band(module, "Band", "A connected region between two neighbouring levels.");
  band.def_readonly("low", &Band::low, "The level below; None: the region is below the first.")
      .def_readonly("high", &Band::high, "The level above; None: the region is above the last.")
      .def_readonly("outer", &Band::outer, "(n, 2) in the CRS, counter-clockwise, closed.")
      .def_readonly("holes", &Band::holes, "The same, clockwise.")
      .def("__repr__", [](const Band& b) {
        const auto text = [](const std::optional<double>& v) { return v ? fmt::format("{:.6g}", *v) : "open"; };
        return fmt::format("<retalho.Band {} to {}, {} holes>", text(b.low), text(b.high), b.holes.size());
      });
  band.attr("__module__") = "retalho";
  py::class_<Lines, std::shared_ptr<Lines>> lines(
      module, "Contours", "Level lines: a sequence of ContourLine, by level and then by where they start.");
  lines.def("__len__", [](const Lines& l) { return l.set.lines.size(); })
      .def("__getitem__", &line_at, py::arg("index"))
      .def("__iter__",
           [](const py::object& self) { return py::reinterpret_steal<py::iterator>(PySeqIter_New(self.ptr())); })
      .def_property_readonly(
          "levels", [](const Lines& l) { return py::array(py::cast(l.set.levels)); }, "Ascending heights.")
      .def_property_readonly(
          "points",
          [](const py::object& self) {
            const auto& l = py::cast<const Lines&>(self);
            return view<double>(l.points.data(), {count_of(l.points.size()), 2}, self);
          },
          "(n, 2): the points of all lines, one behind the other. A read-only view.")
      .def_property_readonly(
          "offsets",
          [](const py::object& self) {
            const auto& l = py::cast<const Lines&>(self);
            return view<std::uint64_t>(l.offsets.data(), {count_of(l.offsets.size())}, self);
          },
          "(lines + 1,): line i has points[offsets[i]:offsets[i + 1]]. A read-only view.")
      .def_property_readonly("bands", &bands_of,
                             "List of Band where asked for, else None. They cover the data exactly once.")
      .def_property_readonly(
          "singular", &singular_of,
          "List of (level, (xmin, ymin, xmax, ymax)): where lines were joined by a rule instead of a proof.")
      .def_property_readonly(
          "tolerance", [](const Lines& l) { return l.set.tolerance; },
          "No point of a line is farther from its level set, nor conversely; horizontal units.")
      .def_property_readonly(
          "crs", [](const Lines& l) { return crs_object(l.georef); }, "The CRS as WKT, or None.")
      .def("write", &write, py::arg("path"), py::kw_only(), py::arg("overwrite") = false, py::arg("index_every") = 5,
           "Writes the lines (the bands, where asked for) as .gpkg, .geojson, .shp or .dxf. Raises CannotWrite.")
      .def("__repr__", [](const Lines& l) {
        return fmt::format("<retalho.Contours {} lines at {} levels, {} points, tolerance {:.6g}, {}>",
                           l.set.lines.size(), l.set.levels.size(), l.points.size(), l.set.tolerance,
                           crs_title(l.georef));
      });
  lines.attr("__module__") = "retalho";
}

}  // namespace

std::vector<double> levels_of(const AskedLines& asked, double low, double high) {
  if (!asked.levels) {
    const double beyond = 0.25 * (high - low);
    return contour_levels(low - beyond, high + beyond, *asked.interval, asked.base);
  }
  std::vector<double> levels = *asked.levels;
  for (const double level : levels)
    if (!std::isfinite(level)) throw BadInput(fmt::format("levels holds {}", level), {}, "levels");
  std::sort(levels.begin(), levels.end());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

AskedLines parse_lines(const py::object& levels, std::optional<double> interval, double base,
                       std::optional<double> tolerance, bool simplify, bool bands) {
  if (levels.is_none() != interval.has_value())
    throw UsageError("say which levels: levels=[...], or interval=... (with base=...)", {}, "levels");
  if (tolerance && !(*tolerance > 0 && std::isfinite(*tolerance)))
    throw UsageError(fmt::format("tolerance must be above 0, not {}", *tolerance), {}, "tolerance");
  AskedLines asked{{}, interval, tolerance, base, simplify, bands};
  if (!levels.is_none()) asked.levels = as_vector(levels, "levels");
  return asked;
}

double line_cell(const Terrain& terrain) {
  if (terrain.grid.columns > 0) return std::min(terrain.grid.cell_width, terrain.grid.cell_height);
  double sum = 0;
  for (const auto& t : terrain.tin.triangles) sum += norm(terrain.tin.points[t[1]] - terrain.tin.points[t[0]]);
  return sum / static_cast<double>(std::max<std::size_t>(1, terrain.tin.triangles.size()));
}

py::object contours_object(ContourSet set, const Georef& georef, const AskedLines& asked) {
  return py::cast(finish(std::move(set), {}, georef, asked));
}

void add_contours(py::module_& module) {
  add_classes(module);
  module.def(
      "contours",
      [](const py::object& z, const py::object& levels, const py::object& transform, const py::object& crs,
         const py::object& nodata, std::optional<double> interval, double base, std::optional<double> tolerance,
         bool simplify, bool bands, const std::string& twist, const std::string& ends, bool keep_flats, int threads,
         const py::object& progress) {
        const AskedLines asked = parse_lines(levels, interval, base, tolerance, simplify, bands);
        const BicubicOptions surface = bicubic_options(twist, ends, keep_flats);
        const Running running{threads, progress};
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        return run(running, [&](const Context& context) { return trace_raster(*raster, asked, surface, context); });
      },
      py::arg("z"), py::arg("levels") = py::none(), py::kw_only(), py::arg("transform") = py::none(),
      py::arg("crs") = py::none(), py::arg("nodata") = py::none(), py::arg("interval") = py::none(),
      py::arg("base") = 0.0, py::arg("tolerance") = py::none(), py::arg("simplify") = true, py::arg("bands") = false,
      py::arg("twist") = "spline", py::arg("ends") = "not-a-knot", py::arg("keep_flats") = true, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Level lines of the smooth bicubic surface through a grid: none missed, none crossing.\n\n"
      "levels: heights; or interval (and base), height units. tolerance: how far lines may lie from the true level "
      "lines, horizontal units; None: a tenth of a cell. simplify: thin the vertices within it. bands: the regions "
      "between the levels as well. twist: spline, adini or zero; ends: not-a-knot or natural.");
  const auto terrain =
      py::reinterpret_borrow<py::class_<TerrainModel, std::shared_ptr<TerrainModel>>>(module.attr("Terrain"));
  auto defined = terrain;
  defined.def(
      "contours",
      [](const TerrainModel& model, const py::object& levels, std::optional<double> interval, double base,
         std::optional<double> tolerance, bool simplify, bool bands, int threads, const py::object& progress) {
        const AskedLines asked = parse_lines(levels, interval, base, tolerance, simplify, bands);
        return run(Running{threads, progress},
                   [&](const Context& context) { return trace_model(model, asked, context); });
      },
      py::arg("levels") = py::none(), py::kw_only(), py::arg("interval") = py::none(), py::arg("base") = 0.0,
      py::arg("tolerance") = py::none(), py::arg("simplify") = true, py::arg("bands") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Level lines of the surface; see retalho.contours. tolerance None: a tenth of a cell, or of a model of points "
      "of the mean edge. Bands of a model with cells without data are refused (BadInput).");
}

}  // namespace retalho::python
