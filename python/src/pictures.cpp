// retalho.render and retalho.map_sheet: pictures of grids and models.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bicubic.h"
#include "contours.h"
#include "grid.h"
#include "model.h"
#include "pictures.h"
#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/level/contour.h"
#include "retalho/render/contour_sheet.h"
#include "retalho/render/perspective.h"
#include "retalho/render/surface_comparison.h"
#include "retalho/terrain/height_range.h"
#include "running.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

constexpr int kProbe = 256;           // a side of the window in which ranges are looked for
constexpr double kTracedShare = 0.2;  // of the tolerance, where curves are fitted to the lines

/// A grid or a model, which it keeps alive.
struct Surface {
  std::shared_ptr<const Raster> raster;
  std::shared_ptr<const TerrainModel> model;

  Surface(const py::object& z, const Placing& placing, const Running& running) {
    if (py::isinstance<TerrainModel>(z)) {
      if (!placing.transform.is_none() || !placing.crs.is_none() || !placing.nodata.is_none())
        throw UsageError("z is a Terrain, which says itself where it lies: leave transform, crs and nodata out", {},
                         "transform");
      model = py::cast<std::shared_ptr<TerrainModel>>(z);
      return;
    }
    raster = raster_of(z, placing, running);
  }

  const Georef& georef() const { return raster ? raster->georef : model->terrain().georef; }
  Extent extent() const { return raster ? extent_of(*raster) : extent_of(model->terrain()); }
  FieldSource source(const Context& context) const {
    return raster ? field_of(*raster) : field_of(model->evaluator(context));
  }
};

struct View {
  int width = 0, height = 0;
  bool perspective = false;
  ReliefOptions relief;
  std::optional<double> exaggeration;
  std::optional<std::pair<double, double>> limits;
  double from = 200, elevation = 35;
};

View view_of(const std::pair<int, int>& size, const std::string& view, const std::string& colors,
             const std::pair<double, double>& light, std::optional<double> exaggeration,
             const std::optional<std::pair<double, double>>& limits, double from, double elevation) {
  View out;
  std::tie(out.width, out.height) = size;
  check_size(size);
  if (view != "plan" && view != "perspective")
    throw UsageError("view must be 'plan' or 'perspective', not '" + view + "'", {}, "view");
  if (colors != "hypsometric" && colors != "gray")
    throw UsageError("colors must be 'hypsometric' or 'gray', not '" + colors + "'", {}, "colors");
  if (!std::isfinite(light.first) || !(light.second > 0 && light.second <= 90))
    throw UsageError("light must be (azimuth, altitude), degrees, the altitude above 0 and at most 90", {}, "light");
  if (exaggeration && !(*exaggeration > 0 && std::isfinite(*exaggeration)))
    throw UsageError("exaggeration must be above 0", {}, "exaggeration");
  if (!(elevation > 0 && elevation < 90) || !std::isfinite(from))
    throw UsageError("from_ is an azimuth and elevation lies between 0 and 90 degrees", {}, "elevation");
  out.perspective = view == "perspective";
  out.relief.ramp = colors == "gray" ? ColorRamp::gray : ColorRamp::hypsometric;
  out.relief.azimuth = light.first;
  out.relief.altitude = light.second;
  out.exaggeration = exaggeration;
  if (limits && !(limits->first < limits->second && std::isfinite(limits->first) && std::isfinite(limits->second)))
    throw UsageError(fmt::format("limits must be (low, high), not ({}, {})", limits->first, limits->second), {},
                     "limits");
  out.limits = limits;
  out.from = from;
  out.elevation = elevation;
  return out;
}

/// `truth`: coloured by the difference from it, blue below to red above.
Image draw(const Surface& surface, const Surface* truth, const View& view, const Context& context) {
  const FieldSource source = surface.source(context);
  const Extent extent = surface.extent();
  const Window probe = fit_window(surface.georef(), extent, kProbe, kProbe);
  ReliefOptions relief = view.relief;
  const Range range = height_range(source, probe, context);
  relief.low = range.low;
  relief.high = range.high;
  relief.exaggeration = view.exaggeration ? *view.exaggeration : good_exaggeration(source, probe, context);
  FieldSource color;
  if (truth != nullptr) {
    color = difference_of(source, truth->source(context));
    const Range errors = height_range(color, probe, context);
    relief.ramp = ColorRamp::diverging;
    relief.high = std::max(std::abs(errors.low), std::abs(errors.high));
    relief.low = -relief.high;
  }
  if (view.limits) std::tie(relief.low, relief.high) = *view.limits;
  if (!view.perspective)
    return shade_relief(source, fit_window(surface.georef(), extent, view.width, view.height), relief, color, context);
  PerspectiveOptions options;
  options.relief = relief;
  options.from = view.from;
  options.elevation = view.elevation;
  options.base = range.low - 0.1 * (range.high - range.low);
  return draw_perspective(source, surface.georef(), extent, view.width, view.height, options, color, context);
}

/// What a map sheet shows.
struct Sheet {
  SheetContent content;
  ContourSet lines;
  ContourExtras extras;
  SheetOptions options;
};

Sheet make_sheet(const Surface& surface, const AskedLines& asked, bool curves, const Context& context) {
  Sheet sheet;
  std::optional<BicubicGrid> grid;
  double low = 0, high = 0, cell = 1;
  if (surface.raster) {
    const RasterSummary summary = summarize(*surface.raster);
    if (summary.valid == 0) throw BadInput("z holds no data", {}, "z");
    low = summary.minimum;
    high = summary.maximum;
    cell = std::min(surface.raster->cell_width, surface.raster->cell_height);
    grid = make_bicubic(*surface.raster, {}, context);
    sheet.content.height_unit = surface.raster->height_unit;
  } else {
    const Terrain& terrain = surface.model->terrain();
    const HeightRange range = height_range(terrain);
    low = range.low;
    high = range.high;
    cell = line_cell(terrain);
  }
  const std::vector<double> levels = levels_of(asked, low, high);
  const double tolerance = asked.tolerance.value_or(0.1 * cell);
  const auto trace = [&](const ContourOptions& how, bool bands) {
    sheet.extras.want_bands = bands;
    return grid ? trace_contours(*grid, levels, how, context, &sheet.extras)
                : trace_contours(surface.model->terrain(), levels, how, context, &sheet.extras);
  };
  // Curves are fitted to every traced vertex; tints need no more than polylines do.
  if (curves && asked.bands) trace({tolerance, true}, true);
  const BandSet tints = std::move(sheet.extras.bands);
  sheet.lines = trace({curves ? kTracedShare * tolerance : tolerance, !curves}, asked.bands && !curves);
  if (curves) sheet.extras.bands = tints;
  const double least = spot_prominence(levels, low, high);
  sheet.content.spots =
      grid ? find_spot_heights(*grid, least, context) : find_spot_heights(surface.model->terrain(), least, context);
  sheet.content.georef = surface.georef();
  sheet.content.extent = grid ? extent_of(*grid) : surface.extent();
  sheet.content.low = low;
  sheet.content.high = high;
  sheet.options.curves = curves;
  sheet.options.tolerance = tolerance;
  sheet.options.traced = curves ? sheet.lines.tolerance : 0;
  return sheet;
}

py::dict write_sheet(const Surface& surface, const std::string& path, const AskedLines& asked, bool curves,
                     const std::string& title, const std::string& size, const VectorOptions& file,
                     const Running& running) {
  const bool pdf = path.ends_with(".pdf");
  if (!pdf && !path.ends_with(".svg"))
    throw UsageError("'" + path + "' must end in .svg or .pdf, which name the form of a map sheet", path, "path");
  sheet_size(size, 1);  // a bad one is said before the work
  SheetReport report;
  run(running, [&](const Context& context) {
    Sheet sheet = make_sheet(surface, asked, curves, context);
    sheet.content.lines = &sheet.lines;
    sheet.content.bands = asked.bands ? &sheet.extras.bands : nullptr;
    sheet.content.index = index_levels(sheet.lines.levels, file);
    sheet.options.size = sheet_size(size, sheet.content.extent.width() / sheet.content.extent.height());
    sheet.options.title = title;
    sheet.options.crs_name = crs_title(sheet.content.georef);
    sheet.options.levels = level_words(sheet.lines.levels, sheet.content.height_unit, file);
    write_file(path, contour_sheet(sheet.content, sheet.options, pdf, report, context), file.overwrite);
  });
  py::dict d;
  d["mm_per_unit"] = report.scale;
  d["labels"] = report.labels;
  d["spots"] = report.spots;
  d["curves"] = report.curves;
  return d;
}

/// The names of the surfaces that were drawn.
std::vector<std::string> draw_comparison(const Raster& raster, const AskedLines& asked, int zoom,
                                         const std::string& path, const VectorOptions& file, const Context& context) {
  const Raster part = middle_of(raster, zoom);
  const RasterSummary shown = summarize(part);
  if (shown.valid == 0) throw BadInput("the part that is shown has no data: zoom=0 shows all", {}, "zoom");
  SurfaceComparison comparison;
  comparison.levels = levels_of(asked, shown.minimum, shown.maximum);
  comparison.index = index_levels(comparison.levels, file);
  comparison.tolerance = asked.tolerance.value_or(0.02 * std::min(part.cell_width, part.cell_height));
  const ComparedSurfaces drawn = compare_grid_surfaces(part, comparison, context);
  write_picture(drawn.picture, path, file.overwrite);
  return drawn.names;
}

}  // namespace

py::array pixels_of(Image image) {
  const Shape shape{image.height, image.width, 3};
  return own<std::uint8_t>(std::move(image.pixels), shape);
}

void check_size(const std::pair<int, int>& size) {
  const auto [width, height] = size;
  if (width < 16 || height < 16 || width > 20000 || height > 20000)
    throw UsageError(fmt::format("size must be (width, height), 16 to 20,000 pixels each, not ({}, {})", width, height),
                     {}, "size");
}

void add_pictures(py::module_& module) {
  module.def(
      "render",
      [](const py::object& z, const py::object& transform, const py::object& crs, const py::object& nodata,
         const std::pair<int, int>& size, const std::string& view, const std::string& colors,
         const std::pair<double, double>& light, std::optional<double> exaggeration, double from, double elevation,
         const std::optional<std::pair<double, double>>& limits, const py::object& error, int threads,
         const py::object& progress) {
        const View how = view_of(size, view, colors, light, exaggeration, limits, from, elevation);
        const Running running{threads, progress};
        const Surface surface(z, {transform, crs, nodata}, running);
        std::optional<Surface> truth;
        if (!error.is_none()) truth.emplace(error, Placing{}, running);
        return pixels_of(run(
            running, [&](const Context& context) { return draw(surface, truth ? &*truth : nullptr, how, context); }));
      },
      py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("size") = std::pair{640, 480}, py::arg("view") = "plan",
      py::arg("colors") = "hypsometric", py::arg("light") = std::pair{315.0, 45.0},
      py::arg("exaggeration") = py::none(), py::arg("from_") = 200.0, py::arg("elevation") = 35.0,
      py::arg("limits") = py::none(), py::arg("error") = py::none(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "A picture of a grid or a Terrain, uint8 (height, width, 3), white where there is no data.\n\n"
      "size: (width, height) in pixels. view: plan, shaded relief from above; or perspective, from the azimuth from_ "
      "and so many degrees (elevation) over the horizon. colors: hypsometric or gray. light: (azimuth, altitude), "
      "degrees. exaggeration: of heights; None: chosen by the slopes. error: a grid or Terrain; the colours are then "
      "the difference from it, blue below to red above. limits: (low, high), the heights (or differences) at the ends "
      "of the colours, for pictures that are to be laid side by side; None: the picture's own.");
  module.def(
      "compare_surfaces",
      [](const py::object& z, const py::object& path, const py::object& levels, const py::object& transform,
         const py::object& crs, const py::object& nodata, std::optional<double> interval, double base,
         std::optional<double> tolerance, int zoom, int index_every, bool overwrite, int threads,
         const py::object& progress) {
        const AskedLines asked = parse_lines(levels, interval, base, tolerance, true, false);
        const Running running{threads, progress};
        const std::string name = path_text(path);
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        return run(running, [&](const Context& context) {
          return draw_comparison(*raster, asked, zoom, name, {overwrite, index_every, base, interval.value_or(0)},
                                 context);
        });
      },
      py::arg("z"), py::arg("path"), py::arg("levels") = py::none(), py::kw_only(), py::arg("transform") = py::none(),
      py::arg("crs") = py::none(), py::arg("nodata") = py::none(), py::arg("interval") = py::none(),
      py::arg("base") = 0.0, py::arg("tolerance") = py::none(), py::arg("zoom") = 48, py::arg("index_every") = 5,
      py::arg("overwrite") = false, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "A picture (.svg, .pdf or .png) of the level lines of every surface through all cells of a grid, side by side: "
      "to "
      "choose one by. levels, interval, base: as retalho.contours has them; tolerance None: a fiftieth of a cell. "
      "zoom: "
      "so many cells a side, of the grid's middle; 0: all. The names of the surfaces. Raises UsageError for more than "
      "a "
      "million cells.");
  module.def(
      "map_sheet",
      [](const py::object& z, const py::object& path, const py::object& levels, const py::object& transform,
         const py::object& crs, const py::object& nodata, std::optional<double> interval, double base,
         std::optional<double> tolerance, bool bands, bool curves, const std::string& title, const std::string& size,
         int index_every, bool overwrite, int threads, const py::object& progress) {
        const AskedLines asked = parse_lines(levels, interval, base, tolerance, true, bands);
        const Running running{threads, progress};
        const std::string name = path_text(path);
        const Surface surface(z, {transform, crs, nodata}, running);
        return write_sheet(surface, name, asked, curves, title, size,
                           {overwrite, index_every, base, interval.value_or(0)}, running);
      },
      py::arg("z"), py::arg("path"), py::arg("levels") = py::none(), py::kw_only(), py::arg("transform") = py::none(),
      py::arg("crs") = py::none(), py::arg("nodata") = py::none(), py::arg("interval") = py::none(),
      py::arg("base") = 0.0, py::arg("tolerance") = py::none(), py::arg("bands") = false, py::arg("curves") = false,
      py::arg("title") = "", py::arg("size") = "A4", py::arg("index_every") = 5, py::arg("overwrite") = false,
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "Contour lines of a grid or a Terrain as a finished map, .svg or .pdf (docs/contours.md, \"Map sheets\"): index "
      "contours, labels, spot heights, a frame with coordinates, a scale bar.\n\n"
      "levels, interval, base, tolerance: as retalho.contours has them. bands: tints between the levels. curves: cubic "
      "Bezier curves within the tolerance instead of polylines. size: A0 to A6, or WIDTHxHEIGHT in mm. {mm_per_unit, "
      "labels, spots, curves}.");
}

}  // namespace retalho::python
