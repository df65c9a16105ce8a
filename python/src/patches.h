// Triangular parametric patches: the class PatchSet, and Patch, one of them.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <vector>

#include "retalho/patch/surface.h"

namespace retalho::python {

/// Patches that belong together, with their surfaces.
class Patches {
 public:
  explicit Patches(std::vector<Patch> patches, const Context& context = {});
  const std::vector<Patch>& patches() const { return patches_; }
  const std::vector<PatchSurface>& surfaces() const { return surfaces_; }

 private:
  std::vector<Patch> patches_;
  std::vector<PatchSurface> surfaces_;
};

/// Needs the classes Curve and Mesh.
void add_patches(pybind11::module_& module);

}  // namespace retalho::python
