#include "formats.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <string>

#include "arrays.h"
#include "budget.h"
#include "grid.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/mesh/globe_mesh.h"
#include "retalho/model/compact.h"
#include "running.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

CompactOptions compact_options(const AskedBudget& asked, const std::string& surface, const std::string& fit,
                               const std::optional<std::string>& creases, const std::string& effort) {
  CompactOptions options;
  if (!asked.given())
    throw UsageError("give max_error, vertices or both; ratio is vertices as a share of the cells", {}, "max_error");
  resolve(asked, 1, 1);
  if (asked.max_error && !(*asked.max_error > 0))
    throw UsageError(fmt::format("max_error must be over 0, not {}", *asked.max_error), {}, "max_error");
  const std::optional<SurfaceKind> kind = parse_surface(surface);
  if (!kind || *kind == SurfaceKind::powell_sabin)
    throw UsageError("surface must be 'linear' or 'clough-tocher', not '" + surface + "'", {}, "surface");
  if (fit != "least-squares" && fit != "z-only")
    throw UsageError("fit must be 'least-squares' or 'z-only', not '" + fit + "'", {}, "fit");
  if (fit == "z-only" && *kind == SurfaceKind::linear)
    throw UsageError("fit='z-only' is for surface='clough-tocher'", {}, "fit");
  options.surface = *kind;
  options.heights_only = fit == "z-only";
  if (creases && *creases != "auto" && *creases != "none")
    throw UsageError("creases of a compact file must be 'auto' or 'none', not '" + *creases + "'", {}, "creases");
  if (creases == "auto" && (*kind == SurfaceKind::linear || options.heights_only))
    throw UsageError("creases='auto' folds vertices that have gradients: leave surface and fit out", {}, "creases");
  if (creases) options.folds = *creases == "auto";
  if (effort != "fast" && effort != "normal" && effort != "best")
    throw UsageError("effort must be 'fast', 'normal' or 'best', not '" + effort + "'", {}, "effort");
  options.effort = effort == "fast" ? Effort::fast : effort == "best" ? Effort::best : Effort::normal;
  return options;
}

py::dict notes_of(const GlobeNotes& notes) {
  py::dict d;
  d["tiles"] = notes.tiles;
  d["levels"] = notes.levels;
  d["triangles"] = notes.triangles;
  d["bytes"] = notes.bytes;
  d["step"] = notes.step;
  return d;
}

}  // namespace

void add_formats(py::module_& module) {
  module.def(
      "fit_compact",
      [](const py::object& z, const py::object& transform, const py::object& crs, const py::object& nodata,
         std::optional<double> max_error, std::optional<long long> vertices, std::optional<double> ratio,
         const std::string& surface, const std::string& fit, const std::optional<std::string>& creases,
         const std::string& effort, int threads, const py::object& progress) {
        const AskedBudget asked{max_error, ratio, vertices};
        CompactOptions options = compact_options(asked, surface, fit, creases, effort);
        const Running running{threads, progress};
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        const CompactModel model = run(running, [&](const Context& context) {
          const Budget budget = resolve(asked, summarize(*raster).valid, 0);
          options.max_error = budget.max_error;
          options.vertices = budget.vertices;
          return fit_compact(*raster, options, context);
        });
        return py::bytes(model.bytes);
      },
      py::arg("z"), py::kw_only(), py::arg("transform") = py::none(), py::arg("crs") = py::none(),
      py::arg("nodata") = py::none(), py::arg("max_error") = py::none(), py::arg("vertices") = py::none(),
      py::arg("ratio") = py::none(), py::arg("surface") = "clough-tocher", py::arg("fit") = "least-squares",
      py::arg("creases") = py::none(), py::arg("effort") = "normal", py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "An elevation grid to the bytes of a compact model file (from_bytes reads them): refined by the surface itself "
      "and rounded, with every valid cell within max_error of what is read back; vertices or ratio: a budget. surface: "
      "linear or clough-tocher. fit: least-squares or z-only. creases: auto folds clough-tocher at vertices beside "
      "steps "
      "(what max_error does by itself), none keeps it smooth. effort: fast, normal or best, as fit has it.");
  auto terrain =
      py::reinterpret_borrow<py::class_<TerrainModel, std::shared_ptr<TerrainModel>>>(module.attr("Terrain"));
  terrain.def(
      "write_quantized_mesh",
      [](const TerrainModel& model, const py::object& folder, double tolerance, int level, double outside, bool normals,
         bool gzip, bool overwrite, int threads, const py::object& progress) {
        const std::string path = path_text(folder);
        if (level < -1) throw UsageError(fmt::format("level must be 0 or more, not {}", level), {}, "level");
        return notes_of(run(Running{threads, progress}, [&](const Context& context) {
          return write_quantized_mesh(TerrainEvaluator(model.terrain(), context), path,
                                      {tolerance, level, outside, normals, gzip}, overwrite, context);
        }));
      },
      py::arg("folder"), py::kw_only(), py::arg("tolerance") = 0.0, py::arg("level") = -1, py::arg("outside") = 0.0,
      py::arg("normals") = true, py::arg("gzip") = true, py::arg("overwrite") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Tiles for viewers of the globe, quantized-mesh 1.0: {level}/{x}/{y}.terrain and layer.json (docs/formats.md). "
      "level: "
      "the finest; -1: as fine as the model's cells. outside: the height where there is no data. What was written, as "
      "a "
      "dictionary: tiles, levels, triangles, bytes, step (of the heights). Raises BadInput without a CRS.");
  terrain.def(
      "write_tileset",
      [](const TerrainModel& model, const py::object& folder, double tolerance, long long triangles, bool overwrite,
         int threads, const py::object& progress) {
        const std::string path = path_text(folder);
        if (triangles < 1)
          throw UsageError(fmt::format("triangles must be 1 or more, not {}", triangles), {}, "triangles");
        return notes_of(run(Running{threads, progress}, [&](const Context& context) {
          return write_tileset(model.terrain(), path, {tolerance, static_cast<std::size_t>(triangles)}, overwrite,
                               context);
        }));
      },
      py::arg("folder"), py::kw_only(), py::arg("tolerance") = 0.0, py::arg("triangles") = 65536,
      py::arg("overwrite") = false, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The surface as 3D Tiles 1.1: tileset.json and a .glb a tile of about so many triangles (docs/formats.md). What "
      "was "
      "written, as a dictionary (step: the tolerance). Raises BadInput without a CRS.");
}

}  // namespace retalho::python
