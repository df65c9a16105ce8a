#include "tiles.h"

#include <fmt/format.h>
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "arrays.h"
#include "grid.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/tiles/make.h"
#include "running.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

SurfaceKind surface_of(const std::string& word) {
  const std::optional<SurfaceKind> kind = parse_surface(word);
  if (!kind)
    throw UsageError("surface must be 'linear', 'powell-sabin' or 'clough-tocher', not '" + word + "'", {}, "surface");
  return *kind;
}

bool fitted_of(const std::string& word) {
  if (word != "interpolate" && word != "least-squares")
    throw UsageError("fit must be 'interpolate' or 'least-squares', not '" + word + "'", {}, "fit");
  return word == "least-squares";
}

TilePlan plan_of(const py::object& source, int size, std::optional<double> max_error, std::optional<double> vertices,
                 std::optional<double> ratio, const std::string& surface, const std::string& fit, int band,
                 std::optional<double> nodata) {
  const std::string path = path_text(source);
  if ((max_error ? 1 : 0) + (vertices ? 1 : 0) + (ratio ? 1 : 0) != 1)
    throw UsageError("give one of max_error, vertices and ratio", {}, "max_error");
  if (vertices && !(*vertices >= 1 && *vertices < 1e15 && *vertices == std::floor(*vertices)))
    throw UsageError(fmt::format("vertices must be a whole number from 1 up, not {}", *vertices), {}, "vertices");
  if (ratio && !(*ratio > 0 && *ratio <= 1))
    throw UsageError(fmt::format("ratio must be in (0, 1], not {}", *ratio), {}, "ratio");
  TileOptions options;
  options.size = size;
  options.max_error = max_error.value_or(0);
  options.vertices = static_cast<std::size_t>(vertices.value_or(0));
  options.ratio = ratio.value_or(0);
  options.surface = surface_of(surface);
  options.fitted = fitted_of(fit);
  ReadOptions read;
  read.band = band;
  read.nodata = nodata;
  return run(Running{}, [&](const Context&) { return plan_tiles(path, options, read); });
}

/// A plan as plain values, for other processes.
py::tuple state_of(const TilePlan& plan) {
  return py::make_tuple(plan.source, plan.read.band,
                        plan.read.nodata ? py::object(py::float_(*plan.read.nodata)) : py::object(py::none()),
                        index_text(plan.frame), plan.ratio);
}

TilePlan plan_from(const py::tuple& state) {
  ReadOptions read;
  read.band = py::cast<int>(state[1]);
  if (!state[2].is_none()) read.nodata = py::cast<double>(state[2]);
  return {py::cast<std::string>(state[0]), read, parse_frame(py::cast<std::string>(state[3])),
          py::cast<double>(state[4])};
}

NeighborNames names_of(const std::vector<std::string>& names) {
  if (names.size() != 9)
    throw UsageError(fmt::format("tins must be nine names, row by row round the tile, not {}", names.size()), {},
                     "tins");
  NeighborNames nine;
  std::copy(names.begin(), names.end(), nine.begin());
  return nine;
}

std::vector<std::string> tins_of(const TilePlan& plan, const std::vector<std::string>& tins) {
  if (tins.size() != plan.frame.tile_count())
    throw UsageError(fmt::format("tins must name all {} tiles, not {}", plan.frame.tile_count(), tins.size()), {},
                     "tins");
  return tins;
}

void check_tile(const TilePlan& plan, int row, int column) {
  if (row < 0 || column < 0 || row >= plan.frame.tile_rows() || column >= plan.frame.tile_columns())
    throw UsageError(fmt::format("there is no tile ({}, {}): the grid has {} x {}", row, column, plan.frame.tile_rows(),
                                 plan.frame.tile_columns()));
}

/// What is made of an open plan would be of no tolerance at all.
void check_settled(const TilePlan& plan) {
  if (plan.open()) throw UsageError("this plan has a budget whose tolerance is not known yet: settle() it, or make()");
}

std::string repr(const TilePlan& plan) {
  const TiledIndex& f = plan.frame;
  const std::string how = plan.ratio > 0 ? fmt::format("{:.6g} of the cells", plan.ratio)
                          : plan.open()  ? fmt::format("{} vertices", f.budget)
                                         : fmt::format("tolerance {:.6g}", f.max_error);
  return fmt::format("<retalho.TilePlan {} x {} cells in {} x {} tiles of {}, {}{}, {}, {}>", f.rows, f.columns,
                     f.tile_rows(), f.tile_columns(), f.tile_size, surface_name(f.surface),
                     f.fitted ? " least-squares" : "", how, crs_title(f.georef));
}

using Look = std::tuple<bool, std::size_t, double, double>;
std::vector<TileLook> looks_of(const TilePlan& plan, const std::vector<Look>& looks) {
  if (looks.size() != plan.frame.tile_count())
    throw UsageError(fmt::format("looks must be of all {} tiles, not {}", plan.frame.tile_count(), looks.size()), {},
                     "looks");
  std::vector<TileLook> all;
  all.reserve(looks.size());
  for (const auto& [area, valid, low, high] : looks) all.push_back({area, valid, low, high});
  return all;
}

void add_budget(py::class_<TilePlan>& plan) {
  plan.def_property_readonly(
      "settled", [](const TilePlan& p) { return !p.open(); },
      "Is the tolerance known? Of a budget it is found by settle, or within make.");
  plan.def_property_readonly(
      "max_error",
      [](const TilePlan& p) { return p.open() ? py::object(py::none()) : py::object(py::float_(p.frame.max_error)); },
      "The tolerance, height units; None: not settled yet.");
  plan.def(
      "look",
      [](const TilePlan& p, int row, int column) {
        check_tile(p, row, column);
        const TileLook l =
            run(Running{1}, [&](const Context& context) { return look_at_tile(p, row, column, context); });
        return Look{l.area, l.valid, l.low, l.high};
      },
      py::arg("row"), py::arg("column"),
      "(has an area with data, valid cells, lowest, highest height) of a tile: what settle needs of each.");
  plan.def(
      "areas",
      [](const TilePlan& p, const std::vector<Look>& looks, int row, int column) {
        check_tile(p, row, column);
        const std::array<bool, 9> nine = areas_around(p.frame, looks_of(p, looks), row, column);
        return std::vector<bool>(nine.begin(), nine.end());
      },
      py::arg("looks"), py::arg("row"), py::arg("column"), "Which of the nine tiles round one have an area.");
  plan.def(
      "count",
      [](const TilePlan& p, int row, int column, double max_error, const std::vector<bool>& areas) {
        check_tile(p, row, column);
        if (areas.size() != 9) throw UsageError(fmt::format("areas must be nine, not {}", areas.size()), {}, "areas");
        std::array<bool, 9> nine{};
        std::copy(areas.begin(), areas.end(), nine.begin());
        return run(Running{1},
                   [&](const Context& context) { return count_vertices(p, row, column, max_error, nine, context); });
      },
      py::arg("row"), py::arg("column"), py::arg("max_error"), py::arg("areas"),
      "Vertices of a tile's triangulation to that tolerance, those on seams counted in one tile only.");
  plan.def(
      "settle",
      [](const TilePlan& p, const std::vector<Look>& looks, const std::function<std::size_t(double)>& count) {
        return p.open() ? settle(p, looks_of(p, looks), count) : p;
      },
      py::arg("looks"), py::arg("count"),
      "The plan with the tolerance that spends its budget. count(max_error): the sum of count over all tiles; it is "
      "called up to 24 times.");
}

void add_tasks(py::class_<TilePlan>& plan) {
  plan.def(
      "check",
      [](const TilePlan& p, const py::object& folder, bool overwrite) {
        check_tiles_folder(p, path_text(folder), overwrite);
      },
      py::arg("folder"), py::kw_only(), py::arg("overwrite") = false,
      "Raises CannotWrite where the folder holds the index of another grid or of other parameters.");
  plan.def(
      "tin_name",
      [](const TilePlan& p, int row, int column) {
        check_tile(p, row, column);
        check_settled(p);
        return run(Running{1}, [&](const Context& context) { return tin_name(p, row, column, context); });
      },
      py::arg("row"), py::arg("column"),
      "Name of the file with a tile's triangulation, a digest of its heights and the parameters; \"\": no data.");
  plan.def(
      "make_tin",
      [](const TilePlan& p, int row, int column, const std::string& name, const py::object& folder) {
        check_tile(p, row, column);
        check_settled(p);
        const std::string path = path_text(folder);
        run(Running{1}, [&](const Context& context) { make_tin(p, row, column, name, path, context); });
      },
      py::arg("row"), py::arg("column"), py::arg("name"), py::arg("folder"),
      "Makes that file in the folder, unless it is there and whole.");
  plan.def(
      "make_tile",
      [](const TilePlan& p, int row, int column, const std::vector<std::string>& tins, const py::object& folder) {
        check_tile(p, row, column);
        check_settled(p);
        const std::string path = path_text(folder);
        const NeighborNames nine = names_of(tins);
        return run(Running{1}, [&](const Context& context) { return make_tile(p, row, column, nine, path, context); });
      },
      py::arg("row"), py::arg("column"), py::arg("tins"), py::arg("folder"),
      "Makes a tile's surface from the triangulations of the tile and its neighbours (nine names, see around), unless "
      "it is there; its entry for finish.");
  plan.def(
      "around",
      [](const TilePlan& p, const std::vector<std::string>& tins, int row, int column) {
        check_tile(p, row, column);
        const NeighborNames nine = names_around(p.frame, tins_of(p, tins), row, column);
        return std::vector<std::string>(nine.begin(), nine.end());
      },
      py::arg("tins"), py::arg("row"), py::arg("column"), "Of the names of all tiles, the nine round one.");
  plan.def(
      "missing",
      [](const TilePlan& p, const std::vector<std::string>& tins, const py::object& folder) {
        const std::string path = path_text(folder);
        const std::vector<std::string> all = tins_of(p, tins);
        const auto [tiles, flat] = run(Running{1}, [&](const Context&) {
          std::vector<std::size_t> t = missing_tiles(p, all, path);
          std::vector<std::size_t> f = missing_tins(p, all, t, path);
          return std::pair{std::move(t), std::move(f)};
        });
        return py::make_tuple(flat, tiles);
      },
      py::arg("tins"), py::arg("folder"),
      "(triangulations, tiles) that are still to be made, by their places in the row by row order.");
  plan.def(
      "finish",
      [](const TilePlan& p, std::vector<TileEntry> entries, const std::vector<std::string>& tins,
         const py::object& folder, bool overwrite) {
        check_settled(p);
        const std::string path = path_text(folder);
        const std::vector<std::string> all = tins_of(p, tins);
        run(Running{1}, [&](const Context&) { finish_tiles(p, std::move(entries), all, path, overwrite); });
      },
      py::arg("entries"), py::arg("tins"), py::arg("folder"), py::kw_only(), py::arg("overwrite") = false,
      "Writes the index of all tiles and removes the triangulations.");
  plan.def(
      "make",
      [](const TilePlan& p, const py::object& folder, int jobs, bool overwrite, int threads,
         const py::object& progress) {
        const std::string path = path_text(folder);
        run(Running{threads, progress}, [&](const Context& context) { make_tiles(p, path, jobs, overwrite, context); });
      },
      py::arg("folder"), py::kw_only(), py::arg("jobs") = 0, py::arg("overwrite") = false, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "All of it in this process, `jobs` tiles at a time (0: as many as threads). What is there is not made again. "
      "Memory: `jobs` times a tile's.");
}

}  // namespace

void add_tiles(py::module_& module) {
  py::class_<TileEntry> entry(module, "TileEntry", "What the index says of a tile.");
  entry.def_readonly("row", &TileEntry::row)
      .def_readonly("column", &TileEntry::column)
      .def_readonly("file", &TileEntry::file, "Its name in the folder; \"\": no data.")
      .def_readonly("bytes", &TileEntry::bytes)
      .def_readonly("vertices", &TileEntry::vertices)
      .def_readonly("triangles", &TileEntry::triangles)
      .def_readonly("checksum", &TileEntry::checksum)
      .def_property_readonly(
          "cells",
          [](const TileEntry& e) { return py::make_tuple(e.cells.column, e.cells.row, e.cells.columns, e.cells.rows); },
          "(column, row, columns, rows) in the whole grid, seams included.")
      .def("__repr__",
           [](const TileEntry& e) {
             return fmt::format("<retalho.TileEntry row {}, column {}: {} vertices>", e.row, e.column, e.vertices);
           })
      .def(py::pickle(
          [](const TileEntry& e) {
            return py::make_tuple(e.row, e.column, e.cells.column, e.cells.row, e.cells.columns, e.cells.rows, e.file,
                                  e.checksum, e.bytes, e.vertices, e.triangles);
          },
          [](const py::tuple& t) {
            TileEntry e;
            e.row = py::cast<int>(t[0]);
            e.column = py::cast<int>(t[1]);
            e.cells = {py::cast<int>(t[2]), py::cast<int>(t[3]), py::cast<int>(t[4]), py::cast<int>(t[5])};
            e.file = py::cast<std::string>(t[6]);
            e.checksum = py::cast<std::string>(t[7]);
            e.bytes = py::cast<std::size_t>(t[8]);
            e.vertices = py::cast<std::size_t>(t[9]);
            e.triangles = py::cast<std::size_t>(t[10]);
            return e;
          }));
  entry.attr("__module__") = "retalho";
  py::class_<TilePlan> plan(module, "TilePlan",
                            "How a grid that does not fit into memory is cut into tiles and fitted (docs/tiles.md).\n\n"
                            "source: a file or VRT that GDAL reads by windows. size: cells from seam to seam, 16 to "
                            "16,384. one of max_error (of the flat triangulation at every valid cell, height "
                            "units), vertices and ratio (of the valid cells). surface: linear, powell-sabin or "
                            "clough-tocher. fit: interpolate or least-squares. Plans can be pickled.");
  plan.def(py::init(&plan_of), py::arg("source"), py::kw_only(), py::arg("size") = 1024,
           py::arg("max_error") = py::none(), py::arg("vertices") = py::none(), py::arg("ratio") = py::none(),
           py::arg("surface") = "clough-tocher", py::arg("fit") = "interpolate", py::arg("band") = 1,
           py::arg("nodata") = py::none());
  plan.def_property_readonly(
      "shape", [](const TilePlan& p) { return py::make_tuple(p.frame.rows, p.frame.columns); },
      "(rows, columns) of the grid.");
  plan.def_property_readonly(
      "tiles", [](const TilePlan& p) { return py::make_tuple(p.frame.tile_rows(), p.frame.tile_columns()); },
      "(rows, columns) of tiles.");
  add_budget(plan);
  add_tasks(plan);
  plan.def("__repr__", &repr);
  plan.def(py::pickle(&state_of, &plan_from));
  plan.attr("__module__") = "retalho";
}

}  // namespace retalho::python
