// What is seen from where: viewsheds, intervisibility, sight lines.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include "grid.h"
#include "retalho/visibility/surface_viewshed.h"
#include "terrain.h"

namespace retalho::python {

/// Throws UsageError.
VoidRule parse_voids(const std::string& name);

/// Where somebody stands: CRS coordinates, and the eye above the ground.
struct Eye {
  Vec2 crs;
  double height = 0;
};
/// Of an array (n, 2), or (n, 3) with heights of their own. Throws BadInput.
std::vector<Eye> eyes_of(const pybind11::object& places, const std::string& name, double height);
std::vector<SurfaceObserver> on_surface(const Georef& georef, const std::vector<Eye>& eyes);
/// The Terrain that exact=True asks. Throws UsageError for anything else, and for a placing.
std::shared_ptr<const TerrainModel> exact_model(const pybind11::object& z, const Placing& placing);

/// viewshed and intervisibility.
void add_visibility(pybind11::module_& module);
/// line_of_sight and the class SightLine.
void add_sight(pybind11::module_& module);

}  // namespace retalho::python
