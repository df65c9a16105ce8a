// Where a grid or a model lies: the map between the CRS and local coordinates.
//
// Local coordinates are what every surface computes in: x to the east and y to the north, in metres (or the CRS's own
// unit), with the origin at the centre of the grid's first (north-west) cell. So there is no loss of digits at 5e6,
// slopes are true, and cell (column, row) has its centre at (column * cell_width, -row * cell_height).
#pragma once

#include <string>

#include "retalho/core/vec.h"

namespace retalho {

struct Georef {
  double origin_x = 0, origin_y = 0;  ///< CRS coordinates of the local origin
  double scale_x = 1, scale_y = 1;  ///< local units per CRS unit (metres a degree where the CRS is geographic, else 1)
  std::string crs_wkt;              ///< empty: no CRS
  std::string unit = "unit";        ///< name of the local unit: "metre", "US survey foot", "unit" (none known)
  bool geographic = false;          ///< the CRS is in degrees and scale_* are metres by the mean latitude

  Vec2 to_local(Vec2 crs) const { return {(crs.x - origin_x) * scale_x, (crs.y - origin_y) * scale_y}; }
  Vec2 to_crs(Vec2 local) const { return {origin_x + local.x / scale_x, origin_y + local.y / scale_y}; }
};

}  // namespace retalho
