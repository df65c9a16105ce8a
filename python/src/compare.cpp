#include "compare.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.h"
#include "budget.h"
#include "grid.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/model/baselines.h"
#include "retalho/model/comparison.h"
#include "retalho/model/tiled.h"
#include "retalho/tin/refine.h"
#include "retalho/visibility/model_map.h"
#include "running.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

/// A model to be compared: one in memory, or a file.
struct Rival {
  std::string name, path;
  std::shared_ptr<const TerrainModel> model;
};

struct Asked {
  AskedBudget budget;
  std::vector<Rival> models;
  bool baselines = false, visibility = false;
  IntervisibilityOptions sight;
};

/// The maps of what each model sees, less the grid's own, in the order of the reports.
struct Maps {
  std::vector<float> own;
  std::vector<std::vector<float>> differences;
  std::vector<MapDifference> sizes;
};

struct Compared {
  std::vector<ModelReport> reports;
  Maps maps;
  Shape shape;
};

Rival rival_of(const py::handle& thing, std::string name) {
  if (py::isinstance<TerrainModel>(thing)) {
    auto model = py::cast<std::shared_ptr<TerrainModel>>(thing);
    if (name.empty()) name = kind_text(facts_of(model->terrain()));
    return {std::move(name), {}, std::move(model)};
  }
  if (!py::isinstance<py::str>(thing) && !py::hasattr(thing, "__fspath__"))
    throw py::type_error("models must be Terrains or paths of model files, not " +
                         py::cast<std::string>(py::str(py::type::of(thing))));
  std::string path = path_text(py::reinterpret_borrow<py::object>(thing));
  return {name.empty() ? path : std::move(name), path, nullptr};
}

/// None, one model, a sequence of them, or a mapping from names to them.
std::vector<Rival> rivals_of(const py::object& models) {
  std::vector<Rival> rivals;
  if (models.is_none()) return rivals;
  if (py::isinstance<TerrainModel>(models) || py::isinstance<py::str>(models) || py::hasattr(models, "__fspath__")) {
    rivals.push_back(rival_of(models, {}));
  } else if (py::hasattr(models, "items")) {
    for (const py::handle pair : models.attr("items")()) {
      const auto both = py::cast<py::tuple>(pair);
      rivals.push_back(rival_of(both[1], py::cast<std::string>(py::str(both[0]))));
    }
  } else {
    for (const py::handle one : models) rivals.push_back(rival_of(one, {}));
  }
  if (rivals.empty()) throw UsageError("models is empty: leave it out to compare every kind of surface", {}, "models");
  return rivals;
}

/// Throws UsageError for what does not go together.
void check(const Asked& asked) {
  if (asked.models.empty() && !asked.budget.given())
    throw UsageError(
        "give models to compare with the grid, or vertices, max_error or ratio to compare every kind of surface", {},
        "models");
  if (!asked.models.empty() && asked.budget.given())
    throw UsageError("models and a budget (vertices, max_error, ratio) exclude each other: give one of them", {},
                     "models");
  if (asked.baselines && asked.visibility)
    throw UsageError("baselines and visibility exclude each other: ask for one after the other", {}, "baselines");
  resolve(asked.budget, 1, 1);
  if (asked.visibility && !(std::isfinite(asked.sight.radius) && asked.sight.radius >= 0))
    throw UsageError(fmt::format("visibility is a radius of 0 (no limit) or more, not {}", asked.sight.radius), {},
                     "visibility");
}

/// Its report and, of a file, whether it is compact.
ModelReport report_of(const Rival& rival, const Terrain& terrain, std::size_t bytes, const Raster& raster,
                      const Context& context) {
  ModelReport report = facts_of(terrain);
  report.name = rival.name;
  report.bytes = bytes;
  report.errors = assess(terrain, raster, terrain.tolerance, context);
  return report;
}

Compared compare(const Raster& raster, const Asked& asked, const Context& context) {
  Compared all;
  all.shape = {raster.rows, raster.columns};
  if (asked.visibility) all.maps.own = intervisibility_map(raster, asked.sight, context);
  const CompareMore look = [&](const Terrain& terrain, const ModelReport&) {
    if (!asked.visibility) return;
    std::vector<float> map = model_intervisibility(terrain, raster, asked.sight, context);
    all.maps.sizes.push_back(compare_maps(map, all.maps.own));
    for (std::size_t i = 0; i < map.size(); ++i) map[i] -= all.maps.own[i];
    all.maps.differences.push_back(std::move(map));
  };
  const auto add = [&](std::vector<ModelReport> more) {
    for (ModelReport& report : more) all.reports.push_back(std::move(report));
  };
  if (asked.models.empty()) {
    const RasterSummary summary = summarize(raster);
    const Budget budget = resolve(asked.budget, summary.valid, 0);
    const Tin tin = refine_tin(raster, {budget.max_error, budget.vertices}, context);
    add(compare_kinds(tin, raster, budget.max_error, look, context));
    if (asked.baselines) add(smooth_rivals(tin.vertex_count(), raster, context));
    return all;
  }
  for (const Rival& rival : asked.models) {
    context.check();
    std::optional<Model> read;
    ModelFileNotes notes;
    if (!rival.model) {
      read = load_model(rival.path, &notes);
      if (!std::holds_alternative<Terrain>(*read))
        throw BadInput(fmt::format("'{}' holds no terrain, but another kind of surface", rival.path), rival.path,
                       "models");
    }
    const Terrain& terrain = read ? std::get<Terrain>(*read) : rival.model->terrain();
    const std::size_t bytes = read ? model_size(rival.path) : encode_model(terrain).size();
    const ModelReport report = report_of(rival, terrain, bytes, raster, context);
    look(terrain, report);
    all.reports.push_back(report);
    if (asked.baselines)
      add(flat_baselines({report.name, report.numbers, report.bytes, notes.compact}, raster, context));
  }
  return all;
}

py::list table_of(Compared all) {
  py::list table;
  for (std::size_t i = 0; i < all.reports.size(); ++i) {
    const ModelReport& r = all.reports[i];
    py::dict d;
    d["name"] = r.name;
    d["surface"] = r.surface;
    d["gradients"] = r.gradients;
    if (!r.cross_derivative.empty()) d["cross_derivative"] = r.cross_derivative;
    d["vertices"] = r.vertices;
    d["triangles"] = r.triangles;
    d["coefficients"] = r.coefficients;
    d["numbers"] = r.numbers;
    d["bytes"] = r.bytes;
    d["rmse"] = r.errors.rmse;
    d["max_error"] = r.errors.max_error;
    d["max_error_at"] = py::make_tuple(r.errors.max_error_at.x, r.errors.max_error_at.y);
    d["slope_rmse"] = r.errors.slope_rmse;
    d["cells"] = r.errors.cells;
    d["valid_cells"] = r.errors.valid_cells;
    d["uncovered"] = r.errors.uncovered;
    d["violations"] = r.errors.violations;
    if (!all.maps.sizes.empty()) {
      const MapDifference& size = all.maps.sizes[i];
      d["visibility_rmse"] = size.rmse;
      d["visibility_max"] = size.maximum;
      d["visibility_mean"] = size.mean;
      d["visibility_cells"] = size.cells;
      d["visibility_difference"] = own<float>(std::move(all.maps.differences[i]), all.shape);
    }
    table.append(d);
  }
  return table;
}

}  // namespace

void add_compare(py::module_& module) {
  module.def(
      "compare",
      [](const py::object& z, const py::object& models, const py::object& transform, const py::object& crs,
         const py::object& nodata, std::optional<double> max_error, std::optional<long long> vertices,
         std::optional<double> ratio, bool baselines, std::optional<double> visibility, int directions,
         double observer_height, double target_height, int threads, const py::object& progress) {
        const Asked asked{{max_error, ratio, vertices},
                          rivals_of(models),
                          baselines,
                          visibility.has_value(),
                          {directions, observer_height, target_height, visibility.value_or(0)}};
        check(asked);
        const Running running{threads, progress};
        const auto raster = raster_of(z, {transform, crs, nodata}, running);
        return table_of(run(running, [&](const Context& context) { return compare(*raster, asked, context); }));
      },
      py::arg("z"), py::arg("models") = py::none(), py::kw_only(), py::arg("transform") = py::none(),
      py::arg("crs") = py::none(), py::arg("nodata") = py::none(), py::arg("max_error") = py::none(),
      py::arg("vertices") = py::none(), py::arg("ratio") = py::none(), py::arg("baselines") = false,
      py::arg("visibility") = py::none(), py::arg("directions") = 180, py::arg("observer_height") = 2.0,
      py::arg("target_height") = 0.0, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "A table of models against the grid that they stand for, one dict each: pandas.DataFrame takes it.\n\n"
      "models: a Terrain or the path of a model, a list of them, or a dict from names to them. None: every kind of "
      "surface on one triangulation, which max_error, vertices or ratio choose as for fit(refine='flat'). Keys: name, "
      "surface, gradients, vertices, triangles, coefficients, numbers, bytes (of the model file), rmse, max_error, "
      "max_error_at, slope_rmse, cells, valid_cells, uncovered, violations, as ErrorReport has them. baselines: beside "
      "each model flat surfaces with its numbers and with its bytes (docs/compare.md); without models smooth ones "
      "beside "
      "the strong flat one. visibility: intervisibility maps are compared, too, of cells within that radius (0: no "
      "limit), with directions and heights as intervisibility has them: visibility_rmse, visibility_max, "
      "visibility_mean "
      "in cells, visibility_cells, and visibility_difference, float32 (rows, columns), the model's map less the "
      "grid's.");
}

}  // namespace retalho::python
