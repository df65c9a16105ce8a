// Curves in files of any kind.
#pragma once

#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/curve/document.h"
#include "retalho/curve/vector_file.h"

namespace retalho {

/// .json: as written; .svg: its paths, exactly; any other ending: the lines of a vector file. `transforms` (may be
/// null) counts an SVG's elements under a transform, which is not applied. Throws CannotRead, BadInput.
std::vector<CurveSpec> read_curve_specs(const std::string& path, int* transforms = nullptr);

/// A polyline as an entry of a document.
CurveSpec to_spec(const VectorLine& line);

/// The lines that stand for a curve in a vector file, nowhere farther from it than `tolerance` (proved); 0: 1e-4 of the
/// size of its control points.
std::vector<VectorLine> vector_lines(const Curve& curve, const std::string& name, double tolerance = 0,
                                     const Context& context = {});

}  // namespace retalho
