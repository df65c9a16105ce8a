// The peer of viewsheds: gdal_viewshed, a whole process, file to file.
#pragma once

#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "retalho/raster/raster.h"
#include "retalho/visibility/viewshed.h"

namespace retalho::bench {

/// Runs it on `folder`/in.tif, made from `raster`, into `folder`/out.tif: no curvature, no radius, targets on the
/// ground. False when it cannot be run.
inline bool run_gdal_viewshed(const Raster& raster, const Observer& observer, const std::string& folder) {
  const Vec2 at = raster.georef.to_crs(raster.centre(observer.column, observer.row));
  const std::string command = fmt::format(
      "gdal_viewshed -q -md 0 -cc 0 -oz {} -tz 0 -ox {:.17g} -oy {:.17g} {}/in.tif {}/out.tif >/dev/null 2>&1",
      observer.height, at.x, at.y, folder, folder);
  return std::system(command.c_str()) == 0;
}

}  // namespace retalho::bench
