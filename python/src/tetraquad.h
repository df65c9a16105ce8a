// The class TetraQuad: a surface in tetrahedra, with what is made of it when it is first needed.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <optional>

#include "retalho/core/context.h"
#include "retalho/tetraquad/fit.h"
#include "retalho/tetraquad/rays.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho::python {

class TetraQuadModel {
 public:
  explicit TetraQuadModel(TetraQuad surface, std::optional<TetraQuadFitReport> report = {})
      : surface_(std::move(surface)), report_(std::move(report)) {}
  const TetraQuad& surface() const { return surface_; }
  const std::optional<TetraQuadFitReport>& report() const { return report_; }  ///< none: it was loaded
  /// Never call these with the interpreter lock held: another thread may be making them.
  const TetraQuadField& field() const;
  const TetraQuadRays& rays(const Context& context) const;

 private:
  TetraQuad surface_;
  std::optional<TetraQuadFitReport> report_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<TetraQuadField> field_;
  mutable std::unique_ptr<TetraQuadRays> rays_;
};

void add_tetraquad(pybind11::module_& module);
/// TetraQuad.fit and what stands round it; needs the class TetraQuad.
void add_tetraquad_fit(pybind11::module_& module);

}  // namespace retalho::python
