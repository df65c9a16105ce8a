#include "retalho/raster/claim.h"

#include <fmt/format.h>

#include <cstdint>

#include "retalho/core/error.h"
#include "retalho/core/memory.h"

namespace retalho {

void check_claim(int columns, int rows, std::size_t bytes, const std::string& name) {
  const double need = static_cast<double>(columns) * rows * static_cast<double>(bytes);
  const double have = static_cast<double>(available_memory());
  check_memory(need, fmt::format("reading {} x {} cells", columns, rows), name);
  if (need <= 0.9 * have) return;
  throw BadInput(
      fmt::format("'{}' has {} x {} cells: their heights need {:.1f} GB of memory, and {:.1f} GB are available; "
                  "cut out a part (gdal_translate -projwin) or read it at a lower resolution (gdal_translate -outsize)",
                  name, columns, rows, need / 1e9, have / 1e9),
      name, fmt::format("{} x {} cells", columns, rows));
}

}  // namespace retalho
