// The part of `retalho render` that draws TetraQuad models.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "program.h"
#include "retalho/render/compose.h"
#include "retalho/render/tetraquad_picture.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho::app {

struct TetraQuadFlags {
  std::string up = "z";
  std::vector<std::string> cuts;
  bool outlines = false, jumps = false;
};
void add_tetraquad_flags(CLI::App& command, TetraQuadFlags& flags);

/// One panel, without a caption. Throws UsageError for a cut that cannot be read.
Image draw_panel(const TetraQuad& surface, const TetraQuadFlags& flags, std::optional<double> from, double elevation,
                 int width, int height, const Context& context);

/// "five tetrahedra a cube, 7,700 crossed"
std::string kind_text(const TetraQuad& surface);

}  // namespace retalho::app
