// The exact lines of contour --conics.
#pragma once

#include <string>
#include <vector>

#include "program.h"
#include "retalho/terrain/terrain.h"

namespace retalho::app {

/// Writes the level lines of a Powell-Sabin surface as curves (docs/curve.schema.json) in the coordinates of the CRS,
/// each named by its level, and reports.
void write_conics(const Program& program, const Terrain& terrain, std::vector<double> levels, const std::string& output,
                  const Context& context);

}  // namespace retalho::app
