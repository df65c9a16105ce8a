// The class TetraQuad: a surface in tetrahedra, with what is made of it when it is first needed.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>

#include "retalho/core/context.h"
#include "retalho/tetraquad/rays.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho::python {

class TetraQuadModel {
 public:
  explicit TetraQuadModel(TetraQuad surface) : surface_(std::move(surface)) {}
  const TetraQuad& surface() const { return surface_; }
  /// Never call these with the interpreter lock held: another thread may be making them.
  const TetraQuadField& field() const;
  const TetraQuadRays& rays(const Context& context) const;

 private:
  TetraQuad surface_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<TetraQuadField> field_;
  mutable std::unique_ptr<TetraQuadRays> rays_;
};

void add_tetraquad(pybind11::module_& module);

}  // namespace retalho::python
