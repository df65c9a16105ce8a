// An elevation grid in memory: heights, no-data, position. Rows run from north to south, columns from west to east.
//
// Heights are float where that is exact for every cell of the file (integers up to 24 bits, float32 data), else
// double. A void cell is NaN, whatever the file said. Infinite heights are void too, and counted.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "retalho/raster/georef.h"
#include "retalho/raster/mask.h"

namespace retalho {

struct Raster {
  int columns = 0, rows = 0;
  double cell_width = 1, cell_height = 1;  ///< in local units (Georef), both > 0
  Georef georef;
  std::string height_unit;                                        ///< as the file says, or empty
  std::variant<std::vector<float>, std::vector<double>> heights;  ///< row-major; NaN is void

  std::size_t cells() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  double at(std::size_t cell) const {
    return std::visit([cell](const auto& h) { return static_cast<double>(h[cell]); }, heights);
  }
  double at(int column, int row) const { return at(index(column, row)); }
  bool valid(int column, int row) const { return !std::isnan(at(column, row)); }

  /// Local coordinates of a cell's centre.
  Vec2 centre(double column, double row) const { return {column * cell_width, -row * cell_height}; }
};

/// What `info` and every reading command say about a raster's heights. One pass.
struct RasterSummary {
  std::size_t cells = 0, valid = 0;
  double minimum = 0, maximum = 0, mean = 0;  ///< of the valid cells; NaN when there is none
};
RasterSummary summarize(const Raster& raster);

/// The valid cells as a bit mask.
Mask valid_mask(const Raster& raster);

}  // namespace retalho
