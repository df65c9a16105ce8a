#include "patches.h"

#include <fmt/format.h>

#include <array>
#include <string>

#include "arrays.h"
#include "curves.h"
#include "model.h"
#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/curve/curve.h"
#include "retalho/mesh/patch_mesh.h"
#include "retalho/patch/document.h"
#include "retalho/patch/joins.h"
#include "retalho/patch/parameterize.h"
#include "retalho/patch/report.h"
#include "running.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

using Holder = std::shared_ptr<Patches>;

/// One patch of a set, which it keeps alive.
struct PatchView {
  Holder set;
  std::size_t index = 0;
  const Patch& patch() const { return set->patches()[index]; }
  const PatchSurface& surface() const { return set->surfaces()[index]; }
};

Recovery parse_recovery(const std::string& word) {
  for (const Recovery r : {Recovery::barycentric, Recovery::spr, Recovery::smooth})
    if (word == recovery_name(r)) return r;
  throw UsageError("recovery must be 'barycentric', 'spr' or 'smooth', not '" + word + "'", {}, "recovery");
}

PatchOptions options_of(const py::object& divisions, const std::string& layout, const std::string& recovery) {
  PatchOptions options;
  options.recovery = parse_recovery(recovery);
  if (layout != "delaunay" && layout != "midpoint")
    throw UsageError("layout must be 'delaunay' or 'midpoint', not '" + layout + "'", {}, "layout");
  options.layout = layout == "midpoint" ? DomainLayout::midpoint : DomainLayout::delaunay;
  if (divisions.is_none()) return options;
  const std::vector<double> counts = as_vector(divisions, "divisions");
  if (counts.size() != 1 && counts.size() != 3)
    throw BadInput(fmt::format("divisions must be one number or three, not {}", counts.size()), {}, "divisions");
  for (std::size_t k = 0; k < 3; ++k) {
    const double count = counts[counts.size() == 1 ? 0 : k];
    if (!(count >= 1 && count <= 10000))
      throw UsageError(fmt::format("divisions must be 1 to 10,000, not {}", count), {}, "divisions");
    options.divisions[k] = static_cast<std::size_t>(count);
  }
  return options;
}

SidePlacement parse_samples(const std::string& word) {
  if (word == "parameter") return SidePlacement::parameter;
  if (word == "arc-length") return SidePlacement::arc_length;
  throw UsageError("samples must be 'parameter' or 'arc-length', not '" + word + "'", {}, "samples");
}

/// A quantity of `width` numbers (0: one) at broadcast u, v.
template <class Body>
py::object at(const PatchView& view, const py::object& u, const py::object& v, std::size_t width, int threads,
              const Body& body) {
  const Pair uv = broadcast(u, v, "u and v");
  const std::size_t numbers = std::max<std::size_t>(width, 1);
  std::vector<double> out(uv.size() * numbers);
  run(Running{threads}, [&](const Context& context) {
    parallel_chunks(uv.size(), 2048, context, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(view.surface(), uv.at(i), out.data() + i * numbers);
    });
  });
  Shape shape = uv.shape;
  if (width > 0) shape.push_back(count_of(width));
  return shaped(std::move(out), shape);
}

void put(Vec3 p, double* out) {
  out[0] = p.x;
  out[1] = p.y;
  out[2] = p.z;
}

void add_patch_class(py::module_& module) {
  py::class_<PatchView> patch(module, "Patch",
                              "A triangular parametric surface over u, v >= 0, u + v <= 1, of a PatchSet.");
  patch.def(
      "__call__",
      [](const PatchView& p, const py::object& u, const py::object& v, int threads) {
        return at(p, u, v, 3, threads, [](const PatchSurface& s, Vec2 uv, double* out) { put(s.point(uv), out); });
      },
      py::arg("u"), py::arg("v"), py::kw_only(), py::arg("threads") = 0, "Points, shape (..., 3).");
  patch.def(
      "derivatives",
      [](const PatchView& p, const py::object& u, const py::object& v, int threads) {
        return at(p, u, v, 6, threads, [](const PatchSurface& s, Vec2 uv, double* out) {
          const SurfaceJet jet = s.jet(uv);
          put(jet.du, out);
          put(jet.dv, out + 3);
        });
      },
      py::arg("u"), py::arg("v"), py::kw_only(), py::arg("threads") = 0, "d/du and d/dv, shape (..., 6).");
  patch.def(
      "second_derivatives",
      [](const PatchView& p, const py::object& u, const py::object& v, int threads) {
        return at(p, u, v, 9, threads, [](const PatchSurface& s, Vec2 uv, double* out) {
          const PatchJet jet = s.full_jet(uv);
          put(jet.duu, out);
          put(jet.duv, out + 3);
          put(jet.dvv, out + 6);
        });
      },
      py::arg("u"), py::arg("v"), py::kw_only(), py::arg("threads") = 0,
      "d2/du2, d2/du dv and d2/dv2, shape (..., 9).");
  patch.def(
      "normal",
      [](const PatchView& p, const py::object& u, const py::object& v, int threads) {
        return at(p, u, v, 3, threads,
                  [](const PatchSurface& s, Vec2 uv, double* out) { put(s.full_jet(uv).normal, out); });
      },
      py::arg("u"), py::arg("v"), py::kw_only(), py::arg("threads") = 0,
      "Unit normals along du x dv, shape (..., 3); zero where the two are parallel.");
  patch.def(
      "curvature",
      [](const PatchView& p, const py::object& u, const py::object& v, int threads) {
        return at(p, u, v, 2, threads, [](const PatchSurface& s, Vec2 uv, double* out) {
          const PatchCurvature c = s.curvature(uv);
          out[0] = c.gaussian;
          out[1] = c.mean;
        });
      },
      py::arg("u"), py::arg("v"), py::kw_only(), py::arg("threads") = 0,
      "Gaussian and mean curvature, shape (..., 2).");
  patch.def_property_readonly("name", [](const PatchView& p) { return p.patch().name; });
  patch.def_property_readonly("recovery", [](const PatchView& p) { return recovery_name(p.patch().recovery); });
  patch.def_property_readonly(
      "positions",
      [](const py::object& self) {
        const auto& p = py::cast<const PatchView&>(self).patch().positions;
        return view<double>(p.data(), {count_of(p.size()), 3}, self);
      },
      "(n, 3): the nodes in space. A read-only view.");
  patch.def_property_readonly(
      "parameters",
      [](const py::object& self) {
        const auto& p = py::cast<const PatchView&>(self).patch().domain.parameters;
        return view<double>(p.data(), {count_of(p.size()), 2}, self);
      },
      "(n, 2): their u, v. A read-only view.");
  patch.def_property_readonly(
      "triangles",
      [](const py::object& self) {
        const auto& t = py::cast<const PatchView&>(self).patch().domain.triangles;
        return view<std::uint32_t>(t.data(), {count_of(t.size()), 3}, self);
      },
      "(m, 3) indices of nodes, uint32. A read-only view.");
  patch.def(
      "report",
      [](const PatchView& p) {
        const PatchReport r = run(Running{}, [&](const Context&) { return assess(p.patch(), p.surface()); });
        py::dict d;
        d["boundary_gap"] = r.boundary_gap;
        d["gradient_jump"] = r.gradient_jump;
        d["folds"] = r.folds.folds;
        d["turned"] = r.turned;
        return d;
      },
      "boundary_gap (a length), gradient_jump, folds (of the mesh of nodes), turned (triangles).");
  patch.def("__repr__", [](const PatchView& p) {
    return fmt::format("<retalho.Patch {}{} nodes, {} triangles, {}>",
                       p.patch().name.empty() ? "" : p.patch().name + ": ", p.patch().positions.size(),
                       p.patch().domain.triangles.size(), recovery_name(p.patch().recovery));
  });
  patch.attr("__module__") = "retalho";
}

py::list joins_of(const Patches& set) {
  const std::vector<PatchJoin> joins =
      run(Running{}, [&](const Context&) { return find_joins(set.patches(), set.surfaces()); });
  py::list list;
  for (const PatchJoin& join : joins) {
    py::dict d;
    d["patches"] = py::make_tuple(join.first, join.second);
    d["sides"] = py::make_tuple(join.first_side, join.second_side);
    d["watertight"] = join.watertight;
    d["gap"] = join.gap;
    d["angle"] = join.degrees;
    d["at"] = join.at;
    d["point"] = py::make_tuple(join.point.x, join.point.y, join.point.z);
    d["kind"] = join.g1 ? "G1" : "G0";
    list.append(d);
  }
  return list;
}

Holder make_set(const std::vector<std::vector<std::shared_ptr<CurveBox>>>& sides, const PatchOptions& options,
                SidePlacement placement, double snap, const Running& running) {
  std::vector<PatchSides> all;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (sides[i].size() != 3)
      throw BadInput(fmt::format("patch {} has {} sides: a patch has three", i, sides[i].size()), {}, "sides");
    PatchSides three;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!sides[i][k]) throw py::type_error(fmt::format("side {} of patch {} is None, not a Curve", k, i));
      three[k] = SideCurve(sides[i][k]->curve, false, placement);
    }
    all.push_back(std::move(three));
  }
  return run(running, [&](const Context& context) {
    std::vector<Patch> patches;
    for (std::size_t i = 0; i < all.size(); ++i)
      patches.push_back(
          make_patch(join_sides(all[i], {.snap = snap}, fmt::format("patches[{}]", i)), options, context));
    return std::make_shared<Patches>(std::move(patches), context);
  });
}

/// Three vertices of a mesh's border.
std::array<std::uint32_t, 3> corners_of(const py::object& corners, std::size_t vertices) {
  const std::vector<double> given = as_vector(corners, "corners");
  if (given.size() != 3)
    throw BadInput(fmt::format("corners must be three vertices, not {}", given.size()), {}, "corners");
  std::array<std::uint32_t, 3> three{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(given[k] >= 0 && given[k] < static_cast<double>(vertices)))
      throw BadInput(fmt::format("corners names vertex {}: there are {}", given[k], vertices), {}, "corners");
    three[k] = static_cast<std::uint32_t>(given[k]);
  }
  return three;
}

Holder of_mesh(const TriangleMesh& mesh, const std::string& weights, const py::object& corners, const Recovery recovery,
               const Running& running) {
  if (weights != "mean-value" && weights != "shape-preserving")
    throw UsageError("parameters must be 'mean-value' or 'shape-preserving', not '" + weights + "'", {}, "parameters");
  ParameterizeOptions options;
  options.weights = weights == "mean-value" ? Weights::mean_value : Weights::shape_preserving;
  if (!corners.is_none()) options.corners = corners_of(corners, mesh.positions.size());
  return run(running, [&](const Context& context) {
    std::vector<Patch> patches;
    patches.push_back(patch_of(parameterize(mesh.positions, mesh.triangles, options, context), recovery));
    return std::make_shared<Patches>(std::move(patches), context);
  });
}

}  // namespace

Patches::Patches(std::vector<Patch> patches, const Context& context) : patches_(std::move(patches)) {
  surfaces_.reserve(patches_.size());
  for (const Patch& patch : patches_) surfaces_.emplace_back(patch, context);
}

void add_patches(py::module_& module) {
  add_patch_class(module);
  py::class_<Patches, Holder> set(module, "PatchSet",
                                  "Triangular patches that belong together: a sequence of Patch.\n\n"
                                  "sides: for each patch three Curves, from corner U to V, V to W, W to U. divisions: "
                                  "edges a side, one number or three. layout (different divisions): delaunay or "
                                  "midpoint. recovery: smooth, spr or barycentric. samples: parameter or arc-length. "
                                  "snap: ends that far apart are joined.");
  set.def(py::init([](const std::vector<std::vector<std::shared_ptr<CurveBox>>>& sides, const py::object& divisions,
                      const std::string& layout, const std::string& recovery, const std::string& samples, double snap,
                      int threads, const py::object& progress) {
            return make_set(sides, options_of(divisions, layout, recovery), parse_samples(samples), snap,
                            {threads, progress});
          }),
          py::arg("sides"), py::kw_only(), py::arg("divisions") = py::none(), py::arg("layout") = "delaunay",
          py::arg("recovery") = "smooth", py::arg("samples") = "parameter", py::arg("snap") = 0.0,
          py::arg("threads") = 0, py::arg("progress") = py::none());
  set.def_static(
      "from_mesh",
      [](const TriangleMesh& mesh, const std::string& parameters, const std::string& recovery,
         const py::object& corners, int threads, const py::object& progress) {
        return of_mesh(mesh, parameters, corners, parse_recovery(recovery), {threads, progress});
      },
      py::arg("mesh"), py::kw_only(), py::arg("parameters") = "mean-value", py::arg("recovery") = "smooth",
      py::arg("corners") = py::none(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "One patch of a triangle mesh that is a disk, by Floater's parameters (mean-value or shape-preserving). corners: "
      "the three vertices of its border that become the patch's; None: the sharpest turns.");
  set.def("__len__", [](const Patches& s) { return s.patches().size(); })
      .def(
          "__getitem__",
          [](const Holder& s, py::ssize_t index) {
            const py::ssize_t count = count_of(s->patches().size());
            if (index < 0) index += count;
            if (index < 0 || index >= count) throw py::index_error(fmt::format("patch {} of {}", index, count));
            return PatchView{s, static_cast<std::size_t>(index)};
          },
          py::arg("index"))
      .def("__iter__",
           [](const py::object& self) { return py::reinterpret_steal<py::iterator>(PySeqIter_New(self.ptr())); })
      .def("joins", &joins_of,
           "One dict a shared side: patches, sides, watertight, gap (a length), angle (the largest, degrees), at and "
           "point "
           "(where that is: along the side, 0 to 1, and in space), kind (G0 or G1).")
      .def(
          "mesh",
          [](const Patches& s, double tolerance, std::size_t refine, int threads, const py::object& progress) {
            if (refine < 1 || refine > 1000 || (refine > 1 && tolerance > 0))
              throw UsageError("refine is 1 to 1000, and goes without tolerance", {}, "refine");
            return std::make_shared<TriangleMesh>(run(Running{threads, progress}, [&](const Context& context) {
              if (refine == 1)
                return mesh_patch_surfaces(s.patches(), s.surfaces(), tolerance, nullptr, nullptr, context);
              std::vector<Patch> fine;
              for (std::size_t i = 0; i < s.patches().size(); ++i) {
                context.check();
                fine.push_back(retalho::refine(s.patches()[i], s.surfaces()[i], refine));
              }
              return mesh_patches(fine);
            }));
          },
          py::kw_only(), py::arg("tolerance") = 0.0, py::arg("refine") = 1, py::arg("threads") = 0,
          py::arg("progress") = py::none(),
          "One mesh of all; nodes that two patches share are one. tolerance: largest distance of a triangle's middle "
          "to the surface; 0: the nodes' triangles. refine: each edge of those cut into so many, instead.")
      .def("__repr__", [](const Patches& s) {
        std::size_t nodes = 0;
        for (const Patch& p : s.patches()) nodes += p.positions.size();
        return fmt::format("<retalho.PatchSet {} patches, {} nodes>", s.patches().size(), nodes);
      });
  add_model_methods(set);
  set.attr("__module__") = "retalho";
  module.def(
      "read_patches",
      [](const py::object& path, const py::object& divisions, const std::string& layout, const std::string& recovery,
         const std::string& samples, double snap, int threads, const py::object& progress) {
        const std::string name = path_text(path);
        const PatchOptions asked = options_of(divisions, layout, recovery);
        const bool given = !divisions.is_none();
        const SidePlacement placement = parse_samples(samples);
        return run(Running{threads, progress}, [&](const Context& context) {
          std::vector<Patch> patches;
          for (const PatchSpec& spec : read_patches(name, placement)) {
            PatchOptions options = asked;
            if (!given && spec.divisions) options.divisions = *spec.divisions;
            patches.push_back(make_patch(join_sides(spec.sides, {.snap = snap}, spec.where), options, context));
            patches.back().name = spec.name;
          }
          return std::make_shared<Patches>(std::move(patches), context);
        });
      },
      py::arg("path"), py::kw_only(), py::arg("divisions") = py::none(), py::arg("layout") = "delaunay",
      py::arg("recovery") = "smooth", py::arg("samples") = "parameter", py::arg("snap") = 0.0, py::arg("threads") = 0,
      py::arg("progress") = py::none(),
      "The patches of a JSON file (docs/triangular-patches.md). Raises CannotRead, BadInput with the place.");
}

}  // namespace retalho::python
