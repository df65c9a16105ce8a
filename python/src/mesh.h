// Triangle meshes of any model, and their files.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "retalho/mesh/mesh.h"

namespace retalho::python {

/// The class Mesh, and Terrain.mesh; needs the class Terrain.
void add_mesh(pybind11::module_& module);

}  // namespace retalho::python
