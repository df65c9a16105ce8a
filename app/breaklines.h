// --breaklines: survey points triangulated along lines that the surface may fold along. --creases FILE: such lines of a
// grid.
#pragma once

#include <string>
#include <vector>

#include "program.h"
#include "retalho/cloud/cloud.h"
#include "retalho/tin/breaklines.h"

namespace retalho::app {

struct BreaklineFlags {
  std::string file, layer;
  bool given() const { return !file.empty(); }
};
void add_breakline_flags(CLI::App& command, BreaklineFlags& flags);
/// Throws UsageError when breaklines are given with an input that is not made of points.
void check_breakline_flags(const BreaklineFlags& flags, bool from_points);
/// Throws UsageError when breaklines are given with a budget.
void check_breakline_budget(const BreaklineFlags& flags, bool budget);

/// All points, and the breaklines if there are any; says what was read and where lines cross or have no height.
ConstrainedTin triangulate(const Program& program, const PointCloud& cloud, const std::string& input,
                           const BreaklineFlags& flags, ScatteredNotes* notes, const Context& context);

/// --creases FILE: lines that a grid's surface folds along, in the grid's local coordinates.
std::vector<std::vector<Vec2>> read_crease_lines(const Georef& grid, const std::string& input, const std::string& file,
                                                 const std::string& layer, const Context& context);

}  // namespace retalho::app
