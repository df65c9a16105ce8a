#include "quantity.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "arrays.h"
#include "grid.h"
#include "retalho/core/error.h"
#include "retalho/terrain/quantities.h"

namespace py = pybind11;

namespace retalho::python {

What parse_what(const std::string& name) {
  for (std::size_t k = 0; k < kQuantities.size(); ++k)
    if (name == kQuantities[k].name) return static_cast<What>(k);
  throw UsageError(fmt::format("what: '{}' is none of height, gradient, slope, aspect, normal, curvature", name), {},
                   "what");
}

void put(What what, const Jet& jet, double* out) {
  switch (what) {
    case height:
      out[0] = jet.value;
      break;
    case gradient:
      out[0] = jet.gradient.x;
      out[1] = jet.gradient.y;
      break;
    case slope:
      out[0] = slope_degrees(jet.gradient);
      break;
    case aspect:
      out[0] = aspect_degrees(jet.gradient);
      break;
    case normal: {
      const Vec3 n = unit_normal(jet.gradient);
      out[0] = n.x;
      out[1] = n.y;
      out[2] = n.z;
      break;
    }
    case curvature:
      out[0] = mean_curvature(jet);
      break;
  }
}

Cells cells_of(const Georef& georef, const GridDomain& grid, const py::object& transform, const py::object& shape) {
  if (transform.is_none() != shape.is_none())
    throw UsageError("give transform and shape, or neither (the model's own grid)", {}, "transform");
  if (transform.is_none()) {
    if (grid.columns == 0)
      throw UsageError("this model was made from points and has no cells: give transform and shape", {}, "transform");
    return {{0, 0}, {grid.cell_width, grid.cell_height}, grid.columns, grid.rows};
  }
  const std::vector<double> sides = as_vector(shape, "shape");
  if (sides.size() != 2 || std::floor(sides[0]) != sides[0] || std::floor(sides[1]) != sides[1] ||
      !(std::abs(sides[0]) < 1e9 && std::abs(sides[1]) < 1e9))
    throw BadInput("shape must be two whole numbers (rows, columns)", {}, "shape");
  const Raster r = empty_raster(as_transform(transform), {}, static_cast<int>(sides[1]), static_cast<int>(sides[0]));
  return {georef.to_local(r.georef.to_crs({0, 0})),
          {r.cell_width * georef.scale_x, r.cell_height * georef.scale_y},
          r.columns,
          r.rows};
}

}  // namespace retalho::python
