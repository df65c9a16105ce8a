// TetraQuad.render and PatchSet.render: pictures of surfaces in space.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "patches.h"
#include "pictures.h"
#include "retalho/core/error.h"
#include "retalho/render/patch_picture.h"
#include "retalho/render/tetraquad_picture.h"
#include "running.h"
#include "tetraquad.h"

namespace py = pybind11;

namespace retalho::python {
namespace {

constexpr int kHalvings = 6;  // of a tree of rays for one picture, as the program has it

PatchStyle parse_style(const std::string& word) {
  const auto* const found = std::find(kPatchStyles.begin(), kPatchStyles.end(), word);
  if (found == kPatchStyles.end())
    throw UsageError(fmt::format("style must be one of {}, not '{}'", fmt::join(kPatchStyles, ", "), word), {},
                     "style");
  return static_cast<PatchStyle>(found - kPatchStyles.begin());
}

char parse_up(const std::string& axis) {
  if (axis != "x" && axis != "y" && axis != "z")
    throw UsageError("up must be 'x', 'y' or 'z', not '" + axis + "'", {}, "up");
  return axis[0];
}

}  // namespace

void add_shape_pictures(py::module_& module) {
  auto tetraquad =
      py::reinterpret_borrow<py::class_<TetraQuadModel, std::shared_ptr<TetraQuadModel>>>(module.attr("TetraQuad"));
  tetraquad.def(
      "render",
      [](const TetraQuadModel& m, const std::pair<int, int>& size, const std::string& up, double from, double elevation,
         const std::vector<std::string>& cuts, bool outlines, bool jumps, int threads, const py::object& progress) {
        check_size(size);
        TetraQuadPictureOptions options;
        options.up = parse_up(up);
        options.from = from;
        options.elevation = elevation;
        options.outlines = outlines;
        if (jumps) options.colors = TetraQuadColors::normal_jumps;
        for (const std::string& cut : cuts) options.cuts.push_back(parse_cut(cut, m.surface().georef));
        return pixels_of(run(Running{threads, progress}, [&](const Context& context) {
          const TetraQuadRays rays(m.field(), kHalvings, context);
          return draw_tetraquad(m.field(), rays, size.first, size.second, options, context);
        }));
      },
      py::kw_only(), py::arg("size") = std::pair{640, 480}, py::arg("up") = "z", py::arg("from_") = 200.0,
      py::arg("elevation") = 35.0, py::arg("cuts") = std::vector<std::string>{}, py::arg("outlines") = false,
      py::arg("jumps") = false, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "A picture by ray casting, uint8 (height, width, 3), on white.\n\n"
      "size: (width, height), pixels. up: the axis that points up. from_, elevation: where the eye stands, degrees "
      "about that axis and over the horizon. cuts: what is kept, as 'x<0.5'. outlines: where tetrahedra meet. jumps: "
      "colours of how far normals jump across faces, white 0 to red 10 degrees.");
  auto patches = py::reinterpret_borrow<py::class_<Patches, std::shared_ptr<Patches>>>(module.attr("PatchSet"));
  patches.def(
      "render",
      [](const Patches& set, const std::pair<int, int>& size, const std::string& style, double from, double elevation,
         int threads, const py::object& progress) {
        check_size(size);
        PatchPictureOptions options;
        options.style = parse_style(style);
        std::tie(options.width, options.height) = size;
        options.from = from;
        options.elevation = elevation;
        return pixels_of(run(Running{threads, progress}, [&](const Context& context) {
          return draw_patches(set.patches(), set.surfaces(), options, context);
        }));
      },
      py::kw_only(), py::arg("size") = std::pair{640, 480}, py::arg("style") = "lines", py::arg("from_") = 30.0,
      py::arg("elevation") = 30.0, py::arg("threads") = 0, py::arg("progress") = py::none(),
      "A picture of all patches, uint8 (height, width, 3), on white.\n\n"
      "size: (width, height), pixels. style: shaded; lines (of equal u, v, w); isophotes or zebra (kinks break their "
      "bands); gaussian or mean (curvature: blue negative, red positive). from_: degrees from the x axis, "
      "counter-clockwise; elevation: degrees over the horizon.");
}

}  // namespace retalho::python
