#include "tiled_model.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "arrays.h"
#include "contours.h"
#include "grid.h"
#include "model.h"
#include "quantity.h"
#include "retalho/core/error.h"
#include "retalho/level/tile_lines.h"
#include "retalho/level/write_vector.h"
#include "retalho/mesh/terrain_mesh.h"
#include "retalho/mesh/tile_mesh.h"
#include "retalho/raster/io.h"
#include "retalho/raster/part.h"
#include "retalho/tiles/sampled_raster.h"
#include "retalho/tiles/source.h"
#include "running.h"
#include "terrain.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

using Holder = std::shared_ptr<TiledModel>;
using Class = py::class_<TiledModel, Holder>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kRows = 64;  // sampled at a time

Holder open(const py::object& folder, double memory) {
  if (!(memory >= 1 && memory < 1e9))
    throw UsageError(fmt::format("memory must be 1 (MB) or more, not {}", memory), {}, "memory");
  const std::string path = path_text(folder);
  const auto bound = static_cast<std::size_t>(memory * 1048576);
  return run(Running{1}, [&](const Context&) { return std::make_shared<TiledModel>(path, bound); });
}

GridDomain domain_of(const TiledIndex& index) {
  GridDomain grid;
  grid.columns = index.columns;
  grid.rows = index.rows;
  grid.cell_width = index.cell_width;
  grid.cell_height = index.cell_height;
  return grid;
}

/// Asked tile by tile, whatever their order: each tile is read once.
std::vector<double> values_at(const TiledModel& model, const Pair& xy, What what, const Context& context) {
  const TiledIndex& index = model.index();
  const auto width = static_cast<std::size_t>(kQuantities[what].width);
  std::vector<double> out(xy.size() * width, kNan);
  std::vector<std::pair<std::int64_t, std::size_t>> order;
  for (std::size_t i = 0; i < xy.size(); ++i) {
    const Vec2 p = index.georef.to_local(xy.at(i));
    const double column = p.x / index.cell_width / index.tile_size, row = -p.y / index.cell_height / index.tile_size;
    if (!(std::abs(column) < 1e6 && std::abs(row) < 1e6)) continue;  // far out, or not a number: no data
    order.emplace_back(
        static_cast<std::int64_t>(std::floor(row)) * 2000000 + static_cast<std::int64_t>(std::floor(column)), i);
  }
  std::sort(order.begin(), order.end());
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k % 4096 == 0) context.check();
    const std::size_t i = order[k].second;
    if (const auto jet = model.reader().jet(index.georef.to_local(xy.at(i)))) put(what, *jet, out.data() + i * width);
  }
  return out;
}

py::object ask(const TiledModel& model, const py::object& x, const py::object& y, What what) {
  const Pair xy = broadcast(x, y, "x and y");
  std::vector<double> values =
      run(Running{1}, [&](const Context& context) { return values_at(model, xy, what, context); });
  Shape shape = xy.shape;
  if (kQuantities[what].width > 1) shape.push_back(kQuantities[what].width);
  return shaped(std::move(values), shape);
}

std::vector<double> values_on(const TiledModel& model, const Cells& cells, What what, const Context& context) {
  const auto width = static_cast<std::size_t>(kQuantities[what].width),
             columns = static_cast<std::size_t>(cells.columns);
  std::vector<double> out(columns * static_cast<std::size_t>(cells.rows) * width, kNan);
  std::vector<double> heights;
  std::vector<Vec2> gradients;
  for (int first = 0; first < cells.rows; first += kRows) {
    const int some = std::min(kRows, cells.rows - first);
    const std::size_t from = static_cast<std::size_t>(first) * columns,
                      count = static_cast<std::size_t>(some) * columns;
    if (what == curvature) {  // needs second derivatives
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t column = k % columns, row = static_cast<std::size_t>(first) + k / columns;
        const auto c = static_cast<double>(column), r = static_cast<double>(row);
        const auto jet = model.reader().jet({cells.origin.x + c * cells.step.x, cells.origin.y - r * cells.step.y});
        if (jet) put(what, *jet, out.data() + from + k);
      }
      context.check();
    } else {
      heights.assign(count, kNan);
      gradients.assign(what == height ? 0 : count, {});
      sample_rows(model.reader(), {cells.origin, cells.step, cells.columns, first, some}, heights, gradients, context);
      for (std::size_t k = 0; k < count; ++k)
        if (!std::isnan(heights[k]))
          put(what, {heights[k], what == height ? Vec2{} : gradients[k], 0, 0, 0}, out.data() + (from + k) * width);
    }
    context.report("sample", static_cast<double>(first + some) / cells.rows);
  }
  return out;
}

py::object sample(const TiledModel& model, const py::object& transform, const py::object& shape,
                  const std::string& what, const Running& running) {
  const What quantity = parse_what(what);
  const Cells cells = cells_of(model.index().georef, domain_of(model.index()), transform, shape);
  std::vector<double> values =
      run(running, [&](const Context& context) { return values_on(model, cells, quantity, context); });
  Shape result{cells.rows, cells.columns};
  if (kQuantities[quantity].width > 1) result.push_back(kQuantities[quantity].width);
  return own<double>(std::move(values), result);
}

py::dict write_raster_of(const TiledModel& model, const py::object& path, const py::object& transform,
                         const py::object& shape, const std::string& what, bool cog, bool overwrite,
                         const Running& running) {
  static const std::array<const char*, 4> names{"height", "slope", "aspect", "curvature"};
  const auto* const found = std::find(names.begin(), names.end(), what);
  if (found == names.end())
    throw UsageError("what must be 'height', 'slope', 'aspect' or 'curvature', not '" + what + "'", {}, "what");
  const auto quantity = static_cast<SampledQuantity>(found - names.begin());
  const std::string name = path_text(path);
  const WriteOptions how = write_options(name, cog, overwrite);
  const TiledIndex& index = model.index();
  const Cells cells = cells_of(index.georef, domain_of(index), transform, shape);
  SampledRaster raster{{}, cells.origin, cells.step};
  raster.place.columns = cells.columns;
  raster.place.rows = cells.rows;
  raster.place.cell_width = cells.step.x;
  raster.place.cell_height = cells.step.y;
  raster.place.georef = index.georef;
  const Vec2 corner = index.georef.to_crs(cells.origin);
  raster.place.georef.origin_x = corner.x;
  raster.place.georef.origin_y = corner.y;
  const std::size_t valid = run(running, [&](const Context& context) {
    return write_sampled(model.reader(), raster, quantity, name, how, context);
  });
  py::dict d;
  d["rows"] = cells.rows;
  d["columns"] = cells.columns;
  d["valid_cells"] = valid;
  return d;
}

Grid window(const TiledModel& model, int row, int column, int rows, int columns, const Running& running) {
  return {std::make_shared<const Raster>(run(running, [&](const Context& context) {
    return raster_of_window(model.reader(), {column, row, columns, rows}, context);
  }))};
}

std::shared_ptr<TerrainModel> part(const TiledModel& model, const py::object& bounds) {
  const std::vector<double> box = as_vector(bounds, "bounds");
  if (box.size() != 4 || !(box[0] <= box[2] && box[1] <= box[3]))
    throw BadInput("bounds must be four numbers (left, bottom, right, top) in the CRS", {}, "bounds");
  const TiledIndex& index = model.index();
  return std::make_shared<TerrainModel>(run(Running{1}, [&](const Context&) {
    return load_tiled_part(model.folder(), [&](const TileEntry& entry) {
      const CellWindow& w = entry.cells;
      const auto corner = [&](int column, int row) {
        return index.georef.to_crs({column * index.cell_width, -row * index.cell_height});
      };
      const Vec2 a = corner(w.column, w.row + w.rows - 1), b = corner(w.column + w.columns - 1, w.row);
      return a.x <= box[2] && b.x >= box[0] && a.y <= box[3] && b.y >= box[1];
    });
  }));
}

/// Calls trace(tiles, range, levels, options) with what the lines are made of.
template <class Trace>
auto with_lines(const TiledModel& model, const AskedLines& asked, const Context& context, const Trace& trace) {
  const TileSource tiles = tile_source(model.folder(), model.bound());
  const SurfaceRange range = measure_range(tiles, context);
  if (!range.data) throw CannotRead(fmt::format("no tile of '{}' holds any data", model.folder()), model.folder());
  const ContourOptions options{asked.tolerance.value_or(0.1 * std::min(tiles.cell_width, tiles.cell_height)),
                               asked.simplify};
  return trace(tiles, range, levels_of(asked, range.low, range.high), options);
}

void append(ContourSet& all, const ContourSet& set) {
  for (ContourLine line : set.lines) {
    const auto from = set.points.begin() + static_cast<std::ptrdiff_t>(line.begin),
               to = set.points.begin() + static_cast<std::ptrdiff_t>(line.end);
    line.begin = all.points.size();
    all.points.insert(all.points.end(), from, to);
    line.end = all.points.size();
    all.lines.push_back(line);
  }
}

py::object contours(const TiledModel& model, const AskedLines& asked, const Running& running) {
  ContourSet set = run(running, [&](const Context& context) {
    return with_lines(
        model, asked, context, [&](const auto& tiles, const auto& range, auto levels, const auto& options) {
          ContourSet all;
          ContourSet facts = stream_contours(
              tiles, range, std::move(levels), options, [&](const ContourSet& lines) { append(all, lines); }, context);
          std::stable_sort(all.lines.begin(), all.lines.end(),
                           [](const ContourLine& a, const ContourLine& b) { return a.level < b.level; });
          append(facts, all);
          return facts;
        });
  });
  return contours_object(std::move(set), model.index().georef, asked);
}

py::dict write_contours_of(const TiledModel& model, const py::object& path, const AskedLines& asked, bool overwrite,
                           int index_every, const Running& running) {
  const std::string name = path_text(path);
  const VectorOptions file{overwrite, index_every, asked.base, asked.interval.value_or(0)};
  std::size_t lines = 0, points = 0, levels_asked = 0;
  run(running, [&](const Context& context) {
    with_lines(model, asked, context, [&](const auto& tiles, const auto& range, auto levels, const auto& options) {
      levels_asked = levels.size();
      write_contours(tiles.georef, name, file, context, [&](const TakeContours& take) {
        stream_contours(
            tiles, range, std::move(levels), options,
            [&](const ContourSet& set) {
              lines += set.lines.size();
              for (const ContourLine& line : set.lines) points += line.end - line.begin;
              take(set);
            },
            context);
      });
    });
  });
  py::dict d;
  d["levels"] = levels_asked;
  d["lines"] = lines;
  d["points"] = points;
  return d;
}

py::dict write_mesh_of(const TiledModel& model, const py::object& path, double tolerance, bool overwrite,
                       const Running& running) {
  const std::string name = path_text(path);
  double used = 0;
  const TileMeshFacts facts = run(running, [&](const Context& context) {
    const TileSource tiles = tile_source(model.folder(), model.bound());
    const SurfaceRange range = measure_range(tiles, context);
    used = mesh_tolerance(range.low, range.high, {.tolerance = tolerance});
    return write_tile_mesh(tiles, used, name, overwrite, context);
  });
  py::dict d;
  d["vertices"] = facts.vertices;
  d["triangles"] = facts.triangles;
  d["tolerance"] = used;
  d["watertight"] = facts.check.watertight();
  d["boundary_edges"] = facts.check.boundary_edges;
  d["components"] = facts.check.components;
  return d;
}

ErrorReport compare(const TiledModel& model, const py::object& z, const Running& running) {
  if (py::isinstance<py::str>(z) || py::hasattr(z, "__fspath__")) {  // read by windows, too
    const std::string path = path_text(z);
    if (!same_grid(model.index(), inspect_raster(path)))
      throw BadInput(fmt::format("'{}' is not the grid that the model was made from: its size, its place or its cells "
                                 "are others (Terrain.compare takes any grid)",
                                 path),
                     path, "z");
    return run(running, [&](const Context& context) {
      ReadOptions read;
      return assess_tiles(
          model.reader(),
          [&](const CellWindow& window) {
            read.window = window;
            return read_raster(path, read, nullptr, context);
          },
          model.index().max_error, nullptr, context);
    });
  }
  const auto raster = raster_of(z, {}, running);
  if (raster->columns != model.index().columns || raster->rows != model.index().rows)
    throw BadInput(fmt::format("z has the shape ({}, {}), and the model was made from one of ({}, {})", raster->rows,
                               raster->columns, model.index().rows, model.index().columns),
                   {}, "z");
  return run(running, [&](const Context& context) {
    return assess_tiles(
        model.reader(), [&](const CellWindow& w) { return part_of(*raster, w); }, model.index().max_error, nullptr,
        context);
  });
}

void add_questions(Class& defined) {
  const auto define = [&](const char* name, What what, const char* words) {
    defined.def(
        name, [what](const TiledModel& m, const py::object& x, const py::object& y) { return ask(m, x, y, what); },
        py::arg("x"), py::arg("y"), words);
  };
  define("__call__", height, "Heights at x, y, as Terrain's; each tile that is needed is read once.");
  define("gradient", gradient, "As Terrain.gradient.");
  define("slope", slope, "As Terrain.slope.");
  define("aspect", aspect, "As Terrain.aspect.");
  define("normal", normal, "As Terrain.normal.");
  define("curvature", curvature, "As Terrain.curvature.");
  defined.def(
      "sample",
      [](const TiledModel& m, const py::object& transform, const py::object& shape, const std::string& what,
         int threads, const py::object& progress) {
        return sample(m, transform, shape, what, {threads, progress});
      },
      py::arg("transform") = py::none(), py::arg("shape") = py::none(), py::kw_only(), py::arg("what") = "height",
      py::arg("threads") = 0, py::arg("progress") = py::none(),
      "As Terrain.sample, tile by tile. Memory: the array, and `memory` of tiles.");
  defined.def(
      "window",
      [](const TiledModel& m, int row, int column, int rows, int columns, int threads, const py::object& progress) {
        return window(m, row, column, rows, columns, {threads, progress});
      },
      py::arg("row"), py::arg("column"), py::arg("rows"), py::arg("columns"), py::kw_only(), py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "The surface at a part of its grid's cells, from (row, column) on, as a Grid with its place: for viewshed and "
      "whatever else takes heights. Raises BadInput for what is not within the grid.");
  defined.def(
      "part", &part, py::arg("bounds"),
      "The tiles that (left, bottom, right, top) meets, CRS coordinates, joined to one Terrain. Raises BadInput where "
      "there are none.");
  defined.def(
      "compare",
      [](const TiledModel& m, const py::object& z, int threads, const py::object& progress) {
        return compare(m, z, {threads, progress});
      },
      py::arg("z"), py::kw_only(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "The error at every valid cell of the grid that the model was made from; a path is read by windows.");
}

void add_outputs(Class& defined) {
  defined.def(
      "contours",
      [](const TiledModel& m, const py::object& levels, std::optional<double> interval, double base,
         std::optional<double> tolerance, bool simplify, int threads, const py::object& progress) {
        return contours(m, parse_lines(levels, interval, base, tolerance, simplify, false), {threads, progress});
      },
      py::arg("levels") = py::none(), py::kw_only(), py::arg("interval") = py::none(), py::arg("base") = 0.0,
      py::arg("tolerance") = py::none(), py::arg("simplify") = true, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Level lines as Terrain.contours gives them, traced tile by tile and joined over seams. The lines are held, the "
      "surface is not.");
  defined.def(
      "write_contours",
      [](const TiledModel& m, const py::object& path, const py::object& levels, std::optional<double> interval,
         double base, std::optional<double> tolerance, bool simplify, bool overwrite, int index_every, int threads,
         const py::object& progress) {
        return write_contours_of(m, path, parse_lines(levels, interval, base, tolerance, simplify, false), overwrite,
                                 index_every, {threads, progress});
      },
      py::arg("path"), py::arg("levels") = py::none(), py::kw_only(), py::arg("interval") = py::none(),
      py::arg("base") = 0.0, py::arg("tolerance") = py::none(), py::arg("simplify") = true,
      py::arg("overwrite") = false, py::arg("index_every") = 5, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "The same straight into a .gpkg or .shp, which holds no more than the lines in the making (.geojson and .dxf are "
      "put together in memory). {levels, lines, points}.");
  defined.def(
      "write_raster",
      [](const TiledModel& m, const py::object& path, const py::object& transform, const py::object& shape,
         const std::string& what, bool cog, bool overwrite, int threads, const py::object& progress) {
        return write_raster_of(m, path, transform, shape, what, cog, overwrite, {threads, progress});
      },
      py::arg("path"), py::arg("transform") = py::none(), py::arg("shape") = py::none(), py::kw_only(),
      py::arg("what") = "height", py::arg("cog") = false, py::arg("overwrite") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "What sample gives (height, slope, aspect or curvature) straight into a raster of single precision, whose rows "
      "are made as they are written (GeoTIFF; cog: Cloud-Optimised, with overviews). {rows, columns, valid_cells}.");
  defined.def(
      "write_mesh",
      [](const TiledModel& m, const py::object& path, double tolerance, bool overwrite, int threads,
         const py::object& progress) {
        return write_mesh_of(m, path, tolerance, overwrite, {threads, progress});
      },
      py::arg("path"), py::kw_only(), py::arg("tolerance") = 0.0, py::arg("overwrite") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "Triangles as Terrain.mesh makes them, tile by tile straight into a file, without cracks over seams. {vertices, "
      "triangles, tolerance, watertight, boundary_edges, components}.");
}

}  // namespace

void add_tiled_model(py::module_& module) {
  Class defined(module, "TiledModel",
                "A tiled model (docs/tiles.md) that is read by its tiles: no more of them than `memory` MB are kept. "
                "What it says is what the Terrain of retalho.load(folder) says, but for rounding.");
  defined.def(py::init(&open), py::arg("folder"), py::kw_only(), py::arg("memory") = 512.0);
  add_questions(defined);
  add_outputs(defined);
  defined.def_property_readonly(
      "shape", [](const TiledModel& m) { return py::make_tuple(m.index().rows, m.index().columns); },
      "(rows, columns) of the grid that it was made from.");
  defined.def_property_readonly(
      "transform",
      [](const TiledModel& m) {
        const TiledIndex& i = m.index();
        return to_tuple(transform_of(i.georef, {0, 0}, {i.cell_width, i.cell_height}));
      },
      "Of that grid.");
  defined.def_property_readonly(
      "crs", [](const TiledModel& m) { return crs_object(m.index().georef); }, "The CRS as WKT, or None.");
  defined.def_property_readonly(
      "surface", [](const TiledModel& m) { return surface_name(m.index().surface); },
      "\"linear\", \"powell-sabin\" or \"clough-tocher\".");
  defined.def_property_readonly(
      "tolerance", [](const TiledModel& m) { return m.index().max_error; },
      "Of the flat triangulation at every valid cell, height units.");
  defined.def_property_readonly(
      "tile_size", [](const TiledModel& m) { return m.index().tile_size; }, "Cells from seam to seam.");
  defined.def_property_readonly(
      "tiles", [](const TiledModel& m) { return m.index().tiles; }, "List of TileEntry, row by row.");
  defined.def_property_readonly(
      "reads", [](const TiledModel& m) { return m.reader().reads(); },
      "How many tiles questions have read so far, those read again included.");
  defined.def("__repr__", [](const TiledModel& m) {
    const TiledIndex& i = m.index();
    return fmt::format("<retalho.TiledModel {} of {} x {} cells in {} x {} tiles of {}, tolerance {:.6g}, {}>",
                       surface_name(i.surface), i.rows, i.columns, i.tile_rows(), i.tile_columns(), i.tile_size,
                       i.max_error, crs_title(i.georef));
  });
  defined.attr("__module__") = "retalho";
}

}  // namespace retalho::python
