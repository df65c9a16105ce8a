// --breaklines: survey points triangulated along lines that the surface may fold along.
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

/// All points, and the breaklines if there are any; says what was read and where lines cross or have no height.
ConstrainedTin triangulate(const Program& program, const PointCloud& cloud, const std::string& input,
                           const BreaklineFlags& flags, ScatteredNotes* notes, const Context& context);

}  // namespace retalho::app
