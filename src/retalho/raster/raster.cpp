#include "retalho/raster/raster.h"

namespace retalho {

RasterSummary summarize(const Raster& raster) {
  RasterSummary s;
  s.cells = raster.cells();
  double sum = 0;
  s.minimum = std::numeric_limits<double>::infinity();
  s.maximum = -s.minimum;
  std::visit(
      [&](const auto& heights) {
        for (const auto h : heights) {
          if (std::isnan(h)) continue;
          const double z = static_cast<double>(h);
          ++s.valid;
          sum += z;
          if (z < s.minimum) s.minimum = z;
          if (z > s.maximum) s.maximum = z;
        }
      },
      raster.heights);
  if (s.valid == 0) s.minimum = s.maximum = std::numeric_limits<double>::quiet_NaN();
  s.mean = s.valid ? sum / static_cast<double>(s.valid) : s.minimum;
  return s;
}

Mask valid_mask(const Raster& raster) {
  Mask mask(raster.columns, raster.rows, false);
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column)
      if (raster.valid(column, row)) mask.set(column, row, true);
  return mask;
}

}  // namespace retalho
