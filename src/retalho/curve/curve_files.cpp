#include "retalho/curve/curve_files.h"

#include <algorithm>
#include <cstddef>

#include "retalho/curve/flatten.h"
#include "retalho/curve/plane_path.h"

namespace retalho {

CurveSpec to_spec(const VectorLine& line) {
  CurveSpec spec;
  spec.kind = CurveKind::polyline;
  spec.name = line.name;
  spec.dimension = line.dimension;
  spec.closed = line.closed;
  spec.points = line.points;
  return spec;
}

std::vector<CurveSpec> read_curve_specs(const std::string& path, int* transforms) {
  if (path.ends_with(".json")) return read_curves(path).curves;
  std::vector<CurveSpec> specs;
  if (path.ends_with(".svg"))
    for (const Curve& curve : read_svg(path, transforms)) specs.push_back(to_spec(curve));
  else
    for (const VectorLine& line : read_vector_lines(path)) specs.push_back(to_spec(line));
  return specs;
}

std::vector<VectorLine> vector_lines(const Curve& curve, const std::string& name, double tolerance,
                                     const Context& context) {
  const double t = tolerance > 0 ? tolerance : 1e-4 * std::max(control_size(curve.points), 1e-300);
  const FlatCurve flat = flatten(curve, t, context);
  std::vector<VectorLine> lines;
  for (std::size_t k = 0; k < flat.starts.size(); ++k) {
    const std::size_t from = flat.starts[k], to = k + 1 < flat.starts.size() ? flat.starts[k + 1] : flat.points.size();
    VectorLine line{name,
                    {flat.points.begin() + static_cast<std::ptrdiff_t>(from),
                     flat.points.begin() + static_cast<std::ptrdiff_t>(to)},
                    curve.dimension,
                    flat.closed};
    if (line.closed) line.points.pop_back();
    lines.push_back(std::move(line));
  }
  return lines;
}

}  // namespace retalho
