#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "retalho/raster/io.h"

namespace retalho {

std::string describe(const Raster& raster, const ReadNotes& notes, const RasterSummary& s) {
  std::string line =
      fmt::format("{} x {} cells of {:.6g} x {:.6g} {}, {}", raster.columns, raster.rows, raster.cell_width,
                  raster.cell_height, raster.georef.unit, notes.crs_name.empty() ? "no CRS" : notes.crs_name);
  if (s.valid == 0) return line + ", no valid cell";
  // Rounded down: "100 %" means every cell.
  const double percent = 100.0 * static_cast<double>(s.valid) / static_cast<double>(s.cells);
  const double shown = s.valid == s.cells ? 100 : std::min(std::floor(percent * 100) / 100, 99.99);
  line += fmt::format(", {} valid ({:.4g} %), heights {:.7g} to {:.7g}", s.valid, shown, s.minimum, s.maximum);
  if (!raster.height_unit.empty()) line += " " + raster.height_unit;
  return line;
}

}  // namespace retalho
