// retalho viewshed --to: the sight line between two points, as words, JSON and a picture.
#pragma once

#include <string>

#include "program.h"
#include "retalho/raster/georef.h"
#include "retalho/visibility/line_of_sight.h"

namespace retalho::app {

/// Prints the verdict; writes a picture where `output` is not empty.
void report_sight_line(const Program& program, const SightLine& line, const Georef& georef, bool frequency,
                       const std::string& output);

}  // namespace retalho::app
