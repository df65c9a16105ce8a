// Breaklines of a vector layer: lines, and the rings of polygons, with or without heights.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"

namespace retalho {

struct BreaklineFile {
  std::vector<std::vector<Vec3>> lines;  ///< CRS coordinates; z is NaN where the geometry has none
  std::string crs_wkt;                   ///< empty: none
  std::size_t others = 0;                ///< geometries that are neither lines nor polygons, left out
};

/// Every format that GDAL opens; arcs as GDAL flattens them; closed lines repeat their first vertex. `layer` empty: the
/// only one. Throws CannotRead (missing, damaged, unknown) and BadInput (no such layer, several, no line).
BreaklineFile read_breaklines(const std::string& path, const std::string& layer = {}, const Context& context = {});

}  // namespace retalho
